"""The FMUs of a scenario as a system: which part feeds which, and what each starts with."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from fmus.contents.variables import FmiVariable, visible_variables
from modelkit.connections import connections, part_of
from modelkit.model import Model
from modelkit.variables import variables


def identifier(scenario: str) -> str:
    """Return what the system of a scenario is called in files and in C: ``Parking_<scenario>``."""
    return "Parking_" + re.sub(r"\W", "_", scenario, flags=re.ASCII)


class FmuPart(NamedTuple):
    """One FMU in its place."""

    name: str
    model: Model
    """It starts with the parameters of the scenario."""
    fmu: Path

    def of(self, causality: str) -> list[FmiVariable]:
        """Return the variables of this causality."""
        return [variable for variable in visible_variables(self.model) if variable.causality == causality]

    def settings(self) -> list[tuple[FmiVariable, Any]]:
        """Return (parameter, start value) of those that the scenario sets."""
        known = {variable.name: variable for variable in self.of("parameter")}
        return [(known[name], known[name].start) for name, _ in self.model.view.starts if name in known]


class FmuSystem(NamedTuple):
    """Parts, and the times of the experiment."""

    name: str
    """Of the scenario."""
    title: str
    parts: tuple[FmuPart, ...]
    step: float
    """Communication step [s]."""
    stop: float
    """Stop time [s]."""

    @property
    def identifier(self) -> str:
        """Return ``Parking_<scenario>``, with letters that every tool takes."""
        return identifier(self.name)

    def connections(self) -> list[tuple[FmuPart, FmuPart, str]]:
        """Return (sender, receiver, name) of every signal: an output and an input of the same name are connected."""
        wires = connections([part_of(part.name, part.model) for part in self.parts])
        names = [[item.name for item in variables(part.model.inputs)] for part in self.parts]
        found = [(self.parts[wire.source], self.parts[wire.target], names[wire.target][wire.input]) for wire in wires]
        return [(sender, receiver, name) for sender, receiver, name in found if receiver.model.shows(name)]

    def outputs(self) -> Iterator[tuple[FmuPart, FmiVariable, str]]:
        """Yield each output with its name in the system: its own, with that of its part if others are called so too."""
        known = [(part, variable) for part in self.parts for variable in part.of("output")]
        names = [variable.name for _, variable in known]
        for part, variable in known:
            alone = names.count(variable.name) == 1
            yield part, variable, variable.name if alone else f"{part.name}_{variable.name}"
