"""The pair of FMUs as a system: which part feeds which, with the parameters of one scenario."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from fmus.contents.description import FmiVariable, fmi_variables
from modelkit.model import Model

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
        return [variable for variable in fmi_variables(self.model) if variable.causality == causality]

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
        return [
            (sender, receiver, item.name)
            for receiver in self.parts
            for item in receiver.of("input")
            for sender in self.parts
            if sender is not receiver and item.name in {output.name for output in sender.of("output")}
        ]


def as_text(value: Any) -> str:
    """Return a number or truth value as FMI and SSP write it, with all its digits."""
    return str(value).lower() if isinstance(value, bool) else repr(value)
