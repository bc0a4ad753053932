"""A closed loop of vehicle and parking assist in this process, and scenes to search in."""

import math
from typing import Any, NamedTuple

from controller_fmu.registry import ControllerOutput
from modelkit.car import Car, CarSteering, CarUltrasonic, mounts_on
from orchestrator.inputs.scenario.car import car_parameters
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


RADIUS = 4.8
CAR = Car(
    wheelbase=2.62,
    front_overhang=0.966,
    rear_overhang=0.85,
    width=1.82,
    steering=CarSteering(angle_limit=19.0 * math.atan(2.62 / RADIUS)),
    ultrasonic=CarUltrasonic(mounts_on(2.62 + 0.966, 0.85, 0.91)),
)


def car_settings(car: Car) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return (vehicle, controller) parameters of a car and of an assist that knows it."""
    return car_parameters(car), {**car_parameters(car), "system": 5}


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
