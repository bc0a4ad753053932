"""How far a run is, for whoever waits for it."""

import time
from collections.abc import Callable

from orchestrator.simulation.cosim.algorithm import Termination
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.signal_blocks import Times

SHOW_PERIOD = 0.2
"""Real time between two calls [s]: simulated time says nothing of how long a user has waited."""


class RunClock:
    """Observer that calls ``show`` with the simulated time [s], a few times a second."""

    def __init__(self, show: Callable[[float], None]) -> None:
        self._show = show
        self._next = 0.0

    def on_communication_point(self, t_ns: int) -> None:
        """Show the time now and then."""
        now = time.monotonic()
        if now >= self._next:
            self._next = now + SHOW_PERIOD
            self._show(t_ns / 1e9)

    def observe_rows(self, t_ns: Times, rows: Array) -> None:
        """Show the time of the last of many exchanges."""
        self.on_communication_point(int(t_ns[-1]))

    def on_terminate(self, end: Termination) -> None:
        """Nothing to close."""
