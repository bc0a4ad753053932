"""The APA source: L_min against a search, smooth curvature, corners as inputs, outcomes and limits of the system."""

import math

import numpy as np
from scipy.interpolate import splev, splrep

from controller_fmu.parking.chart import ParkingState
from controller_fmu.parking.geometry.outline import pose_along_arc
from modelkit.car import Car, largest_curvature
from modelkit.geometry import Box, boxes_gap, outline
from modelkit.variables import with_values
from modelkit.vocabulary import Pose
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.slot_sizes import ParkingType, library_slot_sizes, shortest_slot
from orchestrator.studies.papers.result import (
    CONCLUSION,
    OWN,
    PRINTED,
    Drive,
    Driven,
    Reproduction,
    Row,
    bound_row,
    not_tested,
    yes_row,
)

TITLE = "APA: from looking for a slot to parked (ADAS algorithm design 8)"
SCENARIOS = ("apa-parallel", "apa-perpendicular", "apa-parallel-tight", "apa-takeover")
CORNERS = "apa-external-slot"
"""Parks in a slot whose corners are inputs, where the sensors by themselves find none."""
CARS = ("guo2015", "zhang2022")
"""Shipped cars; those of CommonRoad turn their front wheels by 52 deg and more."""
DRIVING_STATES = tuple(
    int(state)
    for state in (ParkingState.STEERING, ParkingState.DRIVING, ParkingState.STOPPING, ParkingState.STRAIGHTENING)
)
LOCK_FRACTION = 0.95
"""Planned over largest curvature."""
MAX_SOURCE_SPEED = 5.0 / 3.6
"""The source's system works below 5 km/h [m/s]."""
UNTESTED = [
    not_tested("module 1: a slot shorter than L_min is refused", "it takes several moves; L_min is for one"),
    not_tested(
        "module 2: the driver is prompted to brake within the start range",
        "he is stopped as soon as a slot is found; from there the planner drives ahead or back as it needs",
    ),
    not_tested("module 3: B-spline of positions", "it goes beyond the arcs' curvature, see below"),
    not_tested("perpendicular: B from the tangency of three circles", "a search among polygons instead"),
    not_tested("states: the source's eight", "this system has states of its own: search, confirm, plan, drive, stop"),
    not_tested("four surround cameras, painted slots", "twelve ultrasonic sensors only"),
]
NOTES = [
    "L_min: the formula is printed, no number of it; the numbers are the formula's for two shipped cars beside a "
    "search. The speed is printed as a range of use (below 5 km/h); what is driven is a parameter (2.88 km/h). Both "
    "are own checks.",
    "L_min: printed without a derivation; it is the front outer corner on the arc of the full lock passing corner B.",
    "The source smooths the two arcs by a B-spline over the positions, whose curvature it cannot promise.",
]


def reproduce(drive: Drive) -> Reproduction:
    """Return the source's formulas and numbers beside ours."""
    rows = UNTESTED + [row for name in CARS for row in _length_rows(name)] + _curvature_rows()
    runs = [drive(name) for name in SCENARIOS]
    rows += [row for driven in runs for row in _run_rows(driven)]
    rows += _corner_rows(drive(CORNERS))
    return Reproduction("apa", TITLE, rows, NOTES)


def car_named(name: str) -> Car:
    """Return a shipped car."""
    controller = load_scenario("apa-parallel", [f"car={name}"]).controller
    own = {key.removeprefix("car."): value for key, value in controller.items() if key.startswith("car.")}
    car: Car = with_values(Car, own)
    return car


def shortest_for_one_move(car: Car) -> float:
    """Return L_min [m] = r + sqrt(2 (R_min + d) B_y + l^2 - B_y^2) of the source for a slot as deep as the car is wide.

    r rear overhang, R_min the inner rear wheel's turning radius, d the width, l nose to rear axle, B_y how deep the
    car stands behind corner B.
    """
    front, width = car.wheelbase + car.front_overhang, car.width
    inner = 1.0 / (LOCK_FRACTION * largest_curvature(car)) - 0.5 * width
    return car.rear_overhang + math.sqrt(2.0 * (inner + width) * width + front * front - width * width)


def shortest_by_search(car: Car) -> float:
    """Return the shortest slot [m] that is left along one arc at that curvature, by halving, to 0.1 mm."""
    front, rear = car.wheelbase + car.front_overhang, car.rear_overhang
    curvature = LOCK_FRACTION * largest_curvature(car)
    low, high = front + rear, front + rear + 4.0
    while high - low > 1e-4:
        middle = 0.5 * (low + high)
        ahead = Box(middle - rear + 4.0, -car.width, 0.0, 8.0, 2.0 * car.width)
        poses = (pose_along_arc(Pose(0.0, -0.5 * car.width, 0.0), 0.005 * n, curvature) for n in range(800))
        bodies = (outline(pose, car.wheelbase, car.front_overhang, rear, car.width) for pose in poses)
        low, high = (low, middle) if all(boxes_gap(body, ahead) > 0.0 for body in bodies) else (middle, high)
    return high


def _length_rows(name: str) -> list[Row]:
    car = car_named(name)
    closed, by_search = shortest_for_one_move(car), shortest_by_search(car)
    iso = shortest_slot(ParkingType.PARALLEL, car, library_slot_sizes("iso16787"))
    return [
        Row("", f"{name}: L_min, formula and search", "m", closed, by_search, 0.002, basis=OWN),
        Row("", f"{name}: shortest slot of ISO 16787", "m", None, iso),
    ]


def _curvature_rows() -> list[Row]:
    """Return how far a B-spline over the positions of two arcs goes beyond their curvature."""
    k, angle = 0.2, math.radians(45.0)
    half = math.sin(angle) / k
    x = np.concatenate([np.linspace(0.0, half, 60)[:-1], np.linspace(half, 2.0 * half, 60)])
    y = np.where(
        x <= half,
        (1.0 - np.sqrt(1.0 - np.minimum(k * x, 0.99) ** 2)) / k,
        (1.0 - 2.0 * math.cos(angle) + np.sqrt(np.maximum(1.0 - (2.0 * math.sin(angle) - k * x) ** 2, 0.0))) / k,
    )
    knots = np.linspace(0.0, float(x[-1]), 14)[1:-1]
    spline = splrep(x, y, t=knots)
    fine = np.linspace(0.0, float(x[-1]), 2000)
    slope, bend = splev(fine, spline, 1), splev(fine, spline, 2)
    over = float(np.max(np.abs(bend / (1.0 + slope**2) ** 1.5)) / k - 1.0)
    return [Row("", "curvature over the arcs', B-spline of positions, 16 control points", "1", None, over)]


def _corner_rows(driven: Driven) -> list[Row]:
    """Return whether the slot is where Table 1's inputs (corners A and B, heading) say, and the car parks in it."""
    name, signals = driven.summary.scenario, driven.recording.signals
    inputs = sum(f"controller.external_slot.{key}" in signals for key in ("ax", "ay", "bx", "by", "heading"))
    corners = [float(signals[f"controller.external_slot.{key}"][-1]) for key in ("ax", "bx")]
    x = float(signals["vehicle.pose.x"][-1])
    inside = min(corners) < x < max(corners)
    parked = driven.summary.outcome == "parked" and inside
    return [
        Row(name, "Table 1: corners A and B (x, y) and heading as inputs", "1", 5.0, float(inputs), 0.0, basis=PRINTED),
        yes_row(name, "Table 1: parked between the given corners A and B", parked, CONCLUSION),
    ]


def _run_rows(driven: Driven) -> list[Row]:
    name, signals, summary = driven.summary.scenario, driven.recording.signals, driven.summary
    parking = np.isin(signals["controller.apa.state"], DRIVING_STATES)
    fastest = float(np.max(np.abs(signals["vehicle.speed"][parking])))
    rows = [
        Row(name, "outcome", "", driven.scenario.expected_outcome, summary.outcome, 0.0, basis=CONCLUSION),
        bound_row(name, "speed while parking", "km/h", 3.6 * MAX_SOURCE_SPEED, 3.6 * fastest)._replace(basis=OWN),
    ]
    if summary.outcome != "parked":
        return rows
    return [
        *rows,
        Row(name, "lateral error at the end", "m", None, summary.final.lateral_error),
        Row(name, "heading error at the end", "rad", None, summary.final.heading_error),
        Row(name, "manoeuvres", "1", None, float(summary.manoeuvres or 0)),
        Row(name, "time to park", "s", None, float(signals["controller.apa.parking_time"][-1])),
    ]
