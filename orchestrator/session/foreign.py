"""FMUs of others in the place of ours: which files, what they can be given, where they came from."""

import argparse
import hashlib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from modelkit.variables import Variable
from orchestrator.scenario.load_scenario import load_scenario, load_system
from orchestrator.scenario.models import MODELS
from orchestrator.scenario.scenario import Scenario
from orchestrator.text.errors import BadInput

FOREIGN = "foreign"
"""Kind of an FMU that is not one of ours."""
Files = Mapping[str, Path]
"""Slave -> FMU of somebody else's."""


def add_foreign_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options that put an FMU in the place of the controller or of the vehicle."""
    for name in ("controller", "vehicle"):
        parser.add_argument(f"--{name}", type=Path, metavar="FMU", help=f"use this {name} instead of the shipped one")


def foreign_files(arguments: argparse.Namespace) -> dict[str, Path]:
    """Return the FMUs that were named. Raises ``BadInput`` for one that is not there, or with models in process."""
    files = {name: getattr(arguments, name) for name in ("controller", "vehicle") if getattr(arguments, name)}
    for path in files.values():
        if not path.is_file():
            raise BadInput("no such file", file=path)
    if files and arguments.fmus == "none":
        raise BadInput("the models in process cannot be joined with an FMU; use --fmus python", key="--fmus")
    return files


class Fitting(NamedTuple):
    """A scenario with the FMUs of somebody else's that it is run with."""

    scenario: Scenario
    left_out: list[str]
    """Parameters of the scenario that those do not have."""
    files: Files


def load_fitting(name: str, sets: Iterable[str], files: Files) -> Fitting:
    """Return a scenario with the foreign FMUs of its system, in whose place those in ``files`` come.

    Parameters of their own can be set like any other. Raises ``BadInput``.
    """
    sets = list(sets)
    system = load_system(name, sets)
    of_system = {} if system is None else {slave: Path(file) for slave, file in system.files().items()}
    foreign = {**of_system, **files}
    for path in foreign.values():
        if not path.is_file():
            raise BadInput("no such file", file=path)
    own = {slave: parameters_of(path, slave) for slave, path in foreign.items()}
    return Fitting(*fitting(load_scenario(name, sets, own), own), foreign)


def parameters_of(path: Path, slave: str) -> list[Variable]:
    """Return the parameters of an FMU that takes the place of ``slave``. Raises ``BadInput``."""
    from orchestrator.cosim.description import ports_of, read_description

    return ports_of(read_description(path), "parameter", MODELS.get(slave), path).variables


def fitting(scenario: Scenario, own: Mapping[str, list[Variable]]) -> tuple[Scenario, list[str]]:
    """Return the scenario that leaves out the parameters that a foreign FMU does not have, and their names."""
    ignored: list[str] = []
    for slave, items in own.items():
        known = {item.name for item in items}
        ignored += [f"{slave}.{name}" for name in scenario.parameters_of(slave) if name not in known]
    return scenario.model_copy(update={"left_out": ignored}), ignored


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()
