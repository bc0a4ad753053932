"""What the bake-off drives: controllers, starts, cars, bodies, disturbances, as scenarios."""

import math
from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

from orchestrator.load_scenario import load_scenario
from orchestrator.scenario import Scenario
from vehicle_fmu.interface import Body

CONTROLLERS = ("ntbptcwpt", "ntbpt", "zhang2022", "hsic")
CARS = ("guo2015", "zhang2022")
BODIES = ("kinematic", "double_track")
STARTS = {"near": (7.6, 3.0, 0.0), "far": (8.5, 2.8, 0.0), "crooked": (8.5, 2.8, 2.0)}
"""Start pose from the place in the slot: x [m], y [m], heading [deg]."""
DISTURBANCES: dict[str, dict[str, float]] = {
    "none": {},
    "steering 5 % slow": {"vehicle.steering.ratio": 1.05},
    "driver 60 % fast": {"vehicle.driver.speed_error": 0.6},
    "wheel radius 1 % off": {"vehicle.odometry.radius_error": 0.01},
    "steering dead time 0.1 s": {"vehicle.steering.dead_time": 0.1},
}
"""Changed parameters; a steering ratio is a factor on the car's own."""
SLOT_WIDTH, SLOT_LENGTH, REAR_GAP = 2.2, 7.7, 0.4
DRIVER_SPEED = 0.5


class Entry(NamedTuple):
    """One run of the bake-off."""

    controller: str
    car: str
    body: str
    start: str
    disturbance: str
    scenario: Scenario


def entries() -> Iterator[Entry]:
    """Yield every run: the product of all of the above."""
    for controller in CONTROLLERS:
        for car in CARS:
            for body in BODIES:
                for start in STARTS:
                    for disturbance in DISTURBANCES:
                        scenario = scenario_of(controller, car, body, start, disturbance)
                        yield Entry(controller, car, body, start, disturbance, scenario)


def scenario_of(controller: str, car: str, body: str, start: str, disturbance: str) -> Scenario:
    """Return the scenario of one run: the slot of zhang2022, a car in front and one behind."""
    base = _base(controller, car)
    x, y, heading = STARTS[start]
    vehicle = {**base.vehicle, "body": int(Body[body.upper()]), "start.x": x, "start.y": y}
    vehicle["start.heading"] = math.radians(heading)
    for key, value in DISTURBANCES[disturbance].items():
        name = key.removeprefix("vehicle.")
        vehicle[name] = vehicle[name] * value if name == "steering.ratio" else value
        if name.startswith("odometry"):
            vehicle["odometry.perfect"] = False
    return base.model_copy(update={"vehicle": vehicle})


@lru_cache
def _base(controller: str, car: str) -> Scenario:
    sets = {
        "stop_time": 120,
        "vehicle.driver.profile[1].speed": DRIVER_SPEED,
        "controller.system": controller,
        "controller.hsic.slot.slot_length": SLOT_LENGTH,
        "controller.hsic.slot.rear_gap": REAR_GAP,
    }
    loaded = load_scenario("zhang2022", [f"car={car}", *(f"{key}={value}" for key, value in sets.items())])
    body = {f"hsic.slot.{key}": loaded.vehicle[key] for key in ("width", "front_overhang", "rear_overhang")}
    return loaded.model_copy(update={"controller": {**loaded.controller, **body}})
