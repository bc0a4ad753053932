"""What an FMU says of itself: its variables as ports, read without asking more of the file than a run needs."""

from pathlib import Path

from fmpy.model_description import ModelDescription, ScalarVariable, read_model_description

from modelkit.model import Model
from modelkit.signal import Role, Signal
from modelkit.variables import Variable, variables
from orchestrator.cosim.slave import Ports
from orchestrator.text.errors import BadInput

KINDS = {"Real": float, "Integer": int, "Enumeration": int, "Boolean": bool}


def read_description(path: Path) -> ModelDescription:
    """Return what the FMU says of itself. Raises ``BadInput`` if the file is no FMI 2.0 co-simulation FMU."""
    try:
        description = read_model_description(str(path), validate=False)
    except Exception as error:
        raise BadInput(f"is not an FMU: {_first_line(error)}", file=path) from error
    if description.fmiVersion != "2.0" or description.coSimulation is None:
        raise BadInput(f"is FMI {description.fmiVersion}; expected FMI 2.0 for co-simulation", file=path)
    return description


def ports_of(description: ModelDescription, causality: str, model: Model | None, path: Path) -> Ports:
    """Return the variables of one causality; states, and units it does not say, are those of ``model``.

    With the outputs come the local variables that ``model`` has too: they are read and logged, not connected. What
    the model has is in its order.

    Raises ``BadInput`` if a start value has no meaning.
    """
    known = {} if model is None else _variables_of(model)
    place = {name: number for number, name in enumerate(known)}
    chosen = [
        item
        for item in description.modelVariables
        if item.type in KINDS and (item.causality == causality or (_is_seen(item, known) and causality == "output"))
    ]
    chosen.sort(key=lambda item: place.get(item.name, len(place)))
    found = [_variable(item, known.get(item.name), path) for item in chosen]
    return Ports(found, frozenset(item.name for item in chosen if item.type == "Real" and _unit(item) is None))


def _is_seen(scalar: ScalarVariable, known: dict[str, Variable]) -> bool:
    return scalar.causality == "local" and scalar.name in known


def _variables_of(model: Model) -> dict[str, Variable]:
    groups = (variables(model.inputs), variables(model.outputs), variables(model.params))
    return {variable.name: variable for group in groups for variable in group}


def _variable(scalar: ScalarVariable, known: Variable | None, path: Path) -> Variable:
    kind = KINDS[scalar.type]
    text = str(scalar.start if scalar.start is not None else "0")
    try:
        start = kind(float({"true": "1", "false": "0"}.get(text.lower(), text)))
    except (ValueError, OverflowError):
        raise BadInput(f"{text!r} is no start value of type {scalar.type}", file=path, key=scalar.name) from None
    unit = _unit(scalar) or ("1" if known is None else known.signal.unit)
    states = known.signal.states if known is not None and known.kind is kind else None
    roles = frozenset({Role.LOCAL} if scalar.causality == "local" else ())
    return Variable(scalar.name, kind, Signal(unit, scalar.description or "", states=states), start, roles)


def _unit(scalar: ScalarVariable) -> str | None:
    return scalar.unit or (scalar.declaredType.unit if scalar.declaredType is not None else None) or None


def _first_line(error: Exception) -> str:
    lines = str(error).splitlines()
    return lines[0] if lines else type(error).__name__
