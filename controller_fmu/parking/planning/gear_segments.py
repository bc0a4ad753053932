"""Segments of a path that are driven in one gear, without a change of direction."""

from typing import NamedTuple

from controller_fmu.parking.planning.planner import PlannedPath
from modelkit.maths import sign

MIN_LENGTH = 0.01
"""A last segment that is shorter [m] is left out."""


class GearSegment(NamedTuple):
    """The segments that are driven in one gear, from ``first`` to ``last``, and their length [m]."""

    first: int
    last: int
    length: float


def gear_segment(path: PlannedPath, segment: int) -> GearSegment:
    """Return the gear segment that ``segment`` is of."""
    direction = sign(path.segments[segment].distance)
    first = segment
    while first > 0 and path.segments[first - 1].distance * direction > 0.0:
        first -= 1
    last = first
    length = abs(path.segments[first].distance)
    while last + 1 < path.used and path.segments[last + 1].distance * direction > 0.0:
        last += 1
        length += abs(path.segments[last].distance)
    return GearSegment(first, last, length)


def distance_before(path: PlannedPath, whole: GearSegment, segment: int) -> float:
    """Return the distance [m] from the start of a gear segment to that of ``segment`` in it."""
    distance = 0.0
    for number in range(whole.first, segment):
        distance += abs(path.segments[number].distance)
    return distance


def without_short_end(path: PlannedPath) -> PlannedPath:
    """Return the path without last segments shorter than ``MIN_LENGTH``."""
    used = path.used
    while used > 1 and abs(path.segments[used - 1].distance) < MIN_LENGTH:
        used -= 1
    return path._replace(used=used)
