"""FMUs of others in the place of ours: which files, what they can be given, where they came from."""

import argparse
import hashlib
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from modelkit.model import Model
from modelkit.variables import Variable
from orchestrator.inputs.scenario.load_scenario import load_scenario, load_system, scenario_names
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.scenario.wiring.system_text import SystemText
from orchestrator.inputs.text.errors import BadInput
from orchestrator.session.trust import require_trust
from orchestrator.simulation.imported.limits import FmuLimits
from orchestrator.simulation.imported.sandbox import sandbox_program

if TYPE_CHECKING:
    from orchestrator.simulation.cosim.fmu_instance import FmuInstance
    from orchestrator.simulation.system.assemble import ElaboratedSystem

FOREIGN = "foreign"
"""Kind of an FMU that is not one of ours."""
MODEL_CHOICE = "controller.system"
"""Chooses one of our controllers: nothing is left out where another FMU takes its place."""
Files = Mapping[str, Path]
"""FmuInstance -> third-party FMU."""
LogCallback = Callable[[str, int, str], None]


class ImportedFmus(NamedTuple):
    """The third-party FMUs in a run, and how far they are trusted."""

    files: Files = MappingProxyType({})
    is_in_process: bool = False
    """Run them in this process: faster, but one that crashes takes all with it."""
    limits: FmuLimits = FmuLimits()
    """Of each FMU in a process of its own."""

    def with_system(self, system: SystemText | None) -> "ImportedFmus":
        """Return them with those of a system, in whose place these come. Raises ``BadInput``."""
        named = {} if system is None else system.files()
        of_system = {instance: fmu_of(file) for instance, file in named.items() if instance not in self.files}
        return self._replace(files={**of_system, **self.files}) if of_system else self

    def make_instance(
        self, name: str, path: Path, parameters: Mapping[str, Any], log: LogCallback, model: Model | None
    ) -> "FmuInstance":
        """Return the instance ``name`` that runs the FMU at ``path``, in the place of ``model`` if there is one."""
        if self.is_in_process and not is_fmi3(path):
            from orchestrator.simulation.cosim.local_instance import LocalInstance

            return LocalInstance(name, path, parameters, log, model)
        from orchestrator.simulation.imported.remote_instance import RemoteInstance

        return RemoteInstance(name, path, parameters, log, model, limits=self.limits)


def is_fmi3(path: Path) -> bool:
    """Return whether an FMU is FMI 3.0, which has a process of its own in any case."""
    from orchestrator.simulation.cosim.model_description import read_description

    return str(read_description(path).fmiVersion).startswith("3")


def foreign_of(arguments: argparse.Namespace) -> ImportedFmus:
    """Return the FMUs that were named. Raises ``BadInput`` for one that is not there, or with models in process."""
    named = {name: getattr(arguments, name) for name in ("controller", "vehicle") if getattr(arguments, name)}
    files = {name: fmu_of(text) for name, text in named.items()}
    limits = FmuLimits(arguments.timeout, arguments.run_timeout, arguments.fmu_memory, arguments.sandbox)
    if limits.is_sandboxed and arguments.in_process:
        raise BadInput("--sandbox and --in-process exclude each other")
    if limits.is_sandboxed:
        sandbox_program()
    return ImportedFmus(files, arguments.in_process, limits)


class Fitting(NamedTuple):
    """A scenario with the third-party FMUs that it is run with."""

    scenario: Scenario
    unsupported_parameters: list[str]
    """Parameters of the scenario that those do not have."""
    foreign: ImportedFmus


def load_bound_scenario(name: str, sets: Iterable[str], foreign: ImportedFmus, origin: Path | None = None) -> Fitting:
    """Return a scenario with the foreign FMUs of its system, in whose place those in ``foreign`` come.

    Parameters of their own can be set like any other. ``origin``: the file that the scenario was made from, whose
    folder must be trusted if the system has code. Raises ``BadInput``.
    """
    sets = list(sets)
    system = load_system(name, sets)
    if system is not None and (origin is not None or name not in scenario_names()):
        require_trust(
            origin or Path(name), [file for instance, file in system.files().items() if instance not in foreign.files]
        )
    foreign = foreign.with_system(system)
    own = {instance: parameters_of(path, instance) for instance, path in foreign.files.items()}
    return Fitting(*bind_parameters(load_scenario(name, sets, own), own), foreign)


def fmu_of(text: str) -> Path:
    """Return the FMU that ``text`` means: an .fmu, its unzipped folder, or a model of one's own, ``law.py:MODEL``.

    Raises ``BadInput`` if there is no such file, or for what is wrong with the model.
    """
    from orchestrator.session.user_model_instance import is_model, own_fmu

    if is_model(text):
        return own_fmu(text)
    path = Path(text)
    if path.is_dir():
        from orchestrator.simulation.imported.archive import pack

        return pack(path)
    if not path.is_file():
        raise BadInput("no such file", file=path)
    return path


def parameters_of(path: Path, instance: str) -> list[Variable]:
    """Return the parameters of an FMU that takes the place of ``instance``. Raises ``BadInput``."""
    from orchestrator.simulation.cosim.model_description import ports_of, read_description, text_parameters
    from orchestrator.simulation.imported.archive import check_archive

    check_archive(path)
    description = read_description(path)
    return [*ports_of(description, "parameter", MODELS.get(instance), path).variables, *text_parameters(description)]


def connect_advice(place: str, fmu: str, scenario: str = "") -> str:
    """Return how to connect an FMU whose names are not ours: what to write into, or the command that writes it."""
    page = "page third-party-fmus of the documentation"
    if scenario.endswith((".yaml", ".yml")):
        return f"write what is missing into system: connections and roles of {scenario} ({page})"
    option = f"--{place}" if place in MODELS else "--fmu"
    base = f" --scenario {scenario}" if scenario else ""
    command = f"apa new scenario {option} {fmu}{base}"
    return f"{command} writes its connections, suggested by name, unit and description ({page})"


def undriven(system: "ElaboratedSystem", foreign: ImportedFmus, scenario: Scenario) -> list[str]:
    """Return one line if a third-party vehicle or controller is there and nothing feeds the vehicle's inputs."""
    names = [instance.name for instance in system.instances]
    owner = next((name for name in MODELS if name in foreign.files), "")
    if not owner or not set(MODELS) <= set(names) or "vehicle" in {names[number] for number, _ in system.fed}:
        return []
    advice = connect_advice(owner, str(foreign.files[owner]), scenario.file if scenario.system is not None else "")
    return [f"no output of controller is connected to vehicle, so nothing drives it; {advice}"]


def bind_parameters(scenario: Scenario, own: Mapping[str, list[Variable]]) -> tuple[Scenario, list[str]]:
    """Return the scenario that leaves out the parameters that a foreign FMU does not have, and the names to report."""
    ignored: list[str] = []
    for instance, items in own.items():
        known = {item.name for item in items}
        ignored += [f"{instance}.{name}" for name in scenario.parameters_of(instance) if name not in known]
    bound = scenario.model_copy(update={"unsupported_parameters": ignored})
    return bound, [name for name in ignored if name != MODEL_CHOICE]


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()
