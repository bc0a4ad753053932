"""The HSIC paper: parked within its limits, small deviation from the common tangent, all 12 characteristic states."""

import math
from pathlib import Path

import numpy as np

from controller_fmu.hsic.characteristic_states import Characteristic, Stage
from orchestrator.papers.motion_figure import draw_hsic
from orchestrator.papers.result import Drive, Driven, Reproduction, Row

TITLE = "Human-simulated intelligent control of parallel parking"
SCENARIOS = ("hsic", "hsic-straight", "hsic-driven-past", "hsic-shuffle")
HEADING, LATERAL = 5.0, 0.1
"""The paper's limits of a parked car [deg, m]."""
TANGENT = 0.03
"""Deviation from the common tangent called small here [m]: the paper prints a curve, no number."""
NOTES = [
    "The formulas of the key points and of the characteristic states are pictures in the source and lost; they "
    "are derived from the geometry and the captions of its Fig. 10. The car is that of Zhang 2022, the slot is chosen.",
    "The deviation from the common tangent is taken between P2 and P3. hsic-shuffle drives a car whose steering is "
    "18 % slower than the controller thinks, so its tangent deviation is reported, not judged.",
    "The car turns its wheel at standstill at each turning point, as a careful driver does: that costs the time.",
]


def reproduce(out: Path, drive: Drive) -> Reproduction:
    """Return printed and measured numbers; writes hsic.png to ``out``."""
    runs = [drive(name) for name in SCENARIOS]
    rows = [row for driven in runs for row in _rows(driven)]
    reached: dict[int, str] = {}
    for driven in runs:
        for state in np.unique(driven.recording.signals["controller.hsic.characteristic"]):
            reached.setdefault(int(state), driven.summary.scenario)
    for state in Characteristic:
        if state != Characteristic.NONE:
            found = reached.get(int(state), "never")
            rows.append(Row("", f"state {int(state)} {state.name} first reached in", "", None, found))
    missing = [state.name for state in Characteristic if int(state) not in reached]
    rows.append(Row("", "all 12 states reached", "", "yes", ", ".join(missing) or "yes", 0.0))
    return Reproduction("hsic", TITLE, rows, [draw_hsic(runs[0], runs[-1], out / "hsic.png")], NOTES)


def _rows(driven: Driven) -> list[Row]:
    name, signals, final = driven.summary.scenario, driven.recording.signals, driven.summary.final
    tangent = signals["controller.hsic.tangent_error"][signals["controller.hsic.stage"] == Stage.TANGENT]
    judged = None if name == "hsic-shuffle" else TANGENT
    return [
        Row(name, "outcome, wherever along the slot", "", "parked", driven.in_line(), 0.0),
        Row(name, "outcome by our limits, along the slot too", "", None, driven.summary.outcome),
        Row(name, "heading at the end", "deg", 0.0, math.degrees(final.heading_error), HEADING),
        Row(name, "lateral error at the end", "m", 0.0, final.lateral_error, LATERAL),
        Row(name, "largest deviation from the common tangent", "m", 0.0, float(np.abs(tangent).max()), judged),
        Row(name, "shifts", "1", None, float(driven.summary.shifts or 0)),
        Row(name, "smallest clearance", "m", None, float(signals["vehicle.clearance"].min())),
        Row(name, "time", "s", None, driven.summary.duration),
    ]
