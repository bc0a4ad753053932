"""A closed loop of vehicle and parking assist in this process, and scenes to search in."""

import math
from typing import Any, NamedTuple

from controller_fmu.interface import ControllerOutput
from tests.controller.in_process import run
from vehicle_fmu.interface import VehicleOutput

STEP_NS = 10_000_000
FINAL = (9, 10, 11)


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
    done = Run(0.0, VehicleOutput(), ControllerOutput(), 1e9, 0.0, 0.0, [])
    confirmed = end = -1.0

    def look(t_ns: int, seen: VehicleOutput, asked: ControllerOutput) -> bool:
        nonlocal done, confirmed, end
        t = t_ns * 1e-9
        done = done._replace(time=t, vehicle=seen, controller=asked)
        if keep:
            done.rows.append((t, seen, asked))
        if asked.apa.mode in (4, 5):
            confirmed = t if confirmed < 0.0 else confirmed
            nearest, fastest = min(done.nearest, seen.clearance), max(done.fastest, abs(seen.speed))
            done = done._replace(nearest=nearest, fastest=fastest)
        if asked.phase in FINAL and abs(seen.speed) < 1e-3:
            end = t if end < 0.0 else end
        return end >= 0.0 and t - end > 0.5

    run({"vehicle": vehicle, "controller": controller}, round(stop * 1e9), STEP_NS, look)
    return done._replace(parking_time=end - confirmed)
