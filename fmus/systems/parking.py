"""The controller with the system of a scenario alone, and vehicle and controller as one model."""

import sys
from collections.abc import Iterable, Mapping
from typing import Any

import controller_fmu
from fmus.systems.system import identifier
from modelkit.assembly import assemble
from modelkit.model import Model


def of_one_system(model: Model, values: Mapping[str, Any]) -> Model:
    """Return the controller that shows the variables of the system alone that ``values`` choose; others as they are."""
    if model is not controller_fmu.MODEL:
        return model
    asked = values.get("system", model.params().system)
    return next(one for system, one in controller_fmu.SYSTEM_MODELS.items() if system == asked)


def parking_system(scenario: str, title: str, parts: Mapping[str, Model], step_ns: int, opened: Iterable[str]) -> Model:
    """Return the models of a scenario as one, called ``Parking_<scenario>``; they exchange every ``step_ns``.

    ``opened`` are inputs as ``controller.gear`` that are left to others.
    """
    return assemble(identifier(scenario), title, sys.modules[__name__], parts, step_ns, opened)
