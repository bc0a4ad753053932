"""Scenes of our own in the format of ParkBench: a slot between two parked vehicles, tail in, and a wall opposite."""

import json
import math
from itertools import pairwise
from pathlib import Path
from typing import Any

HIGH, LOW = "nfm::fs::interface::EFusionHeightClass::HIGH", "nfm::fs::interface::EFusionHeightClass::LOW"
TARGET = (10.0, 20.0, 0.5 * math.pi)
LEFT = [(8.9, 25.0), (6.9, 25.0), (6.9, 19.0), (8.9, 19.0), (8.9, 25.0)]
RIGHT = [(11.1, 25.0), (13.1, 25.0), (13.1, 19.0), (11.1, 19.0), (11.1, 25.0)]
WALL = [(0.0, 33.0), (22.0, 33.0)]
WHEEL_STOP = [(9.0, 19.7), (11.0, 19.7)]


def polyline(points: Any, height: str = HIGH) -> Any:
    """Return an object of a scene."""
    return {"nfmPolygonObjectNodes": [{"m_x": x, "m_y": y, "m_height": height} for x, y in points]}


def scene(start: Any = (5.0, 29.0, 0.0), target: Any = TARGET, objects: Any = None, **request: Any) -> Any:
    """Return the content of a scene."""
    found = objects if objects is not None else [polyline(item) for item in (LEFT, RIGHT, WALL)]
    posture = {"m_targetPosture": {"m_pose": list(target), "m_curvature": 0.0}}
    area = {**posture, "m_lateralTolerance": 0.05, "m_longitudinalTolerance": 0.05}
    asked = {"m_startPosture": {"m_pose": list(start)}, "m_targetArea": area, **request}
    return {"Frames": {"0": {"PlanningRequest": asked, "NfmAggregatedPolygonObjects": found}}}


def pieces(points: Any, length: float) -> Any:
    """Return a polyline as straight pieces of at most ``length`` [m]."""
    found: list[Any] = []
    for a, b in pairwise(points):
        count = math.ceil(math.dist(a, b) / length)
        ends = [tuple(p + (q - p) * n / count for p, q in zip(a, b, strict=True)) for n in range(count + 1)]
        found += pairwise(ends)
    return [list(item) for item in found]


def large_scene(length: float = 0.1) -> Any:
    """Return the scene with its polylines as pieces of this length [m], as the data have them."""
    found = [polyline(piece) for item in (LEFT, RIGHT, WALL) for piece in pieces(item, length)]
    return scene(objects=[*found, polyline(WHEEL_STOP, LOW)])


def write(path: Path, content: Any) -> Path:
    """Write a scene; returns its file."""
    path.write_text(json.dumps(content))
    return path
