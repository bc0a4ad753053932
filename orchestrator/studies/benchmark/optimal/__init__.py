"""The time-optimal motion near a driven one, at equal limits."""
