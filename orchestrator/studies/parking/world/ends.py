"""What became of a run in the world: a contact is its end, whatever the controller says after it."""

import math
from collections.abc import Mapping
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from controller_fmu.parking.chart import ParkingState
from modelkit.geometry import Box, boxes_gap, line_box, outline
from modelkit.vocabulary import Pose
from orchestrator.evaluation.verdict.measures import Instants, Measure
from orchestrator.evaluation.verdict.numbers import Metric
from orchestrator.evaluation.verdict.outcome import BEYOND
from orchestrator.evaluation.verdict.standing import outline_margin
from orchestrator.evaluation.verdict.truth import CAR_KEYS
from orchestrator.inputs.scenario.requirements import Requirement, library_requirements
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.parking.parkings import GBT
from orchestrator.studies.parking.study import GBT_SETS
from orchestrator.studies.parking.system_signals import PARKING_TIME
from orchestrator.studies.parking.world.factors import NOBODY
from orchestrator.studies.parking.world.feasibility import COLUMNS, DETECTED_HEIGHT, feasibility_columns
from orchestrator.studies.parking.world.scene import THINGS, WHEEL
from orchestrator.studies.sweep.columns import WITHIN
from orchestrator.studies.sweep.study.study import Columns, DerivedParameter, Objective
from vehicle_fmu.scene import Obstacle, SceneParams, is_there, obstacle_box

TOUCHING = Instants("vehicle.contact", (1,))
AXES = ("x", "y", "heading")
FIRST = {
    **{f"touched.{axis}": f"vehicle.pose.{axis}" for axis in AXES},
    "touched.speed": "vehicle.speed",
    "touched.state": "controller.apa.state",
    "touched.takeover": "vehicle.driver_takeover",
}
"""Column -> signal at the first instant at which something is touched."""
BY_DRIVER = (ParkingState.STANDBY, ParkingState.SEARCHING, ParkingState.CONFIRMING, ParkingState.TAKEOVER)
DRIVES = tuple(state for state in ParkingState if state not in BY_DRIVER)
"""In these the system drives or holds the car, unless the driver has taken over."""
CLAIMED = ("final heading", "final lateral position", "outline in the slot")
NO_CONTACT = (Requirement(id="contact", signal="vehicle.clearance", min=1e-9, source="nothing is touched"),)
MEASURES = {
    "state": Measure("last", "controller.apa.state"),
    "parking_time": Measure("last", PARKING_TIME),
    **{name: Measure("first", signal, TOUCHING) for name, signal in FIRST.items()},
    "assist.clearance": Measure(
        "smallest", "vehicle.clearance", Instants("controller.apa.state", tuple(map(int, DRIVES)))
    ),
    "touched.time": Measure("time", "vehicle.speed", TOUCHING),
}
CONTACT, DRIVER, WALKED_INTO, LOW_KERB = "contact", "contact, driver drives", "walked into", "wheel at a low kerb"
PARKED, FALSE, FAILED, ENDLESS = "parked", "false parked", "gave up", "endless"
ENDS = {
    CONTACT: "contact while the system drives or holds the vehicle",
    FALSE: "claims to be parked outside the slot or beyond GB/T 41630",
    ENDLESS: "neither parked nor given up at the stop time",
    PARKED: "parked within GB/T 41630, no contact",
    FAILED: "gave up, no contact",
    DRIVER: "contact while the driver drives",
    WALKED_INTO: "a pedestrian, or a neighbour, moved into the car: it would have touched it standing, too",
    LOW_KERB: "a tyre against a kerb that is too low to be detected; nothing of the body touches it",
}
"""How a run in the world ends, the worst first."""


def _ends(columns: Columns) -> Mapping[str, Array]:
    """Return the end of each run, what was touched first, and whether the run asks for what can be had."""
    rows = [
        dict(zip(columns, row, strict=True)) for row in zip(*(_plain(item) for item in columns.values()), strict=True)
    ]
    touched = [None if math.isnan(row["touched.x"]) else first_contact(row) for row in rows]
    found = [end_of(row, first) for row, first in zip(rows, touched, strict=True)]
    into = [end == CONTACT and is_driven_into(row, first) for row, end, first in zip(rows, found, touched, strict=True)]
    return {
        **feasibility_columns(columns),
        "driven_into": np.array(into, dtype=float),
        "end": np.array(found, dtype=object),
        "touched": np.array(["" if first is None else first.name for first in touched], dtype=object),
    }


def _plain(values: Any) -> list[Any]:
    return list(np.asarray(values).tolist())


class InitialContact(NamedTuple):
    """What a car has touched first."""

    name: str
    came: bool
    """It would have touched the car one exchange before, too: it came, the car did not bring it about."""


def end_of(row: Mapping[str, Any], touched: InitialContact | None) -> str:
    """Return how a run ended, one of ``ENDS``."""
    if touched is not None:
        driven = row["touched.state"] in DRIVES and not row["touched.takeover"]
        low = touched.name == KERB and row["vehicle.scene.kerbs[1].height"] < DETECTED_HEIGHT
        return WALKED_INTO if touched.came else LOW_KERB if low else CONTACT if driven else DRIVER
    if row["outcome"] == "parked" or row["reason"].startswith(BEYOND):
        return PARKED if row[WITHIN.format(GBT[int(row["kind"]) + 1])] or _stands_among_the_moved(row) else FALSE
    return FAILED if row["outcome"] == "failed" else ENDLESS


def _stands_among_the_moved(row: Mapping[str, Any]) -> bool:
    """Return whether a car is within GB/T 41630 among neighbours of whom one has moved away, as they stand at the end.

    One that leaves a parallel row makes its slot longer by its distance; one that stands out of a perpendicular row
    moves its line by half of that.
    """
    if row.get("mover", 0) < NOBODY:
        return False
    travel = math.copysign(min(abs(row["mover_travel"]), _neighbour_travel(row)), row["mover_travel"])
    margin = row["final.outline_margin"] + max(0.0, -travel) if row["kind"] == 0 else _margin(row, 0.5 * travel)
    turned, aside, out, manoeuvres = claim_limits(int(row["kind"]) + 1)
    heading, lateral = abs(row["final.heading_error"]), abs(row["final.lateral_error"])
    near = heading <= turned and lateral <= aside and margin >= -out
    return bool(near and row["manoeuvres"] <= manoeuvres)


def _margin(row: Mapping[str, Any], out: float) -> float:
    """Return how far [m] a car is within its slot at the end, if that lies so much further ``out``; negative: not."""
    c, s = math.cos(row["slot.heading"]), math.sin(row["slot.heading"])
    slot = [row["slot.x"] + out * c, row["slot.y"] + out * s, *(row[f"slot.{name}"] for name in SLOT)]
    wheelbase, front, rear, width = (row[key] for key in CAR_KEYS)
    car = [wheelbase + front, rear, 0.5 * width, wheelbase]
    pose = [row[f"final.{axis}"] for axis in AXES]
    return float(outline_margin(*(np.array([item]) for item in (pose, slot, car)))[0])


@cache
def claim_limits(kind: int) -> tuple[float, ...]:
    """Return how far GB/T 41630 lets a car of this kind of slot be turned, aside, out of it, and its manoeuvres."""
    return tuple(abs(float(item.limit)) for item in library_requirements(GBT_SETS[kind], *CLAIMED, "manoeuvres"))


def _neighbour_travel(row: Mapping[str, Any]) -> float:
    """Return how far [m] a moving neighbour could have come by the end of the run."""
    return float(max(0.0, row["duration"] - row["mover_at"]) * row["mover_speed"])


def first_contact(row: Mapping[str, Any]) -> InitialContact:
    """Return what the car is nearest to when it touches something for the first time."""
    pose = Pose(*(row[f"touched.{axis}"] for axis in AXES))
    obstacles = _obstacles(row)
    name = min(obstacles, key=lambda name: _gap(row, pose, *obstacles[name]))
    travel = row["touched.speed"] * row["step"]
    before = Pose(pose.x - travel * math.cos(pose.heading), pose.y - travel * math.sin(pose.heading), pose.heading)
    return InitialContact(
        name, name in MOVABLE_OBSTACLES and _is_moving(row, name) and _gap(row, before, *obstacles[name]) <= 0.0
    )


def is_driven_into(row: Mapping[str, Any], touched: InitialContact | None) -> bool:
    """Return whether a moving obstacle has touched a car at standstill: it could have done no more."""
    if touched is None or touched.name not in MOVABLE_OBSTACLES:
        return False
    return abs(row["touched.speed"]) <= STANDSTILL_SPEED and _is_moving(row, touched.name)


STANDSTILL_SPEED = 0.01
"""A car no faster [m/s] stands: so the assist sees it."""
MOVABLE_OBSTACLES = THINGS[:2] + THINGS[3:4]
KERB = THINGS[-1]
GROUND_CLEARANCE = SceneParams().ground_clearance
"""Kerbs lower than this [m] pass under the bumpers."""


def _obstacles(row: Mapping[str, Any]) -> dict[str, tuple[Box, bool]]:
    """Return what stands there as the car touches something, and whether it is under the bumpers."""
    boxes = [Obstacle(**{name: row.get(f"{_box(n)}.{name}", start) for name, start in EMPTY.items()}) for n in BOXES]
    time_ns = round(row["touched.time"] * 1e9)
    names = (*THINGS[:-1], *(f"car {n}" for n in BOXES[len(THINGS) - 1 :]))
    there = {
        name: (obstacle_box(box, time_ns), False)
        for name, box in zip(names, boxes, strict=True)
        if is_there(box, time_ns)
    }
    height = row["vehicle.scene.kerbs[1].height"]
    if height > 0.0:
        ends = (row[f"vehicle.scene.kerbs[1].{end}"] for end in ("x1", "y1", "x2", "y2"))
        there[KERB] = (line_box(*ends), height < GROUND_CLEARANCE)
    return there


BOXES = range(1, len(SceneParams().boxes) + 1)
EMPTY = Obstacle()._asdict()
SLOT = ("heading", "length", "width")


def _box(number: int) -> str:
    return f"vehicle.scene.boxes[{number}]"


def _is_moving(row: Mapping[str, Any], name: str) -> bool:
    box = _box(THINGS.index(name) + 1)
    moves = row[f"{box}.moves_at"] <= row["touched.time"] <= row.get(f"{box}.halts_at", math.inf) + row["step"]
    return bool(moves and (row.get(f"{box}.speed_x", 0.0) or row[f"{box}.speed_y"]))


def _gap(row: Mapping[str, Any], pose: Pose, obstacle: Box, under: bool) -> float:
    wheelbase, front, rear, width = (row[key] for key in CAR_KEYS)
    front, rear = (WHEEL, WHEEL) if under else (front, rear)
    return boxes_gap(outline(pose, wheelbase, front, rear, width), obstacle)


def _clear(columns: Columns) -> Array:
    """Return how near [m] the car has come to anything since the system has it; 0 or less: touched, or not measured."""
    nearest = np.nan_to_num(np.asarray(columns["assist.clearance"]), nan=LARGEST)  # the system has never had the car
    unknown = np.isnan(np.asarray(columns["state"])) | np.isnan(np.asarray(columns["min_clearance"]))
    ends = np.asarray(columns["end"])
    touched, nearest = ends == CONTACT, np.where(ends == LOW_KERB, LARGEST, nearest)
    margins = np.where(touched, -np.abs(columns["touched.speed"]), np.clip(nearest, LEAST, LARGEST))
    return np.asarray(np.where(unknown, -LARGEST, margins))


def _honest(columns: Columns) -> Array:
    """Return by how much a run that claims to be parked is within GB/T 41630, as a share of its limits."""
    heading, lateral = np.abs(columns["final.heading_error"]), np.abs(columns["final.lateral_error"])
    turned, aside, out = (abs(float(item.limit)) for item in library_requirements("gbt41630", *CLAIMED))
    shares = [1.0 - heading / turned, 1.0 - lateral / aside, 1.0 + columns["final.outline_margin"] / out]
    least = np.minimum(np.min(shares, axis=0), 1.0)
    ends = np.asarray(columns["end"])
    found = np.where(ends == FALSE, np.minimum(least, -LEAST), np.where(ends == PARKED, np.maximum(least, LEAST), 1.0))
    return np.asarray(np.where(np.isnan(np.asarray(columns["state"])), -1.0, found))


LEAST, LARGEST = 1e-4, 0.5
"""Margins of runs that have not touched anything [m]."""
GOALS = (
    Objective("contact", "nothing is touched while the system has the car", NO_CONTACT, _clear),
    Objective("claim", "who claims to be parked stands in the slot, within GB/T 41630", (), _honest),
)
INTO = {"driven_into": Metric("1", "1: contact at standstill caused by a moving obstacle")}
FOUND = DerivedParameter(
    {**COLUMNS, **INTO}, _ends, {"end": "how the run ended in the world", "touched": "what was touched first"}
)
