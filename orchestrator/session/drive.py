"""One run with its log in a folder, shown as it goes, ended in order by Ctrl-C."""

from pathlib import Path

from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.console import Meter, Warnings, say
from orchestrator.session.foreign import ImportedFmus
from orchestrator.session.provenance import start_record
from orchestrator.session.run_clock import RunClock
from orchestrator.session.session import NOBODY, SimulationResult, run_scenario
from orchestrator.session.stream.realtime import Realtime
from orchestrator.simulation.cosim.algorithm import Interrupt
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.simulation.cosim.interrupts import on_interrupt


def drive(
    scenario: Scenario, kind: str, log: Path, foreign: ImportedFmus = NOBODY, realtime: Realtime | None = None
) -> SimulationResult:
    """Return a run with FMUs of ``kind`` (``none``: models in process), which are built if need be.

    ``foreign`` FMUs take the place of ours, or stand beside them. Whoever calls it owns the log's folder.
    """
    is_ours = any(name not in foreign.files for name in scenario.places)
    files = fmu_files(kind, say) if is_ours and kind != "none" else None
    interrupt = Interrupt()
    with on_interrupt(interrupt), Meter(scenario.name, scenario.longest, "s") as meter:
        ran = run_scenario(
            scenario,
            files,
            kind=kind,
            log=log,
            observers=(RunClock(meter.at),),
            interrupt=interrupt,
            warn=Warnings(),
            foreign=foreign,
            realtime=realtime,
            started=start_record(),
        )
    return ran
