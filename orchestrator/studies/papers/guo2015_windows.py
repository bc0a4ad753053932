"""How far what is fitted may be changed until case 4 no longer fits: the pose at which point tracking starts.

The steering rate is chosen for this pose and the threshold is read off it, so that it fits shows little;
how narrow the window is shows more.
"""

from functools import lru_cache
from typing import NamedTuple

from orchestrator.evaluation.verdict.summary import Event, summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import can_compile, fmu_files
from orchestrator.studies.papers.result import Row

RUN = "guo2015-case4-105"
START = (-4.803, -2.441, 0.588)
"""Pose at which point tracking starts, as printed for 4.58 s."""
POSITION_TOLERANCE = 0.015
"""Largest difference of a position [m]."""
HEADING_TOLERANCE = 0.025
"""Largest difference of a heading [rad]."""
WIDE = (0.05, 0.03)
"""A wider window, to see what the limits above are worth [m], [rad]."""


class Fitted(NamedTuple):
    """What is fitted: its parameter, value, step of the search and the unit of these."""

    what: str
    name: str
    value: float
    step: float
    unit: str
    per_unit: float = 1.0
    """Of the parameter, in one of the unit shown."""


FITTED = (
    Fitted("steering rate", "car.steering.rate_limit", 105.0, 0.5, "deg/s", 19.0),
    Fitted("threshold to leave the path", "controller.guo2015.threshold.leave_lateral", 0.154, 0.001, "m"),
    Fitted("driver's speed", "vehicle.driver.profile[1].speed", 1.5, 0.005, "m/s"),
)
MAX_STEPS = 100
"""Steps to each side at most."""


def window_rows() -> list[Row]:
    """Return between which values of each fitted number the pose still fits, the others as they are."""
    rows = []
    for lateral, heading in ((POSITION_TOLERANCE, HEADING_TOLERANCE), WIDE):
        for fitted in FITTED:
            low, high = (_edge(fitted, sign, lateral, heading) for sign in (-1, 1))
            item = f"fits within {100.0 * lateral:g} cm and {heading:g} rad: {fitted.what}"
            rows.append(Row(RUN, item, "", None, f"{low:.4g} to {high:.4g} {fitted.unit}"))
    return rows


def _edge(fitted: Fitted, sign: int, lateral: float, heading: float) -> float:
    """Return the last value in this direction with which the pose fits."""
    last = fitted.value
    for k in range(1, MAX_STEPS):
        value = fitted.value + sign * k * fitted.step
        start = start_of_point_tracking(fitted, value)
        if start is None or not _fits(start, lateral, heading):
            break
        last = value
    return last


def _fits(start: Event, lateral: float, heading: float) -> bool:
    off = (abs(start.x - START[0]), abs(start.y - START[1]), abs(start.heading - START[2]))
    return off[0] <= lateral and off[1] <= lateral and off[2] <= heading


@lru_cache
def start_of_point_tracking(fitted: Fitted, value: float) -> Event | None:
    """Return where case 4 leaves the path with ``fitted`` at this value; None if it does not."""
    unit = "deg/s" if fitted.unit == "deg/s" else ""
    scenario = load_scenario(RUN, [f"{fitted.name}={value * fitted.per_unit}{unit}", "stop_time=6"])
    kind = "native" if can_compile() else "none"
    files = fmu_files(kind) if can_compile() else None
    events = summarize(run_scenario(scenario, files, kind=kind).recording, scenario, 0.0).events
    return next((event for event in events if event.from_ == "PATH_TRACKING"), None)
