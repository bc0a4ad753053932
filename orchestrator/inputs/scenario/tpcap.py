"""A case of TPCAP (Trajectory Planning Competition for Automated Parking) as a scenario.

A file has one line of numbers: start x, y, heading; goal x, y, heading; the count of obstacles; for each its count
of corners; then all corners x, y. Coordinates may lie far out; here the goal is the origin.
"""

import math
from pathlib import Path
from typing import Any

from orchestrator.inputs.text.errors import BadInput

STOP_TIME = 400.0
"""[s]"""
PLAN_MARGIN = 0.1
"""Desired clearance [m]."""
MIN_PLAN_MARGIN = 0.01
"""Least clearance [m]: the map is exact, and a kinematic body leaves its path by up to 8 mm."""


def read_tpcap(path: Path) -> dict[str, Any]:
    """Return the scenario of a case as plain data for YAML. Raises ``BadInput``."""
    numbers = _numbers(path)
    start, goal, count = numbers[:3], numbers[3:6], numbers[6]
    if count != int(count) or count < 0 or len(numbers) < 7 + count:
        raise BadInput(f"{count:g} obstacles: expected a whole number, and as many counts of corners", file=path)
    counts = numbers[7 : 7 + int(count)]
    odd = next((size for size in counts if size != int(size)), None)
    if odd is not None:
        raise BadInput(f"{odd:g} corners: expected a whole number", file=path)
    for name, heading in (("start", start[2]), ("goal", goal[2])):
        if abs(heading) > 2.0 * math.pi:
            raise BadInput(f"heading of {name} {heading:g}: expected radians, at most one turn", file=path)
    sizes = [int(size) for size in counts]
    rest = numbers[7 + int(count) :]
    if len(rest) != 2 * sum(sizes) or any(size < 3 for size in sizes):
        raise BadInput(f"{len(rest)} coordinates for obstacles of {sizes} corners, three or more each", file=path)
    points = [[rest[at] - goal[0], rest[at + 1] - goal[1]] for at in range(0, len(rest), 2)]
    ends = [sum(sizes[: place + 1]) for place in range(len(sizes))]
    return {
        "name": path.stem,
        "title": f"TPCAP, {path.stem}",
        "source": "Trajectory Planning Competition for Automated Parking",
        "car": "tpcap",
        "stop_time": STOP_TIME,
        "target": {"x": 0.0, "y": 0.0, "heading": goal[2]},
        "obstacles": [points[end - size : end] for end, size in zip(ends, sizes, strict=True)],
        "vehicle": {"start": {"x": start[0] - goal[0], "y": start[1] - goal[1], "heading": start[2]}},
        "controller": {
            "system": "apa",
            "search": {"active": False},
            "plan": {"margin": PLAN_MARGIN, "min_margin": MIN_PLAN_MARGIN, "curvature_fraction": 1.0},
        },
        "requirements": ["valet"],
        "expected_outcome": "parked",
    }


def _numbers(path: Path) -> list[float]:
    try:
        words = path.read_text(encoding="utf-8-sig").replace("\n", ",").split(",")
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f"cannot be read: {error}", file=path) from error
    try:
        numbers = [float(word) for word in words if word.strip()]
    except ValueError as error:
        raise BadInput(f"{error}: expected numbers and commas", file=path) from error
    if len(numbers) < 7 or not all(map(math.isfinite, numbers)):
        raise BadInput("expected at least seven finite numbers: start, goal, count of obstacles", file=path)
    return numbers
