"""What the bake-off drives: controllers, slots, cars, starts, bodies, disturbances, as scenarios.

Every slot lies between two parked cars before a wall; its target has the car flush with the neighbours.
The controllers receive slot, target and start. A system that searches its slot is a model of its own: it has other
studies.
"""

import itertools
import math
from collections.abc import Iterator
from functools import lru_cache

from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.requirements import library_requirements
from orchestrator.inputs.scenario.scenario import Scenario, Slot
from orchestrator.studies.sweep.study.cases import LabelledScenario
from vehicle_fmu.interface import Body

CONTROLLERS = ("ntbptcwpt", "ntbpt", "adaptive", "zhang2022", "hsic")
SLOTS = (6.2, 7.7, 9.2)
"""Lengths [m]."""
CARS = ("guo2015", "zhang2022")
BODIES = ("kinematic", "double_track")
STARTS = {"near": (1.15, 3.0, 0.0), "far": (2.05, 2.8, 0.0), "yawed": (2.05, 2.8, 2.0)}
"""Start pose: x ahead of the slot's front end [m], y from the target [m], heading [deg]."""
DISTURBANCES: dict[str, dict[str, float]] = {
    "none": {},
    "steering 5 % slow": {"vehicle.car.steering.ratio": 1.05},
    "driver 60 % fast": {"vehicle.driver.speed_error": 0.6},
    "wheel radius 1 % off": {"vehicle.odometry.radius_error": 0.01},
    "steering dead time 0.1 s": {"vehicle.steering.dead_time": 0.1},
}
"""Changed parameters; a steering ratio is a factor on the car's own."""
REAR_END, DEPTH = -1.25, 2.2
"""The slot's rear end from the target, and its depth from the neighbours to the wall [m]."""
NEIGHBOUR_LENGTH, NEIGHBOUR_WIDTH, WALL_LENGTH, WALL_WIDTH = 4.4, 1.8, 40.0, 1.0
DRIVER_SPEED = 0.5
"""Of the driver while parking [m/s]."""
LABELS = ("controller", "slot", "car", "body", "start", "disturbance")
LIMITS = ("gbt41630", "no-contact")
"""What a parked car is judged by."""
UNJUDGED = ("vehicle.speed",)
"""GB/T's limit on the speed while parking."""


def entries() -> Iterator[LabelledScenario]:
    """Yield every drive: the product of all of the above."""
    for labels in itertools.product(CONTROLLERS, SLOTS, CARS, BODIES, STARTS, DISTURBANCES):
        yield LabelledScenario(dict(zip(LABELS, labels, strict=True)), scenario_of(*labels))


def scenario_of(controller: str, slot: float, car: str, body: str, start: str, disturbance: str) -> Scenario:
    """Return the scenario of one run."""
    base = _base(controller, slot, car)
    ahead, y, degrees = STARTS[start]
    x = REAR_END + slot + ahead
    vehicle = {**base.vehicle, "body": int(Body[body.upper()]), "start.x": x, "start.y": y}
    vehicle["start.heading"] = math.radians(degrees)
    for key, value in DISTURBANCES[disturbance].items():
        name = key.removeprefix("vehicle.")
        vehicle[name] = vehicle[name] * value if name == "car.steering.ratio" else value
        if name.startswith("odometry"):
            vehicle["odometry.ideal"] = False
    return base.model_copy(update={"vehicle": vehicle})


@lru_cache
def _base(controller: str, slot: float, car: str) -> Scenario:
    """Return the scenario without start, body and disturbance."""
    sets = {
        "car": car,
        "stop_time": 120,
        "vehicle.driver.profile[1].speed": DRIVER_SPEED,
        "controller.system": controller,
    }
    loaded = load_scenario("zhang2022", [f"{key}={value}" for key, value in sets.items()])
    line = 0.5 * loaded.vehicle["car.width"]
    vehicle = {**loaded.vehicle, **_scene(slot, line)}
    reported = {"hsic.slot.slot_length": slot, "hsic.slot.slot_width": loaded.vehicle["car.width"]}
    reported["hsic.slot.rear_gap"] = -REAR_END - loaded.vehicle["car.rear_overhang"]
    room = {"slot_front": REAR_END + slot, "slot_rear": -REAR_END, "line": line, "depth": DEPTH}
    reported |= {f"adaptive.room.{key}": value for key, value in room.items()}
    true = Slot(x=REAR_END + 0.5 * slot, y=line - 0.5 * DEPTH, length=slot, width=DEPTH)
    limits = [item for name in LIMITS for item in library_requirements(name) if item.signal not in UNJUDGED]
    controls = {**loaded.controller, **reported}
    return loaded.model_copy(update={"slot": true, "vehicle": vehicle, "controller": controls}).with_requirements(
        limits
    )


def _scene(slot: float, line: float) -> dict[str, float]:
    """Return the car in front, the one behind, both flush with ``line`` [m], and the wall beside the slot."""
    middle = line - 0.5 * NEIGHBOUR_WIDTH
    front = REAR_END + slot + 0.5 * NEIGHBOUR_LENGTH
    things = (
        (front, middle, NEIGHBOUR_LENGTH, NEIGHBOUR_WIDTH),
        (REAR_END - 0.5 * NEIGHBOUR_LENGTH, middle, NEIGHBOUR_LENGTH, NEIGHBOUR_WIDTH),
        (0.0, line - DEPTH - 0.5 * WALL_WIDTH, WALL_LENGTH, WALL_WIDTH),
    )
    scene: dict[str, float] = {}
    for number, thing in enumerate(things, start=1):
        names = (f"scene.boxes[{number}].{key}" for key in ("x", "y", "length", "width"))
        scene |= dict(zip(names, thing, strict=True))
    return scene
