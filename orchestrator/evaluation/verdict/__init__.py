"""What a run is worth: requirements, limits, margins, comparison."""
