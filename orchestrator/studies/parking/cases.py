"""The cases of the parking assist's grid and their scenarios.

Every case is made from its number alone, so that a failing run is repeated by its number.
"""

import itertools
import math
import random
from functools import cache
from typing import Any, NamedTuple

from modelkit.car import Car, CarSteering, CarUltrasonic, mounts_on
from orchestrator.inputs.scenario.car import car_parameters
from orchestrator.inputs.scenario.requirements import Requirement, library_requirements
from orchestrator.inputs.scenario.scenario import Scenario, Slot, Target
from orchestrator.inputs.scenario.slot_sizes import ParkingType, library_slot_sizes, shortest_slot
from orchestrator.studies.parking.system_signals import APA_SYSTEM

ISO = library_slot_sizes("iso16787")
BODIES = ("kinematic", "double_track")
BODY = {"kinematic": 0, "double_track": 2}
STEERING_RATIO = 19.0


def _car(wheelbase: float, front: float, rear: float, width: float, radius: float) -> Car:
    """Return a car from wheelbase, overhangs, width and the turning radius of its rear axle's middle [m]."""
    sensors = CarUltrasonic(mounts_on(wheelbase + front, rear, 0.5 * width))
    steering = CarSteering(STEERING_RATIO, STEERING_RATIO * math.atan(wheelbase / radius))
    return Car(wheelbase, front, rear, width, steering=steering, ultrasonic=sensors)


CARS = {
    "small": _car(2.405, 0.80, 0.60, 1.65, 4.166),
    "large": _car(2.62, 0.966, 0.85, 1.82, 4.8),
    "middle": _car(2.579, 0.88, 0.839, 1.674, 5.0),
}
"""Cars of the studies: the small one has the outline and the turning circle of the car of Guo 2015, the large one the
outline of that of Zhang 2022 with a wider circle, the middle one is of no paper. Whoever asks for a car of a file has
``cars/``."""
EXTRA: dict[int, tuple[float, ...]] = {
    ParkingType.PARALLEL: (0.0, 0.4, 0.8, 1.6),
    ParkingType.PERPENDICULAR: (0.0, 0.3, 0.8),
}
"""Length (width) over the shortest of ISO 16787 [m]."""
BESIDE = (0.5, 1.0, 1.5)
HEADINGS = (-5.0, 0.0, 5.0)
SPEEDS = (1.0, 2.5, 20.0 / 3.6)
SEED_STRIDE = 10_000
SEED_COUNT = 2**31
"""A sensor's seed is below it, whatever the ``lot``."""
STOP_TIME = 150.0
WALL_DISTANCE = 0.4
"""A wall stands so much [m] deeper than the car is wide behind a parallel slot."""
PERPENDICULAR_DEPTH = 4.6
"""Of the neighbours of a perpendicular slot [m]."""
KINDS: dict[int, str] = {ParkingType.PARALLEL: "parallel", ParkingType.PERPENDICULAR: "perpendicular"}
SIDES = {1: "right", -1: "left"}


class GridCase(NamedTuple):
    """One run of the grid."""

    number: int
    car: str
    kind: int
    side: int
    """1 right, -1 left."""
    extra: float
    beside: float
    """Lateral distance to the neighbours where the car comes nearest to them [m]."""
    heading: float
    """Against the road [rad], positive away from the slot."""
    body: str
    speed: float
    """Of the driver during the search [m/s]."""
    length: float
    """Of the slot along the road [m]."""
    lot: int
    """Which draw of speeds, noise and odometry errors."""


@cache
def cases(lot: int = 0) -> list[GridCase]:
    """Return the whole grid; random values follow from the case's number and ``lot``."""
    slots = [(kind, side, extra) for kind in EXTRA for side in SIDES for extra in EXTRA[kind]]
    found = []
    everything = itertools.product(CARS, slots, BESIDE, HEADINGS, BODIES)
    for number, (car, (kind, side, extra), beside, degrees, body) in enumerate(everything):
        speed = SPEEDS[random.Random(number + SEED_STRIDE * lot).randrange(len(SPEEDS))]
        length = shortest_slot(kind, CARS[car], ISO) + extra
        heading = math.radians(degrees)
        found.append(GridCase(number, car, kind, side, extra, beside, heading, body, speed, length, lot))
    return found


def parameters(case: GridCase) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return (vehicle, controller) parameters of a case."""
    car = CARS[case.car]
    draw = random.Random(1000 + case.number + SEED_STRIDE * case.lot)
    vehicle: dict[str, Any] = {**car_parameters(car), "body": BODY[case.body]}
    controller: dict[str, Any] = {**car_parameters(car), "system": APA_SYSTEM}
    vehicle |= {
        "ultrasonic.noise": 0.01,
        "ultrasonic.dropout": 0.01,
        "ultrasonic.seed": (case.number + 1 + SEED_STRIDE * case.lot) % SEED_COUNT,
    }
    vehicle |= {"odometry.ideal": False, "odometry.radius_error": draw.uniform(-0.005, 0.005), "odometry.tick": 0.02}
    vehicle |= {"odometry.steering_offset": draw.uniform(-0.001, 0.001), "odometry.steering_resolution": 0.001}
    vehicle |= {"driver.apa_switch_time": 0.5, "driver.profile[1].speed": case.speed}
    return vehicle | _scene(case, car.front_overhang + car.rear_overhang + car.wheelbase, car.width), controller


def _scene(case: GridCase, length: float, width: float) -> dict[str, Any]:
    """Return two neighbours, behind a parallel slot a wall, and the start."""
    along, deep = (4.4, 1.8) if case.kind == ParkingType.PARALLEL else (1.8, PERPENDICULAR_DEPTH)
    boxes = [(-along, 0.0, -deep, 0.0), (case.length, case.length + along, -deep, 0.0)]
    if case.kind == ParkingType.PARALLEL:
        boxes.append((-12.0, case.length + 12.0, -width - WALL_DISTANCE - 1.0, -width - WALL_DISTANCE))
    scene: dict[str, Any] = {}
    for number, (x0, x1, y0, y1) in enumerate(boxes, start=1):
        name = f"scene.boxes[{number}]."
        scene |= {name + "x": 0.5 * (x0 + x1), name + "y": 0.5 * (y0 + y1) * case.side}
        scene |= {name + "length": x1 - x0, name + "width": y1 - y0}
    start = -along - 5.0
    nearest = -along if case.heading > 0.0 else case.length + 3.0
    y = case.beside + 0.5 * width + (start - nearest) * math.tan(case.heading)
    if case.heading > 0.0:
        y += 0.5 * length * math.sin(case.heading)
    return scene | {"start.x": start, "start.y": case.side * y, "start.heading": case.side * case.heading}


def standing_of(case: GridCase) -> tuple[Target, Slot]:
    """Return target and slot: corner A at the origin, the car in the middle, flush with its neighbours."""
    car = CARS[case.car]
    wheelbase, front, rear, width = car.wheelbase, car.front_overhang, car.rear_overhang, car.width
    middle, turn = 0.5 * case.length, 0.5 * math.pi * case.side
    if case.kind == ParkingType.PARALLEL:
        depth = width + WALL_DISTANCE
        target = Target(x=middle - 0.5 * (wheelbase + front - rear), y=-0.5 * case.side * width)
        return target, Slot(x=middle, y=-0.5 * case.side * depth, length=case.length, width=depth)
    depth = PERPENDICULAR_DEPTH
    target = Target(x=middle, y=-case.side * (wheelbase + front), heading=turn)
    return target, Slot(x=middle, y=-0.5 * case.side * depth, heading=turn, length=depth, width=case.length)


def scenario_of(case: GridCase) -> Scenario:
    """Return the scenario of a case; the assist receives neither slot nor target."""
    vehicle, controller = parameters(case)
    target, slot = standing_of(case)
    return Scenario(
        name="apa-grid",
        stop_time=STOP_TIME,
        vehicle=vehicle,
        controller=controller,
        target=target,
        slot=slot,
        requirements=[*gbt_limits("gbt41630"), *library_requirements("no-contact")],
    )


def gbt_limits(name: str) -> list[Requirement]:
    """Return a set of GB/T 41630's limits but for the speed, which is asked of parking, not of the way past."""
    return [item for item in library_requirements(name) if item.id != "speed"]
