"""What a run may take, told before it is begun: memory and log grow with its exchanges."""

import os

from orchestrator.text.errors import BadInput

VALUE = 8
"""Bytes of a value in the recording."""
COPIES = 3
"""How often a recording is in memory at most: while it grows, and while it is judged."""
LOGGED = 2.5
"""Bytes of a value in the log, about."""
MANY = 1_000_000
"""Exchanges from which the cost is told: over a minute where every exchange is made in Python."""
MOST_BYTES = 1e12
"""A run that may take more memory is refused: no computer that parks cars has it."""


def told_cost(exchanges: int, values: int) -> str:
    """Return what a run of so many exchanges of so many values may take; empty if that is little.

    Raises ``BadInput`` if it is more than a computer has.
    """
    memory = exchanges * values * VALUE * COPIES
    text = f"{exchanges:.2g} exchanges: up to {size(memory)} of memory and {size(exchanges * values * LOGGED)} of log"
    if memory > MOST_BYTES:
        raise BadInput(f"{text}; make step larger or stop_time shorter", key="step")
    if exchanges <= MANY:
        return ""
    has = memory_left()
    short = f" (this machine has {size(has)} left)" if has is not None and memory > has else ""
    return f"if it ends at its stop time alone, this run has {text}{short}"


def memory_left() -> float | None:
    """Return the memory that is left on this machine [bytes]; None where it does not tell."""
    try:
        with open("/proc/meminfo", encoding="ascii") as file:
            kilobytes = next(line.split()[1] for line in file if line.startswith("MemAvailable"))
        return float(kilobytes) * 1024.0
    except (OSError, StopIteration):
        pass
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError, OSError):
        return None


def size(count: float) -> str:
    """Return a number of bytes for people."""
    for unit in ("bytes", "kB", "MB", "GB", "TB"):
        if count < 1000.0 or unit == "TB":
            return f"{count:.0f} {unit}"
        count /= 1000.0
    raise AssertionError
