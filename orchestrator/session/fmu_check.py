"""What an FMU would be in a system, found before any run: connected, unconnected, unsupported, missing."""

from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

from fmpy.model_description import ModelDescription

from modelkit.model import Model
from modelkit.variables import variables
from orchestrator.inputs.scenario.end_condition import EndCondition
from orchestrator.inputs.scenario.load_scenario import load_system
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import RESOURCES, BadInput, NotRunError, RunError
from orchestrator.inputs.text.failures import reason_of
from orchestrator.session.foreign import Fitting, ImportedFmus, fmu_of, load_bound_scenario, sha256_of
from orchestrator.session.session import Messages, make_instances
from orchestrator.simulation.cosim.fmu_instance import FmuInstance, Ports
from orchestrator.simulation.cosim.model_description import ports_of, read_description, variables_of_other_types
from orchestrator.simulation.cosim.model_instance import ModelInstance
from orchestrator.simulation.imported.archive import binary, check_archive, pack
from orchestrator.simulation.imported.limits import FmuLimits
from orchestrator.simulation.system.assemble import ElaboratedSystem, elaborate
from orchestrator.simulation.system.diagnostics import (
    NEEDED_INPUTS,
    loops,
    missing_for_the_verdict,
    not_fed,
    unsaid,
    without_consumer,
)
from orchestrator.simulation.system.signal_matching import Signals, match_signals

MAX_SHOWN = 6


class FmuReport(NamedTuple):
    """What was found of one FMU; each list is empty if there is nothing to say."""

    about: dict[str, str]
    """What it is: name, version of FMI, platforms, size, hash."""
    place: str
    """The instance that it would be."""
    connected: list[str]
    """``input <- signal`` and ``output -> input``."""
    not_fed: list[str]
    """Inputs that nothing feeds, with what may be meant."""
    not_understood: list[str]
    """Outputs that nobody takes, and variables of types that are not connected."""
    no_unit: list[str]
    """Variables of which the FMU says no unit."""
    missing: list[str]
    """Outputs that a verdict needs, with what is lost."""
    problems: list[str]
    """What would end a run: a unit or a type that does not fit, a library that cannot be loaded."""
    remarks: list[str]
    """What is worth knowing besides."""

    @property
    def is_ready(self) -> bool:
        """Return whether it can be run and judged as it is."""
        return bool(self.connected) and not self.problems and not self.missing

    def plain(self) -> dict[str, Any]:
        """Return it as plain data."""
        return {**self._asdict(), "ready": self.is_ready}


def check_fmu(path: Path, place: str, scenario: str, timeout: float, loads: bool) -> FmuReport:
    """Return what the FMU at ``path`` would be as instance ``place`` of a scenario; by its variables if that is empty.

    ``loads``: have it loaded and initialized, in a process of its own. Raises ``BadInput`` if it is no FMU.
    """
    path = pack(path) if path.is_dir() else path
    names = check_archive(path)
    description = read_description(path)
    place = place or likely_place(path, description, scenario)
    fitting = _fitting(path, place, scenario, timeout)
    instances = make_instances(fitting.scenario, None, Messages(), fitting.foreign)
    try:
        instance = next(item for item in instances if item.name == place)
        system, problems = _try_assembly(fitting.scenario, instances)
        problems += _loading(instance) if loads else []
        remarks = [] if system is None else loops(system)
        remarks += _omission_text(fitting.unsupported_parameters, place)
        return FmuReport(
            _about(path, names, description),
            place,
            [] if system is None else _connection_lines(system, instance),
            [] if system is None else _not_fed(system, instance),
            _not_understood(system, instance, description),
            unsaid(instance),
            _missing(instance, fitting.scenario.stop_condition),
            problems,
            remarks,
        )
    finally:
        for item in instances:
            item.close()


def likely_place(path: Path, description: ModelDescription, scenario: str) -> str:
    """Return the instance that a scenario has for this FMU; else ours whose variables its own are most alike."""
    system = load_system(scenario) if scenario else None
    for place, file in (system.files() if system is not None else {}).items():
        if Path(file).exists() and path.samefile(fmu_of(file)):
            return place
    alike = {owner: _likeness(path, description, model) for owner, model in MODELS.items()}
    return "vehicle" if alike["vehicle"] > alike["controller"] else "controller"


def _likeness(path: Path, description: ModelDescription, model: Model) -> float:
    """Return how many variables of an FMU are like those of a model, each 0 to 1."""
    total = 0.0
    for causality, ours in (("input", model.inputs), ("output", model.outputs)):
        theirs = Signals("theirs", ports_of(description, causality, None, path))
        total += sum(
            item.score for item in match_signals(theirs, Signals("ours", Ports(variables(ours))), is_unique=True)
        )
    return total


def _fitting(path: Path, place: str, scenario: str, timeout: float) -> Fitting:
    if not scenario and place not in MODELS:
        raise BadInput(f"{place} is neither vehicle nor controller; name a scenario whose system has it", key="--as")
    found = load_bound_scenario(scenario or "guo2015-case4", [], ImportedFmus({place: path}, limits=FmuLimits(timeout)))
    if place not in found.scenario.places:
        raise BadInput(f"no instance of {scenario} is called {place}", key="--as")
    return found


def _omission_text(names: list[str], place: str) -> list[str]:
    own = [name.removeprefix(f"{place}.") for name in names if name.startswith(f"{place}.")]
    more = f" and {len(own) - MAX_SHOWN} more" if len(own) > MAX_SHOWN else ""
    return [f"it has no parameters {', '.join(own[:MAX_SHOWN])}{more}: they are left out"] if own else []


def _try_assembly(scenario: Scenario, instances: list[FmuInstance]) -> tuple[ElaboratedSystem | None, list[str]]:
    try:
        return elaborate(scenario, instances), []
    except BadInput as error:
        return None, [str(error)]


def _loading(instance: FmuInstance) -> list[str]:
    """Return why it cannot be loaded and initialized here; empty if it can."""
    if isinstance(instance, ModelInstance):
        return []
    try:
        instance.initialize(60_000_000_000)
        instance.fetch_outputs()
        instance.send_inputs()
        instance.start()
        instance.step(0, 10_000_000)
        instance.fetch_outputs()
    except RunError as error:
        return [str(error)]
    except (NotRunError, *RESOURCES) as error:
        return [reason_of(error)]
    return []


def _about(path: Path, names: list[str], description: Any) -> dict[str, str]:
    identifier = str(description.coSimulation.modelIdentifier)
    version = str(description.fmiVersion)
    try:
        here = binary(names, identifier, 3 if version.startswith("3") else 2)
    except ValueError as error:
        here = str(error)
    platforms = sorted({name.split("/")[1] for name in names if name.startswith("binaries/") and name.count("/") > 1})
    kinds = Counter(item.causality for item in description.modelVariables)
    return {
        "file": str(path),
        "model": str(description.modelName),
        "FMI": version,
        "made by": str(description.generationTool or "not said"),
        "platforms": ", ".join(platforms) or "none",
        "here": here,
        "variables": ", ".join(f"{kinds[name]} {name}s" for name in ("input", "output", "parameter") if kinds[name]),
        "SHA-256": sha256_of(path),
    }


def _connection_lines(system: ElaboratedSystem, instance: FmuInstance) -> list[str]:
    number = system.instances.index(instance)
    found = []
    for link in system.connections:
        source, target = system.instances[link.source], system.instances[link.target]
        pairs = zip(link.source_places.tolist(), link.target_places.tolist(), strict=True)
        for given, taken in pairs:
            out, into = f"{source.name}.{source.outputs.names[given]}", f"{target.name}.{target.inputs.names[taken]}"
            how = "" if link.convert is None else " (converted)"
            if link.target == number:
                found.append(f"{target.inputs.names[taken]} <- {out}{how}")
            elif link.source == number:
                found.append(f"{source.outputs.names[given]} -> {into}{how}")
    return found


def _not_fed(system: ElaboratedSystem, instance: FmuInstance) -> list[str]:
    found = not_fed(system.instances.index(instance), system)
    others = [
        f"{other.name}.{name}{meant}"
        for number, other in enumerate(system.instances)
        if other is not instance and other.name in MODELS
        for name, meant in not_fed(number, system).items()
        if meant or name in NEEDED_INPUTS.get(other.name, ())
    ]
    return [*(f"{name}{meant}" for name, meant in found.items()), *others]


def _not_understood(system: ElaboratedSystem | None, instance: FmuInstance, description: Any) -> list[str]:
    spare = [] if system is None else without_consumer(system.instances.index(instance), system)
    return [*spare, *variables_of_other_types(description, "input", "output", "parameter")]


def _missing(instance: FmuInstance, ending: EndCondition) -> list[str]:
    found = missing_for_the_verdict(instance.name, instance, ending)
    return [f"{name}: {loss}" for name, loss in found.items()]
