"""Runs in real time: their delay, their viewers, and changes of values meanwhile."""
