"""What stands still in the top view: car, slot, target, obstacles, kerbs, sensors, relative to an origin."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from orchestrator.geometry import Car, boxes, slot_box
from orchestrator.recording import Recording
from orchestrator.scenario import Slot
from orchestrator.scene import pose_of
from orchestrator.slave import Array

Point = tuple[float, float]


def origin_of(recording: Recording) -> Point:
    """Return a whole number of metres near the first finite position: keeps float32 exact far away."""
    result = []
    for axis in ("x", "y"):
        values = recording.signals.get(f"vehicle.pose.{axis}", np.zeros(1))
        finite = values[np.isfinite(values)]
        result.append(float(np.round(finite[0])) if len(finite) else 0.0)
    return result[0], result[1]


def still_of(recording: Recording, origin: Point) -> dict[str, Any]:
    """Return the drawing of a run's surroundings for ``template/scene.js``, positions less ``origin`` [m]."""
    vehicle, controller = recording.parameters_of("vehicle"), recording.parameters_of("controller")
    car = Car.of(vehicle)
    slot = recording.info.get("scenario", {}).get("slot")
    target = pose_of(controller, "target")
    return {
        "origin": list(origin),
        "turn": target[2] if target else 0.0,
        "car": {"front": car.front, "rear": car.rear, "half": car.half_width, "wheelbase": car.wheelbase},
        "slot": _less(slot_box(Slot(**slot)).outline()[:4], origin) if slot else None,
        "target": [target[0] - origin[0], target[1] - origin[1], target[2]] if target else None,
        "boxes": [_less(box.outline()[:4], origin) for box in boxes(vehicle)],
        "kerbs": [_less(line, origin) for line in kerbs(vehicle)],
        "sensors": sensors(vehicle, recording.signals),
    }


def kerbs(vehicle: Mapping[str, float]) -> list[Array]:
    """Return the kerb lines among a vehicle's parameters, each (2, 2) [m]; those of no length left out."""
    found = []
    number = 1
    while f"scene.kerbs[{number}].x1" in vehicle:
        x1, y1, x2, y2 = (vehicle[f"scene.kerbs[{number}].{name}"] for name in ("x1", "y1", "x2", "y2"))
        if (x1, y1) != (x2, y2):
            found.append(np.array([[x1, y1], [x2, y2]]))
        number += 1
    return found


def sensors(vehicle: Mapping[str, float], signals: Mapping[str, Array]) -> list[dict[str, Any]]:
    """Return the distance sensors that are both mounted (parameters) and read out (signals)."""
    found = []
    number = 1
    while f"sensors.mounts[{number}].x" in vehicle:
        signal, mount = f"vehicle.ultrasonic[{number}]", f"sensors.mounts[{number}]."
        if signal in signals:
            x, y, heading = (vehicle[mount + name] for name in ("x", "y", "heading"))
            half, reach = vehicle.get("sensors.half_angle", 0.5), vehicle.get("sensors.range", 5.0)
            found.append({"signal": signal, "x": x, "y": y, "heading": heading, "half": half, "range": reach})
        number += 1
    return found


def _less(points: Array, origin: Point) -> list[list[float]]:
    return [[round(float(x - origin[0]), 5), round(float(y - origin[1]), 5)] for x, y in points]
