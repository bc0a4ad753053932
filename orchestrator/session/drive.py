"""One run with its log in a folder, shown as it goes, ended in order by Ctrl-C."""

from pathlib import Path

from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.console import Meter, Warnings, say
from orchestrator.session.foreign import ImportedFmus
from orchestrator.session.provenance import start_record
from orchestrator.session.session import NOBODY, SimulationResult, run_scenario
from orchestrator.session.stream.realtime import Realtime
from orchestrator.simulation.cosim.algorithm import Interrupt, Termination
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.interrupts import on_interrupt
from orchestrator.simulation.cosim.signal_blocks import Times

SHOWN_NS = 500_000_000
"""Simulated time between two looks at how far a run is."""


def drive(
    scenario: Scenario, kind: str, log: Path, foreign: ImportedFmus = NOBODY, realtime: Realtime | None = None
) -> SimulationResult:
    """Return a run with FMUs of ``kind`` (``none``: models in process), which are built if need be.

    ``foreign`` FMUs take the place of ours, or stand beside them. Whoever calls it owns the log's folder.
    """
    is_ours = any(name not in foreign.files for name in scenario.places)
    files = fmu_files(kind, say) if is_ours and kind != "none" else None
    interrupt = Interrupt()
    with on_interrupt(interrupt), _Clock(scenario.name, scenario.longest, "s") as clock:
        ran = run_scenario(
            scenario,
            files,
            kind=kind,
            log=log,
            observers=(clock,),
            interrupt=interrupt,
            warn=Warnings(),
            foreign=foreign,
            realtime=realtime,
            started=start_record(),
        )
    return ran


class _Clock(Meter):
    """Observer that shows the simulated time."""

    _next_ns = 0

    def on_communication_point(self, t_ns: int) -> None:
        """Show the time now and then."""
        if t_ns >= self._next_ns:
            self._next_ns = t_ns + SHOWN_NS
            self.at(t_ns / 1e9)

    def observe_rows(self, t_ns: Times, rows: Array) -> None:
        """Show the time of the last of many exchanges."""
        self.on_communication_point(int(t_ns[-1]))

    def on_terminate(self, end: Termination) -> None:
        """Nothing to close."""
