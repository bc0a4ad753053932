"""What the page knows of the models: parameters, inputs and outputs with what they mean, in their order."""

import math
from collections.abc import Mapping
from enum import IntEnum
from typing import Any

from modelkit.model import Model
from modelkit.variables import Variable, limits_of, variables


def models_data(models: Mapping[str, Model]) -> list[dict[str, Any]]:
    """Return the models in the order of their exchange; names of states are in ``states``."""
    return [_model(owner, model) for owner, model in models.items()]


def _model(owner: str, model: Model) -> dict[str, Any]:
    groups = {
        "parameters": variables(model.params, model.first_params()),
        "inputs": variables(model.inputs),
        "outputs": variables(model.outputs),
    }
    data: dict[str, Any] = {name: [_variable(item) for item in items] for name, items in groups.items()}
    modes = {item.signal.states for items in groups.values() for item in items if item.signal.states is not None}
    data["states"] = {mode.__name__: {int(state): state.name for state in mode} for mode in sorted(modes, key=_name)}
    if model.systems is not None:
        data["choice"] = model.systems.parameter
        data["systems"] = [{"values": list(item.values), "own": list(item.own)} for item in model.systems.systems]
    return {"name": owner, **data}


def _name(mode: type[IntEnum]) -> str:
    return mode.__name__


def _variable(item: Variable) -> list[Any]:
    """Return name, unit, meaning, type, start, least, greatest, name of its mode, source of its default."""
    low, high = (end if math.isfinite(end) else None for end in limits_of(item.signal))
    mode = item.signal.states.__name__ if item.signal.states is not None else ""
    return [
        *(item.name, item.signal.unit, item.signal.text, item.kind.__name__, float(item.start)),
        *(low, high, mode, item.signal.source),
    ]
