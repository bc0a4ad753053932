"""The pair of FMUs as a system: which part feeds which, with the parameters of one scenario."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from fmus.contents.variables import FmiVariable, shown_variables
from modelkit.connections import connections, part_of
from modelkit.model import Model
from modelkit.variables import variables

NAME = "ParkingSystem"


class Part(NamedTuple):
    """One FMU in its place."""

    name: str
    model: Model
    fmu: Path
    parameters: Mapping[str, Any]
    """Flat name -> value of the parameters that differ from the FMU's own."""

    def of(self, causality: str) -> list[FmiVariable]:
        """Return the variables of this causality."""
        return [variable for variable in shown_variables(self.model) if variable.causality == causality]

    def settings(self) -> list[tuple[FmiVariable, Any]]:
        """Return (parameter, value of its own type). Raises ``KeyError`` for a name the model does not have."""
        known = {variable.name: variable for variable in self.of("parameter")}
        return [(known[name], known[name].kind(value)) for name, value in self.parameters.items()]


class System(NamedTuple):
    """Parts, and the times of the experiment."""

    parts: tuple[Part, ...]
    step: float
    """Communication step [s]."""
    stop: float
    """Stop time [s]."""

    def connections(self) -> list[tuple[Part, Part, str]]:
        """Return (sender, receiver, name) of every signal: an output and an input of the same name are connected."""
        wires = connections([part_of(part.name, part.model) for part in self.parts])
        names = [[item.name for item in variables(part.model.inputs)] for part in self.parts]
        return [(self.parts[wire.source], self.parts[wire.target], names[wire.target][wire.input]) for wire in wires]
