"""What a run of the bake-off came to, from the few numbers kept of it."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from controller_fmu.interface import Phase, Reason
from orchestrator.bakeoff.entries import ASSIST, Entry
from orchestrator.cosim.endings import STANDSTILL_TIME_NS
from orchestrator.sweep.many import timed
from orchestrator.sweep.rows import PHASE, REASON
from orchestrator.verdict.measures import Measure
from orchestrator.verdict.numbers import CLEARANCE, NUMBERS, POSE

LATERAL, HEADING = 0.15, math.radians(3.0)
"""GB/T 41630, parallel parking [m, rad]."""
REFUSED = Reason.NO_PATH.name.lower()
"""Why a drive is not begun at all."""
HOUSE_LATERAL, HOUSE_HEADING = 0.05, math.radians(1.0)
PARKING_TIME = Measure("last", "controller.apa.parking_time")
SHIFTS, EFFORT = NUMBERS["shifts"].measure, NUMBERS["steering_effort"].measure
assert SHIFTS is not None
assert EFFORT is not None
MEASURES = (*POSE, PHASE, REASON, SHIFTS, EFFORT, CLEARANCE, PARKING_TIME)


class Result(NamedTuple):
    """One run: SI units and radians; errors in the slot's frame, whose x axis has the car flush with the neighbours."""

    entry: Entry
    parked: bool
    """The controller says parked, within GB/T 41630, without contact."""
    house: bool
    """Within 5 cm and 1 deg besides."""
    reason: str
    time: float
    """From the first instant (the assist: from the driver's confirmation) until the car stands parked."""
    shifts: int
    longitudinal: float
    """Not judged: the assist chooses its own place along the slot."""
    lateral: float
    heading: float
    clearance: float
    """Smallest of the whole run (the assist: with its way past the slot)."""
    effort: float
    """Way of the steering wheel [rad]."""


def results(runs: Sequence[Entry]) -> list[Result]:
    """Return what every run came to."""
    table = timed([entry.scenario for entry in runs], MEASURES)
    return [_result(entry, row) for entry, row in zip(runs, table, strict=True)]


def _result(entry: Entry, row: "np.ndarray[tuple[int], np.dtype[np.float64]]") -> Result:
    end, x, y, heading, phase, reason, shifts, effort, clearance, confirmed = (float(value) for value in row)
    told = int(phase) == Phase.PARKED
    time = confirmed if entry.controller == ASSIST else end - STANDSTILL_TIME_NS / 1e9
    within = abs(y) <= LATERAL and abs(heading) <= HEADING
    why = "" if told and within and clearance > 0.0 else _why(int(phase), int(reason), within, clearance)
    house = abs(y) <= HOUSE_LATERAL and abs(heading) <= HOUSE_HEADING
    parked = why == ""
    return Result(entry, parked, parked and house, why, time, int(shifts), x, y, heading, clearance, effort)


def _why(phase: int, reason: int, within: bool, clearance: float) -> str:
    if phase == Phase.FAILED:
        return Reason(reason).name.lower()
    if clearance <= 0.0:
        return "contact"
    return "stop time" if within or phase != Phase.PARKED else "beyond GB/T 41630"
