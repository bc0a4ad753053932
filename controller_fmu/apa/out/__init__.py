"""The way out of a slot: what the car stands in, moves, margins, search, and what is heard on it."""
