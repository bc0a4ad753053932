"""What every run of the grid came to: the slot it found, how it stands, by which limits."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from modelkit.vocabulary import Pose
from orchestrator.evaluation.verdict.frame import in_frame
from orchestrator.evaluation.verdict.measures import Measure
from orchestrator.evaluation.verdict.numbers import Metric
from orchestrator.evaluation.verdict.outcome import BEYOND
from orchestrator.inputs.scenario.slot_sizes import ParkingType
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.parking.cases import GridCase, cases
from orchestrator.studies.parking.system_signals import PARKING_TIME, display_measures
from orchestrator.studies.sweep.columns import WITHIN
from orchestrator.studies.sweep.study.study import Columns, DerivedParameter

PARKED, FAILED = "parked", "failed"
FALSE_DETECTION_DISTANCE = 0.5
"""A slot found further off than this [m], or of the wrong kind, is one that is not there."""
POSE, ODOMETRY = "shown.pose", "shown.odometry"
CORNERS = ("shown.a", "shown.b")
POSES = {
    **{f"{POSE}.{axis}": f"vehicle.pose.{axis}" for axis in ("x", "y", "heading")},
    **{f"{ODOMETRY}.{axis}": f"vehicle.odometry.{axis}" for axis in ("x", "y", "heading")},
}
SHOWN_COLUMNS = (*POSES, *(f"{corner}.{axis}" for corner in CORNERS for axis in ("x", "y")), "shown.kind")
"""Of the first instant at which the car stands to plan, and the slot it found is shown."""


MEASURES = {"parking_time": Measure("last", PARKING_TIME), **display_measures(POSES)}
"""What is kept of each run: how long it took, and the slot shown."""


GBT: dict[int, str] = {
    ParkingType.PARALLEL: "GB/T 41630, parallel",
    ParkingType.PERPENDICULAR: "GB/T 41630, perpendicular",
}
PROJECT_LIMITS, PROJECT_LIMITS_BUT_MANOEUVRES = "project", "project, but for the manoeuvres"


class GridRun(NamedTuple):
    """One run of the grid."""

    case: GridCase
    outcome: str
    reason: str
    lateral: float
    """Final errors against the true slot [m, rad]."""
    heading: float
    manoeuvres: int
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
    is_gbt: bool
    """Parked within GB/T 41630: heading, lateral position, manoeuvres, no contact."""
    is_within_limits: bool
    """Parked within the project limits."""
    is_within_limits_but_manoeuvres: bool
    """The same with the manoeuvres of GB/T 41630."""

    @property
    def is_ghost(self) -> bool:
        """Whether the slot that was shown is not there: neither corner's place nor its kind is that of one."""
        shown = self.kind != 0
        return shown and (self.kind != self.case.kind or max(self.corner_a, self.corner_b) > FALSE_DETECTION_DISTANCE)

    @property
    def is_ended(self) -> bool:
        """Whether the run ended by itself: parked, or in Fail with its reason."""
        return self.outcome == PARKED or BEYOND in self.reason or self.is_given_up

    @property
    def is_given_up(self) -> bool:
        """Whether the system gave up, and said why."""
        return self.outcome == FAILED and self.reason != "none"


def parkings(columns: Mapping[str, Any]) -> list[GridRun]:
    """Return the runs of a table, by the names of its columns."""
    return [_parking(dict(zip(columns, row, strict=True))) for row in zip(*columns.values(), strict=True)]


def _parking(row: Mapping[str, Any]) -> GridRun:
    case = cases(int(row["lot"]))[int(row["number"])]
    parked = row["outcome"] == "parked"
    gbt = parked and row[WITHIN.format(GBT[case.kind])]
    return GridRun(
        case,
        row["outcome"],
        row["reason"],
        row["final.lateral_error"],
        row["final.heading_error"],
        int(row["manoeuvres"]),
        row["parking_time"],
        row["min_clearance"],
        row["corner_a"],
        row["corner_b"],
        row["along"],
        0 if math.isnan(row["shown.kind"]) else int(row["shown.kind"]),
        bool(gbt),
        bool(gbt and row[WITHIN.format(PROJECT_LIMITS)]),
        bool(gbt and row[WITHIN.format(PROJECT_LIMITS_BUT_MANOEUVRES)]),
    )


def _detection_columns(columns: Columns) -> Mapping[str, Array]:
    """Return how well the slot was found, of each run."""
    names = ("lot", "number", *SHOWN_COLUMNS)
    rows = zip(*(columns[name].tolist() for name in names), strict=True)
    found = [_how_found(dict(zip(names, row, strict=True))) for row in rows]
    return dict(zip(FOUND.columns, np.array(found).T, strict=True))


def _how_found(row: Mapping[str, float]) -> tuple[float, float, float]:
    case = cases(int(row["lot"]))[int(row["number"])]
    if math.isnan(row["shown.kind"]):
        return math.nan, math.nan, math.nan
    pose = pose_of(row, POSE)
    return *corner_errors(case, row), pose.x - case.length


def corner_errors(case: GridCase, row: Mapping[str, float]) -> tuple[float, float]:
    """Return the distances [m] of A and B as believed from the true corners, seen from the car.

    What the odometry has drifted before it saw the corner does not matter, what it drifts after does.
    """
    true, believed = pose_of(row, POSE), pose_of(row, ODOMETRY)
    found = ((row[f"{name}.x"], row[f"{name}.y"]) for name in CORNERS)
    pairs = zip(found, ((0.0, 0.0), (case.length, 0.0)), strict=True)
    a, b = (math.dist(_in_frame(believed, one), _in_frame(true, other)) for one, other in pairs)
    return a, b


def pose_of(row: Mapping[str, float], name: str) -> Pose:
    """Return a pose that was kept of a run under this name."""
    return Pose(row[f"{name}.x"], row[f"{name}.y"], row[f"{name}.heading"])


def _in_frame(pose: Pose, point: tuple[float, float]) -> tuple[float, float]:
    return in_frame(*point, 0.0, pose)[:2]


FOUND = DerivedParameter(
    {
        "corner_a": Metric(
            "m", "distance of the estimated corner A from the true one, in the vehicle frame; NaN: no slot detected"
        ),
        "corner_b": Metric("m", "the same of corner B"),
        "along": Metric("m", "x of the rear axle beyond corner B when the car stood to plan"),
    },
    _detection_columns,
)
