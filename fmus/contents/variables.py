"""The variables of an FMU, from the types of its model: names, value references, causality, variability, limits."""

import math
from enum import IntEnum
from typing import Any, NamedTuple

from modelkit.model import Model
from modelkit.signal import Role, Signal
from modelkit.variables import Variable, limits_of, variables

ORDER = ("input", "output", "parameter", "local", "independent")
"""Causalities as modelDescription.xml has them: what is connected first."""
FMI_TYPES = {float: "Real", int: "Integer", bool: "Boolean"}
LARGEST_INTEGER = 2**31 - 1
TIME = Signal("s", "simulation time")


class FmiVariable(NamedTuple):
    """One scalar variable of an FMU."""

    name: str
    vr: int
    """Value reference: the place in the list, from 0; one running number over all FMI types."""
    kind: type
    """``float``, ``int`` or ``bool``."""
    causality: str
    variability: str
    initial: str | None
    start: Any
    """Start value of a parameter or input; None for outputs and time, which are calculated."""
    signal: Signal
    is_exposed: bool = True
    """False: it has place and start value, but the description does not name it (see ``modelkit.model.Variant``)."""

    @property
    def fmi_type(self) -> str:
        """Return ``Real``, ``Integer`` or ``Boolean``."""
        return FMI_TYPES[self.kind]


def fmi_variables(model: Model) -> list[FmiVariable]:
    """Return all variables in the order of their value references: parameters, inputs, outputs, then ``time``.

    Outputs for logs and judges have the causality ``local``. Parameters are ``tunable`` or ``fixed``, outputs of a
    sampled model ``discrete``.

    Raises ``ValueError`` for a name used twice, a missing description or a start value outside its range.
    """
    found: list[FmiVariable] = []
    for item in variables(model.params, model.first_params()):
        variability = "tunable" if Role.TUNABLE in item.roles else "fixed"
        found.append(_variable(model, item, len(found), "parameter", variability, "exact"))
    for item in variables(model.inputs):
        found.append(_variable(model, item, len(found), "input", _of_signal(item, False), None))
    for item in variables(model.outputs):
        causality = "local" if Role.LOCAL in item.roles else "output"
        variability = _of_signal(item, model.sampled or Role.SAMPLED in item.roles)
        found.append(_variable(model, item, len(found), causality, variability, "calculated"))
    found.append(FmiVariable("time", len(found), float, "independent", "continuous", None, None, TIME))
    _check(model.name, found)
    return found


def visible_variables(model: Model) -> list[FmiVariable]:
    """Return the variables that an importer sees, in the order of the description."""
    shown = [variable for variable in fmi_variables(model) if variable.is_exposed]
    return sorted(shown, key=lambda variable: ORDER.index(variable.causality))


def _variable(
    model: Model, item: Variable, vr: int, causality: str, variability: str, initial: str | None
) -> FmiVariable:
    start = item.start if initial != "calculated" else None
    states = dict(model.view.states).get(item.name, item.signal.states)
    signal = item.signal._replace(states=states)
    return FmiVariable(item.name, vr, item.kind, causality, variability, initial, start, signal, model.shows(item.name))


def _of_signal(item: Variable, sampled: bool) -> str:
    return "continuous" if item.kind is float and not sampled else "discrete"


def describe(variable: FmiVariable) -> str:
    """Return the variable's description: meaning, names of the states, source of a default."""
    signal = variable.signal
    text = signal.text
    if signal.states is not None:
        text += f": {states_text(signal.states)}"
    if signal.source:
        text += f" (default: {signal.source})"
    return text


def limits(variable: FmiVariable) -> tuple[float | None, float | None]:
    """Return the smallest and largest value allowed, None where there is no limit; a mode's from its states."""
    if variable.kind is bool:
        return None, None
    low, high = limits_of(variable.signal)
    return (low if math.isfinite(low) else None), (high if math.isfinite(high) else None)


def states_text(mode: type[IntEnum]) -> str:
    """Return value and name of each state of a mode."""
    return ", ".join(f"{state.value} {state.name}" for state in mode)


def mode_types(model: Model) -> dict[type[IntEnum], str]:
    """Return a name for the type of each mode: that of its enumeration, with its package where two have the same."""
    modes = dict.fromkeys(item.signal.states for item in fmi_variables(model) if item.signal.states is not None)
    names = [mode.__name__ for mode in modes]
    return {mode: mode.__name__ if names.count(mode.__name__) == 1 else _full_name(mode) for mode in modes}


def _full_name(mode: type[IntEnum]) -> str:
    return f"{mode.__module__.split('.')[-2]}.{mode.__name__}"


def _check(model_name: str, known: list[FmiVariable]) -> None:
    names: set[str] = set()
    for variable in known:
        where = f"{model_name}: {variable.name}"
        if variable.name in names:
            raise ValueError(f"{where}: this name is used twice among parameters, inputs and outputs")
        names.add(variable.name)
        if not variable.signal.text:
            raise ValueError(f"{where}: give the field a unit and a meaning: Annotated[..., Signal(unit, text)]")
        if variable.start is None or variable.kind is bool:
            continue
        low, high = limits(variable)
        if not math.isfinite(variable.start) or (variable.kind is int and abs(variable.start) > LARGEST_INTEGER):
            raise ValueError(f"{where}: start {variable.start} cannot be written in FMI 2.0")
        if (low is not None and variable.start < low) or (high is not None and variable.start > high):
            raise ValueError(f"{where}: start {variable.start} is outside [{low}, {high}]")
