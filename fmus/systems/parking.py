"""Vehicle and controller with the parameters of a scenario, and both as one model."""

import sys
from collections.abc import Iterable, Mapping
from typing import Any

import controller_fmu
import vehicle_fmu
from fmus.systems.system import identifier
from modelkit.assembly import assembled
from modelkit.model import Model


def parking_parts(vehicle: Mapping[str, Any], controller: Mapping[str, Any]) -> dict[str, Model]:
    """Return the two models with these start values; the controller shows the variables of its chosen system only.

    Raises ``KeyError`` for a parameter that is none, ``ValueError`` for a value out of its range.
    """
    asked = controller.get("system", controller_fmu.MODEL.params().system)
    chosen = next(model for system, model in controller_fmu.SYSTEM_MODELS.items() if system == asked)
    return {"vehicle": vehicle_fmu.MODEL.started(vehicle), "controller": chosen.started(controller)}


def parking_system(scenario: str, title: str, parts: Mapping[str, Model], step_ns: int, opened: Iterable[str]) -> Model:
    """Return the models of a scenario as one, called ``Parking_<scenario>``; they exchange every ``step_ns``.

    ``opened`` are inputs as ``controller.gear`` that are left to others.
    """
    return assembled(identifier(scenario), title, sys.modules[__name__], parts, step_ns, opened)
