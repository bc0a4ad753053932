"""One run from a scenario: make the instances, the master, its observers and faults; run; return the recording."""

import math
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.scenario.plausible import implausible
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import RESOURCES, BadInput, NotRunError, RunError
from orchestrator.inputs.text.quantities import NS_PER_SECOND
from orchestrator.presentation.log.line import Line
from orchestrator.session.cost import cost_text
from orchestrator.session.foreign import ImportedFmus, undriven
from orchestrator.session.provenance import provenance
from orchestrator.session.stream.realtime import Realtime
from orchestrator.simulation.cosim.algorithm import CoSimulation, Interrupt, Observer, Termination, last_exchange
from orchestrator.simulation.cosim.faults import manipulators
from orchestrator.simulation.cosim.fmu_instance import Array, FmuInstance
from orchestrator.simulation.cosim.mode_changes import ERROR, FMI_LEVELS, WARNING, ModeChanges
from orchestrator.simulation.cosim.model_instance import ModelInstance
from orchestrator.simulation.cosim.recording import Recorder, Recording
from orchestrator.simulation.cosim.signal_blocks import Times
from orchestrator.simulation.cosim.stop_conditions import standstill
from orchestrator.simulation.system.assemble import ElaboratedSystem, elaborate
from orchestrator.simulation.system.diagnostics import remarks

if TYPE_CHECKING:
    from orchestrator.presentation.log.mcap_log import McapLog

PACED = "paced"
"""Instead of a kind of FMU: every exchange waits for its time, so there is nothing to gain by a compiled master."""


NOBODY = ImportedFmus()


class SimulationResult(NamedTuple):
    """What a run leaves behind."""

    recording: Recording
    end: Termination
    remarks: list[str]
    """What was said of the system before it ran."""
    wall_time: float
    """Time from the first exchange to the closed log [s]; building, loading and initializing come before."""
    lines: list[Line]
    """What models and run wrote to the log."""


class Messages:
    """Messages of FMUs and of the changes, handed to whoever listens; times are the master's."""

    def __init__(self) -> None:
        self.t_ns = 0
        self.listeners: list[Callable[[int, int, str, str], None]] = []

    def say(self, t_ns: int, level: int, name: str, text: str) -> None:
        """Pass on one line."""
        for listener in self.listeners:
            listener(t_ns, level, name, text)

    def from_fmu(self, name: str, status: int, text: str) -> None:
        """Pass on a message of an FMU."""
        self.say(self.t_ns, FMI_LEVELS.get(status, ERROR), name, text)

    def on_communication_point(self, t_ns: int) -> None:
        """Note the time."""
        self.t_ns = t_ns

    def observe_rows(self, t_ns: Times, rows: Array) -> None:
        """Note the time of the last of many exchanges."""
        self.t_ns = int(t_ns[-1])

    def on_terminate(self, end: Termination) -> None:
        """Nothing to close."""


def make_instances(
    scenario: Scenario, files: Mapping[str, Path] | None, messages: Messages, foreign: ImportedFmus = NOBODY
) -> list[FmuInstance]:
    """Return the instances of a scenario: FMUs of others, ours from ``files``, or else the models in process."""
    foreign = foreign.with_system(scenario.system)
    instances: list[FmuInstance] = []
    for name in scenario.places:
        parameters = scenario.parameters_for(name)
        if name in foreign.files:
            ours = scenario.models.get(name)
            instances.append(foreign.make_instance(name, foreign.files[name], parameters, messages.from_fmu, ours))
            continue
        model = scenario.models[name]
        parameters = {key: value for key, value in parameters.items() if model.shows(key)}
        if files is None or name not in files:
            instances.append(ModelInstance(name, model, parameters))
        else:
            from orchestrator.simulation.cosim.fmu_files import fmu_beside
            from orchestrator.simulation.cosim.local_instance import LocalInstance

            path = files[name] if model is MODELS[name] else fmu_beside(files[name], model)
            instances.append(LocalInstance(name, path, parameters, messages.from_fmu, model))
    return instances


def run_scenario(
    scenario: Scenario,
    files: Mapping[str, Path] | None = None,
    *,
    kind: str = "none",
    log: Path | None = None,
    observers: tuple[Observer, ...] = (),
    interrupt: Interrupt | None = None,
    warn: Callable[[str], None] = lambda text: None,
    foreign: ImportedFmus = NOBODY,
    realtime: Realtime | None = None,
    started: Mapping[str, Any] | None = None,
) -> SimulationResult:
    """Return the recording of one run. Errors of an instance end it as aborted; ``BadInput`` passes through.

    ``warn`` receives, before the run, what is allowed in the system but hardly meant. ``foreign`` are third-party
    FMUs, in the place of ours or beside them. ``realtime`` holds the run to real time.
    ``started`` says when and by which command, for the log (``provenance.start_record``).
    """
    messages = Messages()
    foreign = foreign.with_system(scenario.system)
    instances = make_instances(scenario, files, messages, foreign)
    try:
        return run_instances(
            scenario,
            instances,
            messages,
            kind=kind,
            log=log,
            observers=observers,
            interrupt=interrupt,
            warn=warn,
            foreign=foreign,
            realtime=realtime,
            started=started,
        )
    finally:
        for instance in instances:
            instance.close()


def run_instances(
    scenario: Scenario,
    instances: list[FmuInstance],
    messages: Messages,
    *,
    kind: str = "none",
    log: Path | None = None,
    observers: tuple[Observer, ...] = (),
    interrupt: Interrupt | None = None,
    warn: Callable[[str], None] = lambda text: None,
    foreign: ImportedFmus = NOBODY,
    realtime: Realtime | None = None,
    started: Mapping[str, Any] | None = None,
) -> SimulationResult:
    """Return the recording of one run of given instances."""
    system = elaborate(scenario, instances)
    stop_ns = _reachable_stop_ns(system, scenario)
    exchanges = last_exchange(scenario.step_ns, stop_ns) + 1
    said = [*_warnings(system, scenario, exchanges, stop_ns), *undriven(system, foreign, scenario)]
    for text in said:
        warn(text)
    master = _master(system, scenario, stop_ns, kind if realtime is None else PACED)
    master.interrupt = interrupt or Interrupt()
    info = provenance(scenario, system.instances, kind, foreign) | ({"started": dict(started)} if started else {})
    recorder = Recorder(system.instances, exchanges)
    master.observers += [messages, recorder, ModeChanges(system.instances, scenario.faults, messages.say)]
    file = None if log is None else _begin_log(log, system, scenario, info, master, messages)
    master.observers += observers
    if realtime is not None:
        realtime.join(master, scenario, messages.say, messages.listeners)
    for text in said:
        messages.say(0, WARNING, "system", text)
    try:
        end, wall_time = _drive(master, messages)
    except (BadInput, NotRunError, *RESOURCES):
        if file is not None and not recorder.count:
            file.discard()
        raise
    info |= {"end": {"reason": end.reason, "t_ns": end.t_ns}, **({"realtime": realtime.report()} if realtime else {})}
    return SimulationResult(recorder.recording(info), end, said, wall_time, [] if file is None else file.lines)


def _begin_log(
    path: Path,
    system: ElaboratedSystem,
    scenario: Scenario,
    info: dict[str, Any],
    master: CoSimulation,
    messages: Messages,
) -> "McapLog":
    """Return the log at ``path`` to which the run will be written."""
    from orchestrator.presentation.log.mcap_log import McapLog

    file = McapLog(path, system.instances, scenario, info)
    messages.listeners.append(file.say)
    master.observers.append(file)
    return file


def _reachable_stop_ns(system: ElaboratedSystem, scenario: Scenario) -> int:
    """Return the stop time [ns]; the last one that all FMUs of a fixed communication step reach, if there are any."""
    steps = [
        scenario.step_ns * scenario.decimation.get(item.name, 1)
        for item in system.instances
        if not item.has_variable_step
    ]
    common = math.lcm(*steps)
    stop_ns = scenario.stop_ns // common * common
    if not stop_ns:
        text = f"{scenario.longest:.9g} s is less than the {common / NS_PER_SECOND:.9g} s"
        raise BadInput(f"{text} which {_names_at_fixed_step(system)} needs", file=scenario.file, key="stop_time")
    return stop_ns


def _names_at_fixed_step(system: ElaboratedSystem) -> str:
    return ", ".join(item.name for item in system.instances if not item.has_variable_step)


def _early_stop(system: ElaboratedSystem, scenario: Scenario, stop_ns: int) -> list[str]:
    """Return that a run ends before its stop time, if it does."""
    if stop_ns == scenario.stop_ns:
        return []
    text = f"stop_time {scenario.longest:.9g} s is no whole number of steps"
    fixed = _names_at_fixed_step(system)
    return [f"{text}, and the step of {fixed} is fixed: a run ends at {stop_ns / NS_PER_SECOND:.9g} s"]


def _warnings(system: ElaboratedSystem, scenario: Scenario, exchanges: int, stop_ns: int) -> list[str]:
    """Return what is allowed in a system but hardly meant, or costly."""
    cost = cost_text(exchanges, sum(len(item.inputs.names) + len(item.outputs.names) for item in system.instances))
    ending = scenario.stop_condition if scenario.task != "open_loop" else None
    ignored = scenario.system.ignored if scenario.system is not None else []
    early = _early_stop(system, scenario, stop_ns)
    return [*remarks(system, ending, ignored), *early, *implausible(scenario), *([cost] if cost else [])]


def _drive(master: CoSimulation, messages: Messages) -> tuple[Termination, float]:
    """Run; return how it ended, and the time from the first exchange to the closed log [s]."""
    end = _guard(messages, master.initialize)
    begun = time.perf_counter()
    if end is None:
        end = _guard(messages, master.run)
    assert end is not None
    master.finish(end)
    wall_time = time.perf_counter() - begun
    master.free()
    return end, wall_time


def _master(system: ElaboratedSystem, scenario: Scenario, stop_ns: int, kind: str) -> CoSimulation:
    """Return the master for FMUs of this kind: compiled for native ones, as the loop in Python would eat the gain.

    Faults and what ends the run are in place.
    """
    make: type[CoSimulation] = CoSimulation
    if kind == "native":
        from orchestrator.simulation.cosim.compiled_master import CompiledMaster

        make = CompiledMaster
    master = make(system.instances, scenario.step_ns, stop_ns, scenario.decimation, system.connections)
    master.manipulators += manipulators(scenario.faults, master, scenario.seed, scenario.file)
    ending = standstill(scenario.stop_condition, system.instances) if scenario.task != "open_loop" else None
    if ending is not None:
        master.endings.append(ending)
    return master


def _guard(messages: Messages, act: Callable[[], Termination | None]) -> Termination | None:
    """Return what ``act`` returns, or how the run ended if it cannot go on."""
    try:
        return act()
    except RunError as error:
        messages.say(messages.t_ns, ERROR, "run", str(error))
        return Termination(f"error: {error}", messages.t_ns)
    except KeyboardInterrupt:
        return Termination("interrupted", messages.t_ns)
