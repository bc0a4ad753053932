"""A closed loop of vehicle and parking assist in this process, and scenes to search in."""

import math
from typing import Any, NamedTuple

import controller_fmu
import vehicle_fmu
from controller_fmu.interface import ControllerInput, ControllerOutput, ControllerParams
from modelkit.variables import with_values
from vehicle_fmu.interface import VehicleInput, VehicleOutput, VehicleParams

STEP_NS = 10_000_000
FINAL = (9, 10, 11)
SHARED_INPUTS = [name for name in ControllerInput._fields if name in VehicleOutput._fields]
SHARED_OUTPUTS = [name for name in VehicleInput._fields if name in ControllerOutput._fields]


class Run(NamedTuple):
    """What is left of a run."""

    time: float
    vehicle: VehicleOutput
    controller: ControllerOutput
    nearest: float
    """Smallest clearance [m] from confirmation on."""
    fastest: float
    parking_time: float
    """From confirmation to the end [s]."""
    rows: list[tuple[float, VehicleOutput, ControllerOutput]]


CAR = {
    "wheelbase": 2.62,
    "front_overhang": 0.966,
    "rear_overhang": 0.85,
    "width": 1.82,
}
RADIUS = 4.8


def car_settings(car: dict[str, float], radius: float) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return (vehicle, controller) parameters of a car with sensors where its outline is."""
    wheel = 19.0 * math.atan(car["wheelbase"] / radius)
    front, rear, half = car["wheelbase"] + car["front_overhang"], -car["rear_overhang"], 0.5 * car["width"]
    vehicle: dict[str, Any] = {**car, "steering.angle_limit": wheel}
    controller: dict[str, Any] = {"system": 5, "wheelbase": car["wheelbase"], "steering_wheel_limit": wheel}
    controller |= {f"apa.{name}": car[name] for name in ("front_overhang", "rear_overhang", "width")}
    places = [
        (front - 0.1, half - 0.15), (front, 0.25), (front, -0.25), (front - 0.1, 0.15 - half),
        (rear + 0.1, half - 0.15), (rear, 0.25), (rear, -0.25), (rear + 0.1, 0.15 - half),
        (front - 0.4, half), (rear + 0.4, half), (front - 0.4, -half), (rear + 0.4, -half),
    ]  # fmt: skip
    for number, (x, y) in enumerate(places, start=1):
        vehicle |= {f"ultrasonic.mounts[{number}].x": x, f"ultrasonic.mounts[{number}].y": y}
        controller |= {f"apa.sensors.mounts[{number}].x": x, f"apa.sensors.mounts[{number}].y": y}
    return vehicle, controller


def box(number: int, x0: float, x1: float, y0: float, y1: float) -> dict[str, float]:
    """Return the parameters of a box of the scene."""
    name = f"scene.boxes[{number}]."
    return {
        name + "x": 0.5 * (x0 + x1),
        name + "y": 0.5 * (y0 + y1),
        name + "length": x1 - x0,
        name + "width": y1 - y0,
    }


def drive(vehicle: dict[str, Any], controller: dict[str, Any], stop: float, keep: bool = False) -> Run:
    """Return the run until half a second after the assist has ended, or until ``stop`` [s]."""
    plant, brain = vehicle_fmu.MODEL, controller_fmu.MODEL
    vehicle_params: VehicleParams = with_values(VehicleParams, vehicle)
    controller_params: ControllerParams = with_values(ControllerParams, controller)
    car, seen = plant.initialize(vehicle_params)
    mind, asked = brain.initialize(controller_params)
    nearest, fastest, confirmed, end, rows, t = 1e9, 0.0, -1.0, -1.0, [], 0.0
    for count in range(int(stop * 1e9) // STEP_NS):
        t = count * STEP_NS * 1e-9
        if keep:
            rows.append((t, seen, asked))
        if asked.apa.mode in (4, 5):
            confirmed = t if confirmed < 0.0 else confirmed
            nearest = min(nearest, seen.clearance)
            fastest = max(fastest, abs(seen.speed))
        if asked.phase in FINAL and abs(seen.speed) < 1e-3:
            end = t if end < 0.0 else end
            if t - end > 0.5:
                break
        inputs = ControllerInput(**{name: getattr(seen, name) for name in SHARED_INPUTS})
        request = VehicleInput(**{name: getattr(asked, name) for name in SHARED_OUTPUTS})
        mind, asked = brain.step(mind, inputs, controller_params, STEP_NS)
        car, seen = plant.step(car, request, vehicle_params, STEP_NS)
    return Run(t, seen, asked, nearest, fastest, end - confirmed, rows)
