"""How much a third-party FMU may take in a whole run, and how it is shut in."""

from typing import NamedTuple

STEP_TIMEOUT = 30.0
"""Wall-clock limit [s] for loading, initializing and each step, if nothing else is said."""
RUN_TIMEOUT = 3600.0
"""Wall-clock time [s] for which a run waits for one FMU in all, if nothing else is said."""
MEMORY_BYTES = 8e9
"""Of an FMU's process, if nothing else is said."""


class FmuLimits(NamedTuple):
    """The limits of one FMU in a process of its own."""

    step_timeout: float = STEP_TIMEOUT
    """Wall-clock limit [s] for loading, for initializing and for each step."""
    run_timeout: float = RUN_TIMEOUT
    """For all of them together [s]."""
    memory: float = MEMORY_BYTES
    """Of its process [bytes], where the system can limit it."""
    is_sandboxed: bool = False
    """Its process sees no network, no other process, and can write to its own folder only."""
