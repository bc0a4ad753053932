"""What the controller has in mind over time: planned path, slot it found, pose it wants to reach."""

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from orchestrator.evaluation.verdict.frame import pose_at
from orchestrator.evaluation.verdict.geometry import PLANNED, find_changes, is_planned, sample_path
from orchestrator.presentation.report.payload import Arrays
from orchestrator.simulation.cosim.fmu_instance import Array, Indices
from orchestrator.simulation.cosim.recording import Recording

MOST_PLANS = 60
PARTS = re.compile(rf"controller\.({PLANNED.pattern}|.*\bslot\.|.*\bgoal\.)")
OPEN_DEPTH = 5.5
"""Drawn depth [m] of a slot whose end the sensors have not seen."""
Point = tuple[float, float]


def plans_of(recording: Recording, arrays: Arrays, origin: Point, most: int = MOST_PLANS) -> list[dict[str, Any]]:
    """Return the plans with the time from which each held, positions less ``origin``; at most about ``most``."""
    names = [name for name in recording.signals if PARTS.match(name)]
    planned = is_planned(recording.signals)
    if not (names or len(planned)) or not len(recording.t):
        return []
    table = np.column_stack([*(recording.signals[name] for name in names), *([planned] if len(planned) else [])])
    changes = find_changes(table + 0.0)[1:]  # -0 is 0
    found = []
    parameters = recording.parameters_of("controller")
    for row in [0, *_fewer(changes, recording.t, most)]:
        values = recording.values_at("controller", row)
        plan: dict[str, Any] = {"t": float(recording.t[row])}
        points = sample_path(values, parameters=parameters) - origin
        plan["x"], plan["y"] = arrays.add(points[:, 0]), arrays.add(points[:, 1])
        slot, target = slot_corners(values), target_pose(values)
        if slot is not None:
            plan["slot"] = np.round(slot - origin, 4).tolist()
        if target is not None:
            plan["target"] = [target[0] - origin[0], target[1] - origin[1], target[2]]
        found.append(plan)
    return found


def _fewer(changes: Indices, t: Array, most: int) -> list[int]:
    """Return at most ``most`` of the rows ``changes``: of those close together in time, the last."""
    if len(changes) <= most:
        return [int(row) for row in changes]
    bins = ((t[changes] - t[0]) / (t[-1] - t[0]) * (most - 1)).astype(int)
    is_last = np.append(bins[1:] != bins[:-1], True)
    return [int(row) for row in changes[is_last]]


def slot_corners(values: Mapping[str, float]) -> Array | None:
    """Return the corners (4, 2) [m] of the slot that the parking system has chosen; None if it has none.

    A and B lie at the road, A is passed first; the slot lies to the left of A to B (``side`` 1) or to the right.
    """
    if not values.get("apa.slot.type", 0.0) > 0.0:
        return None
    a, b = (np.array([values[f"apa.slot.{corner}{axis}"] for axis in "xy"]) for corner in "ab")
    along = (b - a) / max(float(np.hypot(*(b - a))), 1e-9)
    depth = min(values["apa.slot.depth"], OPEN_DEPTH) * values["apa.slot.side"]
    into = depth * np.array([-along[1], along[0]])
    return np.array([a, b, b + into, a + into])


def target_pose(values: Mapping[str, float]) -> tuple[float, float, float] | None:
    """Return the pose that the parking system wants to reach; None if it has planned no path."""
    return pose_at(values, "apa.goal") if values.get("apa.plans", 0.0) > 0.0 else None
