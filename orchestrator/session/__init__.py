"""One run from scenario to recording, and what the terminal shows of it."""
