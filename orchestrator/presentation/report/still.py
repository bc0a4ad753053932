"""What stands still in the top view: car, slot, target, obstacles, kerbs, sensors, relative to an origin."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from orchestrator.evaluation.verdict.geometry import Box, CarOutline, boxes, kerbs, slot_box, vehicle_parameters
from orchestrator.evaluation.verdict.logged_scenario import read_logged_scenario
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.recording import Recording

Point = tuple[float, float]
MOUNT = re.compile(r"(?:car\.)?(\w+)\.mounts\[(\d+)\]\.x")
"""A sensor's place on the car among the parameters: ``car.ultrasonic.mounts[3].x``."""


def origin_of(recording: Recording) -> Point:
    """Return a whole number of metres near the first finite position: keeps float32 exact far away."""
    x, y = (float(np.round(_first(recording, f"vehicle.pose.{axis}"))) for axis in ("x", "y"))
    return x, y


def still_of(recording: Recording, origin: Point) -> dict[str, Any]:
    """Return the drawing of a run's surroundings for ``template/scene.js``, positions less ``origin`` [m]."""
    scenario, vehicle = read_logged_scenario(recording), recording.parameters_of("vehicle")
    slot, target, around = scenario.slot, scenario.target, vehicle_parameters(scenario, vehicle)
    car = CarOutline.of(around)
    return {
        "origin": list(origin),
        "turn": _first(recording, "vehicle.pose.heading"),
        "car": {"front": car.front, "rear": car.rear, "half": car.half_width, "wheelbase": car.wheelbase},
        "slot": _less(slot_box(slot).outline()[:4], origin) if slot else None,
        "target": [target.x - origin[0], target.y - origin[1], target.heading] if target else None,
        "boxes": [_box(box, origin) for box in boxes(around)] + [_always(item, origin) for item in scenario.obstacles],
        "kerbs": [_less(np.array([[line.x1, line.y1], [line.x2, line.y2]]), origin) for line in kerbs(around)],
        "sensors": sensors(vehicle, recording.signals),
    }


def sensors(vehicle: Mapping[str, float], signals: Mapping[str, Array]) -> list[dict[str, Any]]:
    """Return the distance sensors that are both mounted (parameters) and read out (signals)."""
    found = []
    for name, x in vehicle.items():
        match = MOUNT.fullmatch(name)
        if match is None:
            continue
        group, number = match.groups()
        mount, sensors = name.removesuffix(".x"), name.partition(".mounts")[0]
        y, heading = (vehicle.get(f"{mount}.{field}", 0.0) for field in ("y", "yaw"))
        half, reach = vehicle.get(f"{sensors}.half_angle", 0.5), vehicle.get(f"{sensors}.max_range", 5.0)
        signal = next(
            (text for text in (f"vehicle.{group}[{number}]", f"vehicle.{group}.readings[{number}]") if text in signals),
            None,
        )
        if signal is not None:
            found.append({"signal": signal, "x": x, "y": y, "heading": heading, "half": half, "range": reach})
    return found


def _box(box: Box, origin: Point) -> dict[str, Any]:
    return {"corners": _less(box.outline()[:4], origin), "from": box.appear_at, "to": box.disappear_at}


def _always(corners: Sequence[Point], origin: Point) -> dict[str, Any]:
    return {"corners": _less(np.array(corners), origin), "from": 0.0, "to": 1e9}


def _first(recording: Recording, name: str) -> float:
    """Return the first finite value of a signal, 0 if there is none."""
    values = recording.signals.get(name, np.zeros(0))
    finite = values[np.isfinite(values)]
    return float(finite[0]) if len(finite) else 0.0


def _less(points: Array, origin: Point) -> list[list[float]]:
    return [[round(float(x - origin[0]), 5), round(float(y - origin[1]), 5)] for x, y in points]
