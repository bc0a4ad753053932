"""A run held back to real time, and its delay."""

import time
from array import array
from collections.abc import Callable
from typing import Any

import numpy as np

from orchestrator.simulation.cosim.algorithm import Termination

LATE_THRESHOLD = 1e-3
"""An exchange later than this [s] counts as late."""


class RealTimeClock:
    """Observer that lets no exchange be seen before its time has come, and notes how late each was."""

    def __init__(
        self, clock: Callable[[], float] = time.perf_counter, sleep: Callable[[float], None] = time.sleep
    ) -> None:
        self._clock, self._sleep = clock, sleep
        self._begun = 0.0
        self._late = array("d")

    def on_communication_point(self, t_ns: int) -> None:
        """Wait until ``t_ns`` after the first exchange."""
        if not self._late:
            self._begun = self._clock()
        early = self._begun + t_ns / 1e9 - self._clock()
        if early > 0.0:
            self._sleep(early)
        self._late.append(max(0.0, self._clock() - self._begun - t_ns / 1e9))

    def on_terminate(self, end: Termination) -> None:
        """Nothing to close."""

    def lateness_statistics(self) -> dict[str, Any]:
        """Return the lateness of all exchanges: median, 99th percentile, largest, at the end [s], and how many late."""
        late = np.array(self._late or [0.0], dtype=np.float64)
        median, high = (float(value) for value in np.quantile(late, (0.5, 0.99)))
        return {
            "exchanges": len(self._late),
            "late": int((late > LATE_THRESHOLD).sum()),
            "median": median,
            "percentile_99": high,
            "largest": float(late.max()),
            "at_end": float(late[-1]),
        }
