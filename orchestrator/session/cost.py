"""What a run may take, reported before it begins: log and scratch space grow with its exchanges, memory does not."""

import shutil
import tempfile

from orchestrator.inputs.text.errors import BadInput

BYTES_PER_VALUE = 8
"""Bytes of a value in the scratch file."""
LOG_BYTES_PER_VALUE = 2.5
"""Bytes of a value in the log, about."""
WARNED_EXCHANGES = 1_000_000
"""Exchanges from which the cost is reported: over a minute where every exchange is made in Python."""
MAX_BYTES = 1e12
"""A run that may write a larger log is refused: no computer that parks cars has the room."""


def cost_text(exchanges: int, values: int) -> str:
    """Return what a run of so many exchanges of so many values may take; empty if that is little.

    Raises ``BadInput`` if it is more than a computer has.
    """
    log, scratch = exchanges * values * LOG_BYTES_PER_VALUE, exchanges * values * BYTES_PER_VALUE
    text = f"{exchanges:.2g} exchanges: up to {size(log)} of log and {size(scratch)} of scratch space"
    if log > MAX_BYTES:
        raise BadInput(f"{text}; make step larger or stop_time shorter", key="step")
    if exchanges <= WARNED_EXCHANGES:
        return ""
    left = scratch_left()
    short = f" ({tempfile.gettempdir()} has {size(left)} left)" if left is not None and scratch > left else ""
    return f"if it ends at its stop time alone, this run has {text}{short}"


def scratch_left() -> float | None:
    """Return the room that is left for scratch files [bytes]; None where the system does not tell."""
    try:
        return float(shutil.disk_usage(tempfile.gettempdir()).free)
    except OSError:
        return None


def size(count: float) -> str:
    """Return a number of bytes for people."""
    for unit in ("bytes", "kB", "MB", "GB", "TB"):
        if count < 1000.0 or unit == "TB":
            return f"{count:.0f} {unit}"
        count /= 1000.0
    raise AssertionError
