"""A landmark: a point or a straight segment in the odometry frame, with its covariance.

The state of a segment is a point on its line, (x, y), and its direction; its ends lie ``start`` and ``end`` along that
direction from the point, each with a variance of its own. An end is *known* when echoes came from the corner itself;
else it is *open*: observed up to here, unknown beyond. A point landmark has ``start`` = ``end`` = 0.
"""

import math
from enum import IntEnum
from typing import NamedTuple

from modelkit.geometry import Point

MAX_LANDMARKS = 60
"""Capacity of the map."""


class LandmarkType(IntEnum):
    """Geometry of a landmark; ``NONE``: the place in the map is free."""

    NONE = 0
    POINT = 1
    SEGMENT = 2


class Landmark(NamedTuple):
    """State, covariance and history of a landmark; SI units."""

    type: int = LandmarkType.NONE
    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0
    xx: float = 0.0
    """Covariance of (x, y, heading), upper triangle."""
    xy: float = 0.0
    xh: float = 0.0
    yy: float = 0.0
    yh: float = 0.0
    hh: float = 0.0
    start: float = 0.0
    end: float = 0.0
    start_variance: float = 0.0
    end_variance: float = 0.0
    start_known: bool = False
    end_known: bool = False
    confirmations: int = 0
    """Updates since its initialisation."""
    contradictions: int = 0
    """Expected echoes that did not come, in a row."""
    gap_evidence: float = 0.0
    """ln P(its echoes | a gap between two cars across the road in it) - ln P(its echoes | none)."""


def segment_point(landmark: Landmark, along: float) -> Point:
    """Return the point of a landmark's line ``along`` [m] from its reference point."""
    return Point(landmark.x + along * math.cos(landmark.heading), landmark.y + along * math.sin(landmark.heading))


def start_point(landmark: Landmark) -> Point:
    """Return the start of a segment, or the point."""
    return segment_point(landmark, landmark.start)


def end_point(landmark: Landmark) -> Point:
    """Return the end of a segment, or the point."""
    return segment_point(landmark, landmark.end)


def length_of(landmark: Landmark) -> float:
    """Return the observed length [m] of a segment."""
    return landmark.end - landmark.start


def along_of(landmark: Landmark, x: float, y: float) -> float:
    """Return where [m] along a landmark's line the point (x, y) [m] of the odometry frame projects to."""
    return (x - landmark.x) * math.cos(landmark.heading) + (y - landmark.y) * math.sin(landmark.heading)


def offset_of(landmark: Landmark, x: float, y: float) -> float:
    """Return how far [m] to the left of a landmark's line the point (x, y) [m] of the odometry frame lies."""
    return (y - landmark.y) * math.cos(landmark.heading) - (x - landmark.x) * math.sin(landmark.heading)


def offset_variance(landmark: Landmark, along: float) -> float:
    """Return the variance [m2] of a landmark's line across its direction, ``along`` [m] from its reference point."""
    nx = -math.sin(landmark.heading)
    ny = math.cos(landmark.heading)
    across = nx * nx * landmark.xx + 2.0 * nx * ny * landmark.xy + ny * ny * landmark.yy
    lever = nx * landmark.xh + ny * landmark.yh
    return across + 2.0 * along * lever + along * along * landmark.hh


def with_offset_variance(landmark: Landmark, variance: float) -> Landmark:
    """Return a landmark with ``variance`` [m2] more across its direction."""
    nx = -math.sin(landmark.heading)
    ny = math.cos(landmark.heading)
    return landmark._replace(
        xx=landmark.xx + variance * nx * nx, xy=landmark.xy + variance * nx * ny, yy=landmark.yy + variance * ny * ny
    )


def segment_between(a: Point, b: Point, viewer: Point, variance: float, end_variance: float) -> Landmark:
    """Return the segment between two points [m], the ``viewer`` on its left, its variances [m2] across and along."""
    dx = b.x - a.x
    dy = b.y - a.y
    towards = 1.0 if dx * (viewer.y - a.y) - dy * (viewer.x - a.x) > 0.0 else -1.0
    square = dx * dx + dy * dy
    half = 0.5 * math.sqrt(square)
    heading = math.atan2(towards * dy, towards * dx)
    hh = 4.0 * variance / max(square, variance)
    segment = Landmark(type=LandmarkType.SEGMENT, x=0.5 * (a.x + b.x), y=0.5 * (a.y + b.y), heading=heading, hh=hh)
    segment = segment._replace(start=-half, end=half, start_variance=end_variance, end_variance=end_variance)
    return with_offset_variance(segment, variance)


def replace_landmark(landmarks: tuple[Landmark, ...], index: int, landmark: Landmark) -> tuple[Landmark, ...]:
    """Return the landmarks with the one at ``index`` replaced."""
    at = min(max(index, 0), MAX_LANDMARKS - 1)
    return landmarks[:at] + (landmark,) + landmarks[at + 1 :]


def free_index(landmarks: tuple[Landmark, ...]) -> int:
    """Return the index of a free place of the map, else that of the landmark with the fewest confirmations."""
    least = 0
    for number in range(MAX_LANDMARKS):
        if landmarks[number].type == LandmarkType.NONE:
            return number
        if landmarks[number].confirmations < landmarks[least].confirmations:
            least = number
    return least
