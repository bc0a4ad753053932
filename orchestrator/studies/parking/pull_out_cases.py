"""Slots that the assist comes out of, at random: kinds, sides, room, kerbs and walls, streets, neighbours, cars.

All of a run follows from its number and ``lot``. The row lies along x at y < 0, its line at y = 0, the road at y > 0;
the car stands along the row, or across it with its nose to the road, and comes out to the left. To the right is the
mirror image.
"""

import math
import random
from typing import Any, NamedTuple

from controller_fmu.common.driver_selection import ChosenSide
from modelkit.car import car_length
from orchestrator.inputs.scenario.car import car_parameters
from orchestrator.inputs.scenario.slot_sizes import ParkingType
from orchestrator.studies.parking.cases import BODY, CARS, KINDS
from orchestrator.studies.parking.imperfect import imperfect

SEED_STRIDE = 100_000
LENGTH, WIDTH = 4.4, 1.8
"""Of the neighbours [m]."""
ROOM: dict[int, tuple[float, float]] = {ParkingType.PARALLEL: (0.5, 2.0), ParkingType.PERPENDICULAR: (0.6, 1.6)}
"""By how much the slot is longer, or wider, than the car [m]."""
MIN_NEIGHBOUR_GAP = 0.2
"""The car stands no nearer to a neighbour [m]."""
BEHIND = ("nothing", "kerb", "wall")
"""What a parallel slot ends at; across the road a wall or nothing behind the tail."""
BESIDE = {"kerb": (0.1, 0.35), "wall": (0.15, 0.5)}
AT_TAIL = (0.2, 0.8)
STREETS = (5.5, 6.5, 8.0, 0.0)
"""From the row's line to a wall across the road [m]; 0: none."""
STAGGER = (-0.2, 0.3)
"""Neighbours stand further out than the car by this [m]."""
MAX_MISALIGNMENT = math.radians(2.0)
WALL_THICKNESS = 1.0


class PullOutCase(NamedTuple):
    """One run."""

    number: int
    lot: int
    kind: int
    side: int
    """Out to the left 1, to the right -1."""
    car: str
    body: str
    extra: float
    """Room [m] between the neighbours beyond the car's length, or width."""
    share: float
    """Of the room behind the car, or on its right."""
    misalignment: float
    """Of the car against the row [rad]."""
    behind: str
    beside: float
    """From the car to what the slot ends at [m]."""
    street: float
    out_a: float
    """How far the neighbour behind, or on the right, stands out further than the car [m]."""
    out_b: float


def cases(runs: int, lot: int = 0) -> list[PullOutCase]:
    """Return so many cases."""
    return [case_of(number, lot) for number in range(runs)]


def case_of(number: int, lot: int) -> PullOutCase:
    """Return one case."""
    draw = random.Random(number + SEED_STRIDE * lot)
    kind = draw.choice(list(ROOM))
    extra = draw.uniform(*ROOM[kind])
    least = MIN_NEIGHBOUR_GAP / extra
    behind = draw.choice(BEHIND)
    beside = draw.uniform(*BESIDE.get(behind, (0.0, 0.0))) if kind == ParkingType.PARALLEL else draw.uniform(*AT_TAIL)
    return PullOutCase(
        number=number,
        lot=lot,
        kind=kind,
        side=draw.choice((1, -1)),
        car=draw.choice(list(CARS)),
        body=draw.choice(("kinematic", "double_track")),
        extra=extra,
        share=draw.uniform(least, 1.0 - least),
        misalignment=draw.uniform(-MAX_MISALIGNMENT, MAX_MISALIGNMENT),
        behind=behind if kind == ParkingType.PARALLEL or behind == "wall" else "nothing",
        beside=beside,
        street=draw.choice(STREETS),
        out_a=draw.uniform(*STAGGER),
        out_b=draw.uniform(*STAGGER),
    )


class Footprint(NamedTuple):
    """A rectangle, and where it stands."""

    x0: float
    x1: float
    y0: float
    y1: float


def start_of(case: PullOutCase) -> tuple[float, float, float]:
    """Return where the rear axle of a car stands that comes out to the left: x, y, heading; its outer end at y = 0."""
    car = CARS[case.car]
    if case.kind == ParkingType.PARALLEL:
        return case.share * case.extra + car.rear_overhang, -0.5 * car.width, case.misalignment
    x = case.share * case.extra + 0.5 * car.width
    return x, -car.wheelbase - car.front_overhang, 0.5 * math.pi + case.misalignment


def footprints_of(case: PullOutCase) -> dict[str, Footprint]:
    """Return what stands there on the left: neighbours, what the slot ends at, the other side of the street."""
    car = CARS[case.car]
    across = case.kind == ParkingType.PERPENDICULAR
    along, deep = (WIDTH, LENGTH) if across else (LENGTH, WIDTH)
    size, depth = (car.width, car_length(car)) if across else (car_length(car), car.width)
    end = -depth - case.beside
    found = {
        "first": Footprint(-along, 0.0, case.out_a - deep, case.out_a),
        "second": Footprint(size + case.extra, size + case.extra + along, case.out_b - deep, case.out_b),
    }
    if case.behind == "wall":
        found["wall"] = Footprint(-12.0, size + case.extra + 12.0, end - WALL_THICKNESS, end)
    if case.street > 0.0:
        found["across"] = Footprint(-40.0, 50.0, case.street, case.street + WALL_THICKNESS)
    if case.behind == "kerb":
        found["kerb"] = Footprint(-15.0, 25.0, end, end)
    return found


def vehicle_of(case: PullOutCase) -> dict[str, Any]:
    """Return the parameters of the vehicle."""
    footprints = footprints_of(case)
    scene: dict[str, Any] = {}
    for number, name in enumerate(("first", "second", "wall", "across"), start=1):
        footprint = footprints.get(name, Footprint(0.0, 0.0, 0.0, 0.0))
        box = {"x": 0.5 * (footprint.x0 + footprint.x1), "y": 0.5 * case.side * (footprint.y0 + footprint.y1)}
        box |= {"length": footprint.x1 - footprint.x0, "width": footprint.y1 - footprint.y0}
        scene |= {f"scene.boxes[{number}].{key}": value for key, value in box.items()}
    if "kerb" in footprints:
        kerb = footprints["kerb"]
        line = {"x1": kerb.x0, "y1": case.side * kerb.y0, "x2": kerb.x1, "y2": case.side * kerb.y1, "height": 0.12}
        scene |= {f"scene.kerbs[1].{key}": value for key, value in line.items()}
    x, y, heading = start_of(case)
    place = {"start.x": x, "start.y": case.side * y, "start.heading": case.side * heading}
    seed = case.number + 1 + SEED_STRIDE * case.lot
    errors = imperfect(seed, random.Random(seed + 29)) | {"body": BODY[case.body]}
    return {**car_parameters(CARS[case.car]), **scene, **place, "driver.apa_switch_time": 0.5, **errors}


def side_of(case: PullOutCase) -> int:
    """Return what the driver chooses."""
    return ChosenSide.LEFT if case.side > 0 else ChosenSide.RIGHT


def case_labels(case: PullOutCase) -> dict[str, str | float]:
    """Return what a case is called in the table."""
    return {**case._asdict(), "kind": KINDS[case.kind]}
