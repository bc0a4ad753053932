"""What a run in real time has besides: its pace, and a stream of it."""

from collections.abc import Callable
from typing import Any

from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.session.stream.pace import RealTimeClock
from orchestrator.session.stream.tuning import Tuning
from orchestrator.simulation.cosim.algorithm import CoSimulation, Termination

Say = Callable[[int, int, str, str], None]


class Realtime:
    """Paces a run; with a port it also shows the run there, and takes parameters from there."""

    def __init__(self, port: int | None = None, announce: Callable[[str], None] = lambda text: None) -> None:
        self._port = port
        self._announce = announce
        self._pace = RealTimeClock()
        self._tuning: Tuning | None = None
        self.address = ""
        """Where the run is shown."""
        self.token = ""
        """What a viewer needs to change parameters."""

    def join(self, master: CoSimulation, scenario: Scenario, say: Say, listeners: list[Say]) -> None:
        """Take part in a run: first of all wait, last of all show. Raises ``BadInput`` if the port cannot be opened."""
        master.observers.insert(0, self._pace)
        if self._port is None:
            return
        from orchestrator.presentation.log.mcap_log import McapLog
        from orchestrator.session.stream.server import TOKEN, LiveChannels

        self._tuning = Tuning(master.instances, scenario.models, say)
        live = LiveChannels(self._port, scenario.title or scenario.name, self._tuning)
        self.address, self.token = live.address, live.token
        shown = McapLog(live, master.instances, scenario, {})
        listeners.append(shown.say)
        master.observers += [self._tuning, shown, _Ticks(live.at)]
        self._announce(
            f"live at {self.address}: open it in Foxglove or Lichtblick; to change parameters there, "
            f"set {TOKEN} to {self.token} first"
        )

    def report(self) -> dict[str, Any]:
        """Return how late the run was, and what was changed meanwhile."""
        return {**self._pace.lateness_statistics(), "tuned": self._tuning.reported if self._tuning else []}


class _Ticks:
    """Observer that reports the simulated time."""

    def __init__(self, tell: Callable[[int], None]) -> None:
        self.on_communication_point = tell

    def on_terminate(self, end: Termination) -> None:
        """Nothing to close."""
