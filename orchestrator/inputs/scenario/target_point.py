"""A target given by a point of the car's outline, so that it means the same place for cars of any size.

``target: {reference_point: left, x: 3.1, y: 0}`` places the middle of the car's left
side there, whatever its length and width. The pose of the rear axle follows from it and from the car of the vehicle.
"""

import math
from collections.abc import Mapping
from typing import Any

from modelkit.car import Car
from modelkit.variables import with_values
from orchestrator.inputs.scenario.scenario import Target
from orchestrator.inputs.text.errors import BadInput, format_value

REFERENCE_POINT = "reference_point"
POINTS = ("rear_axle", "front", "rear", "left", "right", "middle")
"""Middle of the rear axle, of the bumpers, of the sides, of the outline."""


def as_rear_axle(target: object, vehicle: Mapping[str, Any], file: object) -> object:
    """Return a target without ``reference_point``: the pose of the rear axle of a vehicle with these parameters."""
    if not isinstance(target, Mapping) or REFERENCE_POINT not in target:
        return target
    point = target[REFERENCE_POINT]
    if point not in POINTS:
        raise BadInput(
            f"{format_value(point)}: expected one of {', '.join(POINTS)}", file=file, key=f"target.{REFERENCE_POINT}"
        )
    meant = Target.model_validate({name: value for name, value in target.items() if name != REFERENCE_POINT})
    own = {name.removeprefix("car."): value for name, value in vehicle.items() if name.startswith("car.")}
    along, left = _offset(str(point), with_values(Car, own))
    c, s = math.cos(meant.heading), math.sin(meant.heading)
    return {"x": meant.x - along * c + left * s, "y": meant.y - along * s - left * c, "heading": meant.heading}


def _offset(point: str, car: Car) -> tuple[float, float]:
    """Return where a point of the outline lies: ahead of the rear axle's middle, and to its left [m]."""
    front = car.wheelbase + car.front_overhang
    middle = 0.5 * (front - car.rear_overhang)
    half = 0.5 * car.width
    return {
        "rear_axle": (0.0, 0.0),
        "front": (front, 0.0),
        "rear": (-car.rear_overhang, 0.0),
        "left": (middle, half),
        "right": (middle, -half),
        "middle": (middle, 0.0),
    }[point]
