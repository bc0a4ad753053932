"""What a run of the bake-off came to, from the few numbers measures of it."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from orchestrator.bakeoff.entries import ASSIST, Entry
from orchestrator.scenario.requirements import Requirement, shipped_requirements
from orchestrator.sweep.many import run_all, truths_of
from orchestrator.sweep.rows import measures_for
from orchestrator.sweep.verdict import Verdict, judge_rows
from orchestrator.verdict.judge import meets
from orchestrator.verdict.measures import Measure

REFUSED = "no_path"
"""Why a drive is not begun at all."""
EXACT = ("final.lateral_error", "final.heading_error")
"""The numbers of an exact drive that are within the house limits."""
PARKING_TIME = Measure("last", "controller.apa.parking_time")


class Result(NamedTuple):
    """One run: SI units and radians; errors in the slot's frame, whose x axis has the car flush with the neighbours."""

    entry: Entry
    parked: bool
    """As everywhere; by the limits of GB/T 41630, without contact."""
    house: bool
    """Within the house limits across the slot and in heading besides."""
    reason: str
    time: float
    """From the first instant (the assist: from the driver's confirmation) until the car stands parked."""
    shifts: int
    longitudinal: float
    """Judged by the slot's ends only: the assist chooses its own place along the slot."""
    lateral: float
    heading: float
    clearance: float
    """Smallest of the whole run (the assist: with its way past the slot)."""
    effort: float
    """Way of the steering wheel [rad]."""


def results(runs: Sequence[Entry]) -> list[Result]:
    """Return what every run came to."""
    scenarios = [entry.scenario for entry in runs]
    measures = [*measures_for(scenarios[0]), PARKING_TIME]
    rows = run_all(scenarios, measures)
    verdict = judge_rows(scenarios[0], truths_of(scenarios), measures, rows)
    exact = np.all([meets(item, verdict.numbers[item.signal]) for item in exact_limits()], axis=0)
    return [_result(entry, verdict, run, float(rows[run, -1]), bool(exact[run])) for run, entry in enumerate(runs)]


def exact_limits() -> list[Requirement]:
    """Return the limits of an exact drive: lateral, heading."""
    house = {item.signal: item for item in shipped_requirements("house")}
    return [house[name] for name in EXACT]


def _result(entry: Entry, verdict: Verdict, run: int, confirmed: float, exact: bool) -> Result:
    number = {name: float(values[run]) for name, values in verdict.numbers.items()}
    standing = entry.scenario.ending.standstill
    parked = bool(verdict.succeeded()[run])
    return Result(
        entry,
        parked,
        parked and exact,
        "" if parked else verdict.reason[run],
        confirmed if entry.controller == ASSIST else number["duration"] - standing,
        int(number["shifts"]),
        number["final.longitudinal_error"],
        number["final.lateral_error"],
        number["final.heading_error"],
        number["min_clearance"],
        number["steering_effort"],
    )
