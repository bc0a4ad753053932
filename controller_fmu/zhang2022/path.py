"""The parking path: three quintics through the key points, its check and its look-up."""

import math
from enum import IntEnum
from typing import NamedTuple

from controller_fmu.common.arc_line_arc import ArcLineArc, arc_line_arc, largest_radius
from controller_fmu.zhang2022.quintic import (
    Derivatives,
    Knot,
    Quintic,
    quintic,
    quintic_between,
    shape,
)
from controller_fmu.zhang2022.time_quintic import knot_at, time_quintic
from modelkit.vocabulary import Pose

RADII_PER_ROUND = 9
REFINEMENT_ROUNDS = 4
"""Each looks at radii four times as close to each other as the one before."""
CURVATURE_SAMPLES = 32
FOOT_STEPS = 5
CURVATURE_WITHOUT_PATH = 1e9
"""Curvature [1/m] said of what is no path y(x)."""
MAX_PATH_HEADING = 1.2
"""Largest heading of a path given as y(x) [rad]."""


class PathStatus(IntEnum):
    """Whether there is a path, and if not why."""

    NONE = 0
    FOUND = 1
    BAD_START = 2
    """The start is not ahead of and beside the target, or turned too far."""
    CURVATURE_LIMIT = 3
    """No radius keeps the quintics' curvature under the car's."""
    SLOT_BLOCKED = 4
    """Paths within the curvature limit touch a neighbour."""


EMPTY = ArcLineArc(0.0, 0.0, 1.0)


class QuinticPath(NamedTuple):
    """Pieces from the start (largest x) to the target at the origin, driven in reverse."""

    status: int = PathStatus.NONE
    start: Pose = Pose()
    arcs: ArcLineArc = EMPTY
    largest_curvature: float = 0.0
    first: Quintic = Quintic()
    line: Quintic = Quintic()
    last: Quintic = Quintic()
    length: float = 0.0
    """Along the path [m]; known once it is chosen."""


class EndConditions(NamedTuple):
    """Speeds [m] and accelerations [m] at both ends of quintics over a final time of 1, along the path."""

    start_speed: float
    gaining: float
    """Acceleration at the start."""
    speed: float
    """At the target."""
    slowing: float
    """Deceleration at the target."""


class Joints(NamedTuple):
    """Where three quintics meet, in driving order."""

    upper: Knot
    lower: Knot


class PathTried(NamedTuple):
    """The path found or refused, and its radius or the best one [m]."""

    path: QuinticPath = QuinticPath()
    radius: float = 0.0


class Reference(NamedTuple):
    """The path's point nearest to the car and the errors against it."""

    pose: Pose = Pose()
    curvature: float = 0.0
    lateral_error: float = 0.0
    heading_error: float = 0.0


def plan(start: Pose, radius: float, curvature_limit: float) -> QuinticPath:
    """Return the path from ``start`` (slot frame) to the origin, or why there is none.

    Radii from the one wished to the largest that fits are tried in turn: the larger the arcs, the
    smaller the quintics' peak, until the line between them is gone and the peak rises again. The first
    whose curvature stays within ``curvature_limit`` [1/m] is taken. Where none of them does, the radii
    around the best are tried in finer steps before the start is refused.
    """
    if not (start.x > 0.1 and start.y > 0.01 and abs(start.heading) < 0.5):
        return _refuse(PathStatus.BAD_START, start, 0.0)
    widest = largest_radius(start.x, start.y)
    low = min(widest, radius)
    high = widest
    tried = PathTried()
    for _ in range(REFINEMENT_ROUNDS):
        tried = _first_within(start, low, high, curvature_limit)
        if tried.path.status == PathStatus.FOUND:
            return tried.path
        step = (high - low) / (RADII_PER_ROUND - 1.0)
        low = max(low, tried.radius - step)
        high = min(high, tried.radius + step)
    return tried.path


def _first_within(start: Pose, low: float, high: float, curvature_limit: float) -> PathTried:
    """Return the path of the smallest of some radii that keeps the limit, or the refusal and the best radius."""
    smallest_peak = 1e9
    best = low
    for candidate in range(RADII_PER_ROUND):
        share = candidate / (RADII_PER_ROUND - 1.0)
        arcs = arc_line_arc(start.x, start.y, low + share * (high - low))
        if arcs.line >= 0.0 and 0.0 < arcs.angle < MAX_PATH_HEADING:
            path = through(start, arcs)
            if path.largest_curvature <= curvature_limit:
                return PathTried(path, arcs.radius)
            if path.largest_curvature < smallest_peak:
                smallest_peak = path.largest_curvature
                best = arcs.radius
    return PathTried(_refuse(PathStatus.CURVATURE_LIMIT, start, smallest_peak), best)


def through(start: Pose, arcs: ArcLineArc) -> QuinticPath:
    """Return the three quintics through the ends of the arcs; the middle one is the line itself."""
    x = arcs.radius * math.sin(arcs.angle)
    y = arcs.radius * (1.0 - math.cos(arcs.angle))
    slope = math.tan(arcs.angle)
    x2 = x + arcs.line * math.cos(arcs.angle)
    y2 = y + arcs.line * math.sin(arcs.angle)
    first = quintic(x2, y2, slope, start.x, start.y, math.tan(start.heading))
    length = max(1e-9, x2 - x)
    line = Quintic(x, length, y, slope * length, 0.0, 0.0, 0.0)
    last = quintic(0.0, 0.0, 0.0, x, y, slope)
    return QuinticPath(
        PathStatus.FOUND, start, arcs, max(largest_curvature(last), largest_curvature(first)), first, line, last
    )


def join_quintics(start: Pose, x: float, y: float, slope: float) -> QuinticPath:
    """Return two quintics that meet at (``x``, ``y``) with ``slope`` and without curvature; no line between."""
    first = quintic(x, y, slope, start.x, start.y, math.tan(start.heading))
    line = Quintic(x, 1e-9, y, slope * 1e-9, 0.0, 0.0, 0.0)
    last = quintic(0.0, 0.0, 0.0, x, y, slope)
    return QuinticPath(
        PathStatus.FOUND, start, EMPTY, max(largest_curvature(last), largest_curvature(first)), first, line, last
    )


def over_time(start: Pose, ends: EndConditions) -> QuinticPath:
    """Return the path of quintics x(t), y(t) from ``start`` (slot frame) to the origin, as three quintics y(x).

    They agree with it in position, slope and bend at thirds of the final time. The accelerations at both ends lie along
    the path, so that it has no curvature there. No path if it does not lead on towards falling x.
    """
    c = math.cos(start.heading)
    s = math.sin(start.heading)
    speed, slowing = ends.speed, ends.slowing
    x = time_quintic(start.x, -c * ends.start_speed, -c * ends.gaining, -speed, slowing)
    y = time_quintic(start.y, -s * ends.start_speed, -s * ends.gaining, 0.0, 0.0)
    return through_joints(start, Joints(knot_at(x, y, 1.0 / 3.0), knot_at(x, y, 2.0 / 3.0)))


def through_joints(start: Pose, joints: Joints) -> QuinticPath:
    """Return the three quintics y(x) from ``start`` through both joints to the origin; no path if one is too short."""
    high = Knot(start.x, start.y, math.tan(start.heading), 0.0)
    if not 0.01 < joints.lower.x < joints.upper.x - 0.01 < high.x - 0.02:
        return QuinticPath(PathStatus.CURVATURE_LIMIT, start, EMPTY, CURVATURE_WITHOUT_PATH)
    first = quintic_between(joints.upper, high)
    line = quintic_between(joints.lower, joints.upper)
    last = quintic_between(Knot(0.0, 0.0, 0.0, 0.0), joints.lower)
    peak = max(largest_curvature(last), largest_curvature(line), largest_curvature(first))
    return QuinticPath(PathStatus.FOUND, start, EMPTY, peak, first, line, last)


def joints_of(path: QuinticPath) -> Joints:
    """Return the points at which the three quintics of a path meet."""
    return Joints(_knot_of(path.first), _knot_of(path.line))


def _knot_of(piece: Quintic) -> Knot:
    bend = 2.0 * piece.c2 / (piece.length * piece.length)
    return Knot(piece.x0, piece.y0, piece.m0 / piece.length, bend)


def at(path: QuinticPath, x: float) -> Derivatives:
    """Return the path at ``x`` [m] of the slot frame; straight on beyond both ends."""
    if x > path.first.x0 + path.first.length:
        slope = math.tan(path.start.heading)
        return Derivatives(path.start.y + slope * (x - path.start.x), slope, 0.0)
    if x > path.first.x0:
        return shape(path.first, x)
    if x > path.line.x0:
        return shape(path.line, x)
    if x > 0.0:
        return shape(path.last, x)
    return Derivatives(0.0, 0.0, 0.0)


def length_of(path: QuinticPath) -> float:
    """Return the length of a path [m], by Simpson's rule over its quintics."""
    return piece_length(path.first) + piece_length(path.line) + piece_length(path.last)


def piece_length(piece: Quintic) -> float:
    """Return the length of a quintic [m]."""
    total = 0.0
    for sample in range(CURVATURE_SAMPLES + 1):
        slope = shape(piece, piece.x0 + piece.length * sample / CURVATURE_SAMPLES).slope
        weight = 1.0 if sample in (0, CURVATURE_SAMPLES) else 4.0 if sample % 2 == 1 else 2.0
        total = total + weight * math.sqrt(1.0 + slope * slope)
    return total * piece.length / (3.0 * CURVATURE_SAMPLES)


def final_time(length: float, speed: float, up: float, down: float) -> float:
    """Return the time [s] for a way ``length`` [m] from rest to rest at ``speed`` [m/s], ramps ``up``, ``down`` [m/s2].

    A way too short for the speed is driven as a triangle.
    """
    ramps = 0.5 * (1.0 / up + 1.0 / down)
    top = min(speed, math.sqrt(length / ramps))
    return length / top + ramps * top if top > 0.0 else 0.0


def nearest(path: QuinticPath, pose: Pose) -> Reference:
    """Return the reference at the foot of the perpendicular from ``pose``, and the errors, left positive.

    Newton on (x - px) + (y - py) y' = 0 with slope 1 + y'^2, from x = px.
    """
    x = pose.x
    for _ in range(FOOT_STEPS):
        point = at(path, x)
        x = x - ((x - pose.x) + (point.y - pose.y) * point.slope) / (1.0 + point.slope * point.slope)
    point = at(path, x)
    heading = math.atan(point.slope)
    lateral = (pose.y - point.y) * math.cos(heading) - (pose.x - x) * math.sin(heading)
    return Reference(Pose(x, point.y, heading), point.curvature, lateral, pose.heading - heading)


def largest_curvature(piece: Quintic) -> float:
    """Return the largest curvature of a quintic [1/m], of ``CURVATURE_SAMPLES`` places along it."""
    largest = 0.0
    for sample in range(CURVATURE_SAMPLES + 1):
        largest = max(largest, abs(shape(piece, piece.x0 + piece.length * sample / CURVATURE_SAMPLES).curvature))
    return largest


def _refuse(status: int, start: Pose, peak: float) -> QuinticPath:
    return QuinticPath(status, start, EMPTY, peak)
