"""The table that this machine's library of functions has for the tangent, read out of its file.

glibc works out the tangent from points x near i / 256 that are chosen so that tan x and cot x lie very near
doubles. They follow no formula, but show in the file: x, tan x and cot x one behind the other, for 186 points.
"""

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

POINT_COUNT = 186
ROW_COUNT = 256
"""Of the C table: a power of two, so that the lowest bits of any number are a row."""
FIRST_POINT, POINT_STEP = 16.0 / 256.0, 1.0 / 256.0
"""[rad]"""
MAX_DISTANCE = 1e-7
"""From a point to the next multiple of the step [rad]."""
ROW_LENGTH = 4
"""Numbers of a point: x, tan x, cot x and a rest of tan x."""
MAPPINGS = Path("/proc/self/maps")


def tangent_table() -> str:
    """Return the table as a C file, without points where this machine's library has no such table."""
    rows = [[x, tangent, cotangent, tangent + cotangent] for x, tangent, cotangent, _ in _points()]
    lines = "".join(f"    {{{', '.join(map(float.hex, row))}}},\n" for row in rows)
    table = f"static const double lane_tangents[LANE_TANGENTS][4] = {{\n{lines}}};\n" if rows else ""
    return f"#define LANE_TANGENTS {ROW_COUNT if rows else 0}\n{table}"


def _points() -> list[list[float]]:
    try:
        files = {line.split()[-1] for line in MAPPINGS.read_text(encoding="utf-8").splitlines() if "/libm" in line}
        return next((found for file in sorted(files) if (found := find_points(Path(file).read_bytes()))), [])
    except OSError:
        return []


def find_points(data: bytes) -> list[list[float]]:
    """Return the points in a file: x, tan x, cot x, rest; empty if there are none."""
    numbers = np.frombuffer(data[: len(data) // 8 * 8], dtype="<f8")
    last = len(numbers) - ROW_LENGTH * POINT_COUNT
    with np.errstate(invalid="ignore"):
        firsts = np.flatnonzero(np.abs(numbers[: max(last + 1, 0)] - FIRST_POINT) < MAX_DISTANCE)
    for first in firsts.tolist():
        rows = numbers[first : first + ROW_LENGTH * POINT_COUNT].reshape(POINT_COUNT, ROW_LENGTH)
        if _are_points(rows):
            found: list[list[float]] = rows.tolist()
            return found
    return []


def _are_points(rows: NDArray[np.float64]) -> bool:
    angles = FIRST_POINT + POINT_STEP * np.arange(POINT_COUNT)
    near = np.abs(rows[:, 0] - angles) < MAX_DISTANCE
    return bool(near.all()) and all(
        abs(tangent - math.tan(x)) <= math.ulp(tangent) and abs(cotangent * tangent - 1.0) < 1e-15
        for x, tangent, cotangent, _ in rows.tolist()
    )
