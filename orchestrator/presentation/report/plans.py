"""What the controller has in mind over time: planned path, slot it found, pose it wants to reach."""

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from orchestrator.evaluation.verdict.frame import pose_at
from orchestrator.evaluation.verdict.geometry import PLANNED, find_changes, is_planned, place, sample_path
from orchestrator.presentation.report.payload import Arrays
from orchestrator.simulation.cosim.fmu_instance import Array, Indices
from orchestrator.simulation.cosim.recording import Recording

MOST_PLANS = 60
PARTS = re.compile(rf"controller\.({PLANNED.pattern}|.*\bslot\.|.*\bcorner_b\.|.*\btarget\.)")
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
    """Return the corners (4, 2) [m] of the slot a parking assist has chosen; None if it has none.

    Corner A is the edge passed first, x runs along the road to corner B, the slot lies to the right
    (``side`` 0) or to the left.
    """
    if not values.get("apa.slot.kind", 0.0) > 0.0:
        return None
    length, out = values["apa.slot.length"], values["apa.slot.b_out"]
    depth = min(values["apa.slot.depth"], OPEN_DEPTH)
    mirror = -1.0 if values["apa.slot.side"] > 0.0 else 1.0
    corners = np.array([[0.0, 0.0], [length, out], [length, -depth], [0.0, -depth]]) * np.array([1.0, mirror])
    return place(corners, *pose_at(values, "apa.slot.a"))


def target_pose(values: Mapping[str, float]) -> tuple[float, float, float] | None:
    """Return the pose a parking assist wants to park at; None if it has no slot."""
    return pose_at(values, "apa.target") if values.get("apa.slot.kind", 0.0) > 0.0 else None
