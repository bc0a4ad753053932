"""The grid study of the parking assist: cases, how one is set up, driven and judged.

Every case is made from its number alone, so that a failing run is repeated by its number.
"""

import math
import random
from collections.abc import Mapping
from typing import Any, NamedTuple

from controller_fmu.apa.chart import Mode
from controller_fmu.apa.fit import shortest_of_iso
from controller_fmu.apa.params import ApaParams
from controller_fmu.apa.slot import Kind, Side, Slot
from modelkit.vocabulary import Pose
from orchestrator.grid.apa_loop import Loop
from orchestrator.grid.apa_start import is_inside
from orchestrator.grid.apa_verdict import (
    GBT,
    GBT_PERPENDICULAR,
    HOUSE,
    LAST,
    PERPENDICULAR_DEPTH,
    Place,
    is_parked,
    standing,
)
from orchestrator.scenario.sensor_mounts import mounts
from orchestrator.verdict.frame import in_frame

BODIES = ("kinematic", "double_track")
BODY = {"kinematic": 0, "double_track": 2}
CARS: dict[str, tuple[float, float, float, float, float]] = {
    "guo2015": (2.405, 0.80, 0.60, 1.65, 4.166),
    "zhang2022": (2.62, 0.966, 0.85, 1.82, 4.8),
    "commonroad1": (2.579, 0.88, 0.839, 1.674, 5.0),
}
"""Wheelbase, front overhang, rear overhang, width, turning radius of the rear axle's middle [m]."""
RATIO = 19.0
EXTRA: dict[int, tuple[float, ...]] = {Kind.PARALLEL: (0.0, 0.4, 0.8, 1.6), Kind.PERPENDICULAR: (0.0, 0.3, 0.8)}
"""Length (width) over the shortest of ISO 16787 [m]."""
BESIDE = (0.5, 1.0, 1.5)
HEADINGS = (-5.0, 0.0, 5.0)
SPEEDS = (1.0, 2.5, 20.0 / 3.6)
LOTS = 10_000
STOP = 150.0
PARKED, FAILED = int(Mode.PARKING_FINISH), int(Mode.FAIL)
BEHIND = 0.4
"""A wall stands so much [m] deeper than the car is wide behind a parallel slot."""
GHOST = 0.5
"""A slot found further off than this [m], or of the wrong kind, is one that is not there."""
KEPT = (
    *LAST,
    "vehicle.odometry.x",
    "vehicle.odometry.y",
    "vehicle.odometry.heading",
    "vehicle.clearance",
    "controller.phase",
    "controller.reason",
    "controller.shifts",
    "controller.apa.mode",
    "controller.apa.parking_time",
    "controller.apa.slot.a.x",
    "controller.apa.slot.a.y",
    "controller.apa.corner_b.x",
    "controller.apa.corner_b.y",
    "controller.apa.slot.kind",
)
"""Signals that a result is made of."""


class Case(NamedTuple):
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


class Result(NamedTuple):
    """What came of it."""

    case: Case
    mode: int
    phase: int
    reason: int
    standing: dict[str, float]
    """The numbers ``final.*`` against the true slot; where along a parallel slot is the assist's choice."""
    shifts: int
    parking_time: float
    nearest: float
    """Smallest clearance of the whole run [m]."""
    corner_a: float
    """How far from the true corners the car thinks they are when it stands to plan [m], both seen from the car;
    NaN if no slot was found."""
    corner_b: float
    along: float
    """x of the rear axle beyond corner B when the car stood to plan [m]; NaN if it did not."""
    kind: int
    """The slot found: as what, 0 none."""
    inside: bool
    """It stood inside the start range, see :mod:`orchestrator.grid.apa_start`."""


def cases(lot: int = 0) -> list[Case]:
    """Return the whole grid; what is drawn by lot is drawn from the case's number and ``lot``."""
    found: list[Case] = []
    for car, (wheelbase, front, rear, width, _) in CARS.items():
        body_of = ApaParams(front_overhang=front, rear_overhang=rear, width=width)
        for kind in (Kind.PARALLEL, Kind.PERPENDICULAR):
            for side in (1, -1):
                for extra in EXTRA[kind]:
                    for beside in BESIDE:
                        for degrees in HEADINGS:
                            for body in BODIES:
                                number = len(found)
                                speed = SPEEDS[random.Random(number + LOTS * lot).randrange(len(SPEEDS))]
                                length = shortest_of_iso(kind, wheelbase, body_of) + extra
                                heading = math.radians(degrees)
                                found.append(
                                    Case(number, car, kind, side, extra, beside, heading, body, speed, length, lot)
                                )
    return found


def parameters(case: Case) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return (vehicle, controller) parameters of a case."""
    wheelbase, front, rear, width, radius = CARS[case.car]
    lot = random.Random(1000 + case.number + LOTS * case.lot)
    lock = RATIO * math.atan(wheelbase / radius)
    car = {"wheelbase": wheelbase, "front_overhang": front, "rear_overhang": rear, "width": width}
    vehicle: dict[str, Any] = {**car, "body": BODY[case.body], "steering.ratio": RATIO, "steering.angle_limit": lock}
    controller: dict[str, Any] = {"system": 5, "wheelbase": wheelbase, "steering_ratio": RATIO}
    controller |= {"steering_wheel_limit": lock, "steering_wheel_rate": math.radians(570.0)}
    controller |= {f"apa.{name}": car[name] for name in ("front_overhang", "rear_overhang", "width")}
    for number, (x, y) in enumerate(mounts(wheelbase + front, -rear, 0.5 * width), start=1):
        vehicle |= {f"ultrasonic.mounts[{number}].x": x, f"ultrasonic.mounts[{number}].y": y}
        controller |= {f"apa.sensors.mounts[{number}].x": x, f"apa.sensors.mounts[{number}].y": y}
    vehicle |= {
        "ultrasonic.noise": 0.01,
        "ultrasonic.dropout": 0.01,
        "ultrasonic.seed": case.number + 1 + LOTS * case.lot,
    }
    vehicle |= {"odometry.perfect": False, "odometry.radius_error": lot.uniform(-0.005, 0.005), "odometry.tick": 0.02}
    vehicle |= {"odometry.steering_offset": lot.uniform(-0.001, 0.001), "odometry.steering_resolution": 0.001}
    vehicle |= {"driver.apa_switch_time": 0.5, "driver.profile[1].speed": case.speed}
    return vehicle | _scene(case, front + rear + wheelbase, width), controller


def _scene(case: Case, length: float, width: float) -> dict[str, Any]:
    """Return two neighbours, behind a parallel slot a wall, and the start."""
    along, deep = (4.4, 1.8) if case.kind == Kind.PARALLEL else (1.8, PERPENDICULAR_DEPTH)
    things = [(-along, 0.0, -deep, 0.0), (case.length, case.length + along, -deep, 0.0)]
    if case.kind == Kind.PARALLEL:
        things.append((-12.0, case.length + 12.0, -width - BEHIND - 1.0, -width - BEHIND))
    scene: dict[str, Any] = {}
    for number, (x0, x1, y0, y1) in enumerate(things, start=1):
        name = f"scene.boxes[{number}]."
        scene |= {name + "x": 0.5 * (x0 + x1), name + "y": 0.5 * (y0 + y1) * case.side}
        scene |= {name + "length": x1 - x0, name + "width": y1 - y0}
    start = -along - 5.0
    nearest = -along if case.heading > 0.0 else case.length + 3.0
    y = case.beside + 0.5 * width + (start - nearest) * math.tan(case.heading)
    if case.heading > 0.0:
        y = (
            case.beside
            + 0.5 * width
            + (start - nearest) * math.tan(case.heading)
            + 0.5 * length * math.sin(case.heading)
        )
    return scene | {"start.x": start, "start.y": case.side * y, "start.heading": case.side * case.heading}


def drive(case: Case, loop: Loop) -> Result:
    """Return the result of one case."""
    vehicle, controller = parameters(case)
    nearest = math.inf
    shown: Mapping[str, float] | None = None
    last: Mapping[str, float] = {}
    for row in loop.run(vehicle, controller, STOP):
        nearest = min(nearest, row["vehicle.clearance"])
        if row["controller.apa.mode"] == 3 and shown is None:
            shown = row
        last = row
    a, b = (math.nan, math.nan) if shown is None else _corner_errors(case, shown)
    return Result(
        case,
        int(last["controller.apa.mode"]),
        int(last["controller.phase"]),
        int(last["controller.reason"]),
        standing(place_of(case), last),
        int(last["controller.shifts"]),
        last["controller.apa.parking_time"],
        nearest,
        a,
        b,
        math.nan if shown is None else shown["vehicle.pose.x"] - case.length,
        0 if shown is None else int(shown["controller.apa.slot.kind"]),
        shown is not None and is_inside(_pose(shown, "vehicle.pose"), true_slot(case), controller),
    )


def place_of(case: Case) -> Place:
    """Return the slot of a case and the car that shall stand in it."""
    wheelbase, front, rear, width, _ = CARS[case.car]
    return Place(case.kind, case.side, case.length, width + BEHIND, wheelbase, front, rear, width)


def true_slot(case: Case) -> Slot:
    """Return the slot of a case as it is, its corner A at the world's origin."""
    side = int(Side.RIGHT if case.side > 0 else Side.LEFT)
    slot = Slot(case.kind, side, Pose(0.0, 0.0, 0.0), case.length)
    return slot._replace(depth=CARS[case.car][3] + BEHIND) if case.kind == Kind.PARALLEL else slot


def _corner_errors(case: Case, row: Mapping[str, float]) -> tuple[float, float]:
    """Return the distances [m] of A and B as believed from the true corners, seen from the car.

    What the odometry has drifted before it saw the corner does not matter, what it drifts after does.
    """
    true, believed = _pose(row, "vehicle.pose"), _pose(row, "vehicle.odometry")
    found = ((row[f"controller.apa.{name}.x"], row[f"controller.apa.{name}.y"]) for name in ("slot.a", "corner_b"))
    pairs = zip(found, ((0.0, 0.0), (case.length, 0.0)), strict=True)
    a, b = (math.dist(_seen_from(believed, one), _seen_from(true, other)) for one, other in pairs)
    return a, b


def _pose(row: Mapping[str, float], name: str) -> Pose:
    return Pose(row[f"{name}.x"], row[f"{name}.y"], row[f"{name}.heading"])


def _seen_from(pose: Pose, point: tuple[float, float]) -> tuple[float, float]:
    return in_frame(*point, 0.0, pose)[:2]


def is_within_gbt(result: Result) -> bool:
    """Return whether the car is parked within GB/T 41630, as far as it speaks of the end, and touched nothing."""
    return _is_parked(result, *_gbt(result.case.kind))


def is_within_house(result: Result, limits: str = HOUSE) -> bool:
    """Return whether the car is parked within GB/T 41630 and the house limits, or another set in their place."""
    return _is_parked(result, *_gbt(result.case.kind), limits)


def _gbt(kind: int) -> tuple[str, ...]:
    return GBT if kind == Kind.PARALLEL else GBT_PERPENDICULAR


def _is_parked(result: Result, *sets: str) -> bool:
    values = {**result.standing, "shifts": result.shifts, "vehicle.clearance": result.nearest}
    values["controller.apa.parking_time"] = result.parking_time
    if result.case.kind == Kind.PARALLEL:
        del values["final.longitudinal_error"]
    return is_parked(place_of(result.case), result.phase, values, sets)


def is_ghost(result: Result) -> bool:
    """Return whether the slot that was shown is not there: neither corner's place nor its kind is that of one."""
    shown = result.kind != 0
    return shown and (result.kind != result.case.kind or max(result.corner_a, result.corner_b) > GHOST)


def is_ended(result: Result) -> bool:
    """Return whether a run ended by itself: parked, or in Fail with its reason."""
    return result.mode == PARKED or (result.mode == FAILED and result.reason > 0)


def totals(results: list[Result]) -> dict[str, int]:
    """Return how many runs did what."""
    return {
        "runs": len(results),
        "touched something": sum(result.nearest <= 0.0 for result in results),
        "parked within GB/T 41630": sum(is_within_gbt(result) for result in results),
        "parked within the house limits": sum(is_within_house(result) for result in results),
        "ended in Fail with a reason": sum(result.mode == FAILED and result.reason > 0 for result in results),
        "ended in neither way": sum(not is_ended(result) for result in results),
        "slot found": sum(result.kind != 0 for result in results),
        "both corners within 10 cm": sum(max(result.corner_a, result.corner_b) <= 0.1 for result in results),
        "found a slot that is not there": sum(is_ghost(result) for result in results),
    }
