"""What every drive of the bake-off came to, read off the study's table."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from orchestrator.inputs.scenario.requirements import Requirement, library_requirements
from orchestrator.studies.bakeoff.entries import LABELS
from orchestrator.studies.sweep.columns import WITHIN

REFUSED = "no_path"
"""Why a drive is not begun at all."""
EXACT = "5 cm and 1 deg"
RESULTS = (
    *("outcome", WITHIN.format(EXACT), "reason", "time", "manoeuvres"),
    *("final.lateral_error", "final.heading_error", "min_clearance", "steering_travel"),
)
"""Columns of the table that a drive is made from, beside its labels."""


class Drive(NamedTuple):
    """One drive: SI units and radians; errors from the pose flush with the neighbours."""

    controller: str
    slot: float
    """Its length."""
    car: str
    body: str
    start: str
    disturbance: str
    parked: bool
    """As everywhere; by the limits of GB/T 41630, without contact."""
    exact: bool
    """Within 5 cm and 1 deg besides."""
    why: str
    """Why it is not parked; empty if it is."""
    time: float
    """From the first instant until the car stands parked."""
    manoeuvres: int
    lateral: float
    heading: float
    clearance: float
    """Smallest of the whole run."""
    effort: float
    """What the steering wheel turned in all [rad]."""


def exact_limits() -> tuple[Requirement, ...]:
    """Return the limits of an exact drive: lateral, heading."""
    return library_requirements("project", "final lateral position", "final heading")


def drives(columns: Mapping[str, Any]) -> list[Drive]:
    """Return the drives of a table, by the names of its columns."""
    rows = zip(*(columns[name].tolist() for name in (*LABELS, *RESULTS)), strict=True)
    return [_drive(row[: len(LABELS)], *row[len(LABELS) :]) for row in rows]


def _drive(who: tuple[Any, ...], outcome: str, is_exact: bool, reason: str, *numbers: Any) -> Drive:
    parked = outcome == "parked"
    return Drive._make([*who, parked, parked and is_exact, "" if parked else reason, *numbers])
