"""The APA source: L_min against a search, the start range, smooth curvature, the parking assist's states and limits."""

import math
from pathlib import Path

import numpy as np
from scipy.interpolate import splev, splrep

from controller_fmu.apa.around.surroundings import shape_of
from controller_fmu.apa.chart import Mode
from controller_fmu.apa.outline import Shape, clearance
from controller_fmu.apa.params import ApaParams
from controller_fmu.apa.slot import Kind, Margins, Site, Slot, shortest_for_one_move, site_of
from controller_fmu.apa.ways.exit import exit_of
from controller_fmu.apa.ways.fit import least_moves
from controller_fmu.apa.ways.move import is_move_free, length_of, point_at
from controller_fmu.apa.ways.start_range import start_range
from controller_fmu.apa.ways.turns import reverse_s, turn_of
from controller_fmu.common.curve import advance
from controller_fmu.registry import ControllerParams
from modelkit.car import Car
from modelkit.variables import with_values
from modelkit.vocabulary import Pose
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.slot_sizes import library_slot_sizes, shortest_slot
from orchestrator.studies.papers.apa_figure import draw_apa
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
MAX_SOURCE_SPEED = 5.0 / 3.6
"""The source's system works below 5 km/h [m/s]."""
REACHED = {"apa-parallel": (0.015, 0.01), "apa-perpendicular": (0.006, 0.002), "apa-parallel-tight": (0.012, 0.003)}
"""A little over what is reached at the end: lateral error [m], heading error [rad]."""
UNTESTED = [
    not_tested("module 1: a slot shorter than L_min is refused", "it takes several moves; L_min is for one"),
    not_tested(
        "module 2: the driver is told to brake within the start range",
        "he is stopped as soon as a slot is found; from there the planner drives ahead or back as it needs",
    ),
    not_tested("module 3: B-spline of positions", "it goes beyond the arcs' curvature, see below"),
    not_tested(
        "perpendicular: B from the tangency of three circles",
        "one arc ahead and one in reverse with ramps instead",
    ),
    not_tested("four surround cameras, painted slots", "twelve ultrasonic sensors only"),
]
NOTES = [
    "L_min: the formula is printed, no number of it; the numbers are the formula's for two shipped cars beside a "
    "search. The speed is printed as a range of use (below 5 km/h); what is driven is a parameter (2.88 km/h). Both "
    "are own checks.",
    "L_min: printed without a derivation; it is the front outer corner on the arc of the full lock passing corner B.",
    "The source smooths the two arcs by a B-spline over the positions, whose curvature it cannot promise. Here the "
    "curvature itself is a B-spline of degree one over the way driven (lines, arcs, clothoids): limits hold exactly.",
    "The start range is in the frame of the target; its lower end has a closed form, its upper end is where the car "
    "would cut corner B.",
    "The source's perpendicular path is three arcs S-A-B-C; here S-A is driven forward and A-B-C in reverse, as line, "
    "arc, line with ramps, planned again from where the car stopped.",
]


def reproduce(out: Path, drive: Drive) -> Reproduction:
    """Return the source's formulas and numbers beside ours; writes apa.png to ``out``."""
    rows = UNTESTED + [row for name in CARS for row in _length_rows(name)] + _range_rows() + _curvature_rows()
    runs = [drive(name) for name in SCENARIOS]
    rows += [row for driven in runs for row in _run_rows(driven)]
    rows += _corner_rows(drive(CORNERS))
    modes = {int(mode) for driven in runs for mode in np.unique(driven.recording.signals["controller.apa.mode"])}
    missing = [mode.name for mode in Mode if int(mode) not in modes]
    reached = ", ".join(missing) or "all 8"
    rows.append(Row("", "states of the source that are reached", "", "all 8", reached, 0.0, basis=CONCLUSION))
    return Reproduction("apa", TITLE, rows, [draw_apa(runs[0], runs[1], out / "apa.png")], NOTES)


def car_named(name: str) -> Shape:
    """Return a shipped car, planned at 95 % of its lock."""
    return shape_of(with_values(ControllerParams, load_scenario("apa-parallel", [f"car={name}"]).controller))


def shortest_by_search(car: Shape, depth: float) -> float:
    """Return the shortest slot [m] left along one arc at full lock, by halving, to 0.1 mm."""
    low, high = car.front + car.rear, car.front + car.rear + 4.0
    while high - low > 1e-4:
        middle = 0.5 * (low + high)
        site = site_of(Slot(Kind.PARALLEL, 0, Pose(0.0, 0.0, 0.0), middle, 0.0, 50.0), car, Margins(0.0, 0.0, 0.0))
        start = Pose(0.5 * (car.front + car.rear - middle), 2.0 * car.half_width - depth, 0.0)
        poses = [advance(start, 1.0, 0.005 * n, car.curvature, car.curvature) for n in range(800)]
        free = all(clearance(pose, car, site.obstacles) >= -1e-9 for pose in poses)
        low, high = (low, middle) if free else (middle, high)
    return high


def _length_rows(name: str) -> list[Row]:
    car = car_named(name)
    width = 2.0 * car.half_width
    closed = shortest_for_one_move(car, 1.0 / car.curvature - car.half_width, width)
    by_search = shortest_by_search(car, width)
    sizes = library_slot_sizes("iso16787")
    iso = shortest_slot(Kind.PARALLEL, Car(wheelbase=car.front, front_overhang=0.0, rear_overhang=car.rear), sizes)
    slot = Slot(Kind.PARALLEL, 0, Pose(0.0, 0.0, 0.0), iso, 0.0, width + 0.4)
    return [
        Row("", f"{name}: L_min, formula and search", "m", closed, by_search, 0.002, basis=OWN),
        Row("", f"{name}: shortest slot of ISO 16787", "m", None, iso),
        Row("", f"{name}: moves into that slot", "1", None, float(least_moves(slot, car, ApaParams()))),
    ]


def _range_rows() -> list[Row]:
    car = car_named("zhang2022")
    site = site_of(Slot(Kind.PARALLEL, 0, Pose(0.0, 0.0, 0.0), 7.4, 0.0, 2.4), car, Margins(0.15, 0.1, 0.0))
    way_in = exit_of(2, site, car)
    found = start_range(3.0, 0.0, way_in, site, car)
    tried = [x for x in np.arange(4.0, 11.0, 0.005) if _leads_in(float(x), way_in.pose, site, car)]
    return [
        Row("", "start range: Px_min, formula and search by the same move", "m", None, found.low - float(min(tried))),
        Row("", "start range: Px_max, halving and search by the same move", "m", None, found.high - float(max(tried))),
    ]


def _leads_in(x: float, end: Pose, site: Site, car: Shape) -> bool:
    turn = turn_of(car.curvature, car.curvature, car.ramp)
    move = reverse_s(Pose(x, 3.0, 0.0), end, 0.0, turn, turn)
    return move.direction != 0 and is_move_free(move, car, site.obstacles)


def _curvature_rows() -> list[Row]:
    """Return how far a B-spline over the positions of two arcs goes beyond their curvature, and ours."""
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
    car = Shape(3.586, 0.85, 0.91, k, 0.8)
    move = reverse_s(Pose(8.5, 3.0, 0.0), Pose(0.0, 0.0, 0.0), 0.0, *(turn_of(k, k, car.ramp),) * 2)
    ours = max(abs(point_at(move, 0.01 * n).curvature) for n in range(int(length_of(move) / 0.01))) / k - 1.0
    return [
        Row("", "curvature over the arcs', B-spline of positions, 16 control points", "1", None, over),
        Row("", "curvature over the arcs', ours: none by construction", "1", None, ours),
    ]


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
        yes_row(name, "Table 1: parked between corners A and B as told", parked, CONCLUSION),
    ]


def _run_rows(driven: Driven) -> list[Row]:
    name, signals, summary = driven.summary.scenario, driven.recording.signals, driven.summary
    parking = np.isin(signals["controller.apa.mode"], [Mode.AUTO_PARKING_ASSIST, Mode.POSITION_TUNING])
    fastest = float(np.max(np.abs(signals["vehicle.speed"][parking])))
    rows = [
        Row(name, "outcome", "", driven.scenario.expected_outcome, summary.outcome, 0.0, basis=CONCLUSION),
        bound_row(name, "speed while parking", "km/h", 3.6 * MAX_SOURCE_SPEED, 3.6 * fastest)._replace(basis=OWN),
    ]
    if summary.outcome != "parked":
        return rows
    lateral, heading = REACHED[name]
    return [
        *rows,
        Row(name, "lateral error at the end", "m", None, summary.final.lateral_error, lateral, basis=OWN),
        Row(name, "heading error at the end", "rad", None, summary.final.heading_error, heading, basis=OWN),
        Row(name, "manoeuvres", "1", None, float(summary.manoeuvres or 0)),
        Row(name, "time to park", "s", None, float(signals["controller.apa.parking_time"][-1])),
    ]
