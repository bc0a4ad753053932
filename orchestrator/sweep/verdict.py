"""The summary of many runs at once: the same numbers and verdicts as ``orchestrator.verdict.summary``, as columns."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from modelkit.variables import variables
from orchestrator.cosim.endings import FINAL_PHASES
from orchestrator.cosim.slave import Array
from orchestrator.scenario.models import MODELS
from orchestrator.scenario.requirements import Requirement
from orchestrator.scenario.scenario import Scenario
from orchestrator.sweep.job import Chunk, Job
from orchestrator.sweep.kept import (
    ABORTED,
    CLEARANCE,
    EFFORT,
    FIRST_KEPT,
    PHASE,
    POSE,
    REASON,
    SHIFTS,
    SPEED,
    WHEEL,
    Kept,
    kept_for,
)
from orchestrator.verdict.frame import in_frame
from orchestrator.verdict.judge import margins

OUTCOMES = ("parked", "not_parked", "failed", "aborted")
PARKED, NOT_PARKED, FAILED, ABORT = range(4)


class Column(NamedTuple):
    """One column of results."""

    unit: str
    text: str


RESULTS = {
    "duration": Column("s", "from start to the end of the run"),
    "shifts": Column("1", "manoeuvres, the first reverse counts one"),
    "max_speed": Column("m/s", "largest absolute speed"),
    "final.x": Column("m", "x of the rear-axle midpoint at the end"),
    "final.y": Column("m", "y of the rear-axle midpoint at the end"),
    "final.heading": Column("rad", "heading at the end"),
    "final.longitudinal_error": Column("m", "in the target's frame, along its heading"),
    "final.lateral_error": Column("m", "in the target's frame, to its left"),
    "final.heading_error": Column("rad", "heading minus the target's, wrapped"),
    "final.steering_wheel_angle": Column("rad", "steering-wheel angle at the end, left positive"),
    "steering_effort": Column("rad", "sum of the absolute changes of the steering-wheel angle"),
    "min_clearance": Column("m", "smallest distance of the outline to anything in the scene"),
    "limit_share": Column("1", "largest value over its limit among the required checks; above 1: beyond it"),
}


class Verdict(NamedTuple):
    """Results of a chunk."""

    outcome: NDArray[np.int8]
    """Places in ``OUTCOMES``."""
    reason: list[str]
    numbers: dict[str, Array]
    """By the names of ``RESULTS``, those that this vehicle has."""


def judge(job: Job, chunk: Chunk, rows: Array) -> Verdict:
    """Return the results of the runs of ``chunk`` from what was kept of them."""
    scenario = Scenario(**job.scenario)
    kept = {item: rows[:, place + FIRST_KEPT] for place, item in enumerate(job.kept)}
    numbers = _numbers(job, chunk, scenario, rows, kept)
    shares = np.zeros(len(rows))
    missed: list[tuple[str, NDArray[np.bool_]]] = []
    for place, limit in enumerate(scenario.limits):
        if limit.required:
            values = numbers[limit.signal] if limit.signal in numbers else kept[kept_for(limit, place)]
            missed.append((limit.id, ~(margins(limit.condition, values, limit_value(limit)) >= 0.0)))
            shares = np.maximum(shares, _share(limit, values))
    numbers["limit_share"] = shares
    outcome, reason = _outcomes(rows[:, 0], kept, missed)
    return Verdict(outcome, reason, numbers)


def _numbers(job: Job, chunk: Chunk, scenario: Scenario, rows: Array, kept: dict[Kept, Array]) -> dict[str, Array]:
    x, y, heading = (kept[item] for item in POSE)
    targets = _targets(job, chunk, scenario)
    errors = np.array(
        [in_frame(*pose) for pose in zip(x.tolist(), y.tolist(), heading.tolist(), targets, strict=True)]
    ).reshape(-1, 3)
    numbers = {
        "duration": rows[:, 1] / 1e9,
        "shifts": kept[SHIFTS],
        "max_speed": np.abs(kept[SPEED]),
        "final.x": x,
        "final.y": y,
        "final.heading": heading,
        "final.longitudinal_error": errors[:, 0],
        "final.lateral_error": errors[:, 1],
        "final.heading_error": errors[:, 2],
        "final.steering_wheel_angle": kept[WHEEL],
        "steering_effort": kept[EFFORT],
    }
    return {**numbers, **({"min_clearance": kept[CLEARANCE]} if CLEARANCE in kept else {})}


def _targets(job: Job, chunk: Chunk, scenario: Scenario) -> list[tuple[float, float, float]]:
    """Return the target pose of every run."""
    starts = {item.name: float(item.start) for item in variables(MODELS["controller"].params)}
    given = {**starts, **scenario.controller}
    columns = []
    for axis in ("x", "y", "heading"):
        key = f"controller.target.{axis}"
        same = [float(given[f"target.{axis}"])] * len(chunk.seeds)
        columns.append(chunk.values[:, job.keys.index(key)].tolist() if key in job.keys else same)
    return list(zip(*columns, strict=True))


def limit_value(limit: Requirement) -> float:
    """Return the limit as a number, also where it is the name of a state."""
    if not isinstance(limit.limit, str):
        return limit.limit
    word = limit.limit.upper().replace(" ", "_").replace("-", "_")
    return float({name: value for value, name in _states(limit.signal).items()}[word])


def _share(limit: Requirement, values: Array) -> Array:
    if limit.condition not in ("max", "max_abs") or not limit_value(limit) > 0.0:
        return np.zeros(len(values))
    return np.nan_to_num(np.abs(values) / limit_value(limit), nan=np.inf)


def _outcomes(
    ends: Array, kept: dict[Kept, Array], missed: list[tuple[str, NDArray[np.bool_]]]
) -> tuple[NDArray[np.int8], list[str]]:
    names, reasons = (_states(item.signal) for item in (PHASE, REASON))
    failing = np.any([miss for _, miss in missed], axis=0) if missed else np.zeros(len(ends), dtype=bool)
    outcome = np.full(len(ends), NOT_PARKED, dtype=np.int8)
    texts = []
    for row, (end, phase) in enumerate(zip(ends.tolist(), kept[PHASE].tolist(), strict=True)):
        name = names.get(int(phase), f"{phase:g}") if phase == phase else "nan"
        if end == ABORTED:
            outcome[row], text = ABORT, "error"
        elif name == "FAILED":
            outcome[row], text = FAILED, reasons[int(kept[REASON][row])].lower()
        elif name == "PARKED" and failing[row]:
            text = "beyond its limit: " + ", ".join(limit for limit, miss in missed if miss[row])
        elif name == "PARKED":
            outcome[row], text = PARKED, "all checks passed"
        else:
            text = name.lower() if name in FINAL_PHASES else f"stop time reached in {name.lower()}"
        texts.append(text)
    return outcome, texts


def _states(signal: str) -> dict[int, str]:
    owner, _, name = signal.partition(".")
    variable: Any = next(item for item in variables(MODELS[owner].outputs) if item.name == name)
    return {int(state): state.name for state in variable.signal.states}
