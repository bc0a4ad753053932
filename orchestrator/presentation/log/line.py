"""A line that a model, or the run itself, wrote to a log."""

from typing import NamedTuple

LEVELS = {0: "unknown", 1: "debug", 2: "info", 3: "warning", 4: "error", 5: "fatal"}

MAX_LINES = 10_000
"""More are kept in the log only."""


class Line(NamedTuple):
    """One message."""

    t: float
    """Simulated time [s]."""
    level: str
    name: str
    """Who said it."""
    text: str


def line_of(t_ns: int, level: int, name: str, text: str) -> Line:
    """Return the message as a log has it."""
    return Line(t_ns / 1e9, LEVELS.get(level, "unknown"), name, text)
