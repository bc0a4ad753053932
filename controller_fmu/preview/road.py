"""The road as a row of straights and circular arcs, from the origin along the x axis."""

import math
from typing import NamedTuple

from controller_fmu.preview.params import RoadPiece
from modelkit.maths import wrap_angle
from modelkit.vocabulary import Pose

PROJECTION_STEPS = 4


class RoadPoint(NamedTuple):
    """A point of the road and what the road does there."""

    pose: Pose
    curvature: float


def road_length(road: tuple[RoadPiece, ...]) -> float:
    """Return the length of the road [m]."""
    length = 0.0
    for index in range(len(road)):
        length = length + road[index].length
    return length


def curvature_at(road: tuple[RoadPiece, ...], s: float) -> float:
    """Return the curvature [1/m] at arc length ``s``; zero before the start and past the end."""
    start = 0.0
    for index in range(len(road)):
        end = start + road[index].length
        if start <= s < end:
            return road[index].curvature
        start = end
    return 0.0


def road_at(road: tuple[RoadPiece, ...], s: float) -> RoadPoint:
    """Return the road at arc length ``s`` [m]; straight on before the start and past the end."""
    pose = Pose(0.0, 0.0, 0.0)
    if s < 0.0:
        return RoadPoint(Pose(s, 0.0, 0.0), 0.0)
    left = s
    for index in range(len(road)):
        piece = road[index]
        if left < piece.length:
            return RoadPoint(along(pose, piece.curvature, left), piece.curvature)
        pose = along(pose, piece.curvature, piece.length)
        left = left - piece.length
    return RoadPoint(along(pose, 0.0, left), 0.0)


def along(pose: Pose, curvature: float, length: float) -> Pose:
    """Return the pose ``length`` [m] further on an arc: chord 2 sin(k l / 2) / k at heading + k l / 2."""
    half = 0.5 * curvature * length
    chord = length if abs(half) < 1e-9 else length * math.sin(half) / half
    return Pose(
        pose.x + chord * math.cos(pose.heading + half),
        pose.y + chord * math.sin(pose.heading + half),
        wrap_angle(pose.heading + 2.0 * half),
    )


def lateral_offset(pose: Pose, x: float, y: float) -> float:
    """Return how far (x, y) lies left of the axis of ``pose`` [m]."""
    return (y - pose.y) * math.cos(pose.heading) - (x - pose.x) * math.sin(pose.heading)


def longitudinal_offset(pose: Pose, x: float, y: float) -> float:
    """Return how far (x, y) lies ahead of ``pose`` [m]."""
    return (x - pose.x) * math.cos(pose.heading) + (y - pose.y) * math.sin(pose.heading)


def project(road: tuple[RoadPiece, ...], s: float, x: float, y: float) -> float:
    """Return the arc length [m] of the road's point nearest to (x, y), found from the guess ``s``.

    Newton on the tangent distance; on an arc d/ds of it is -(1 - kappa e), held above 0.2.
    """
    for _ in range(PROJECTION_STEPS):
        point = road_at(road, s)
        slope = 1.0 - point.curvature * lateral_offset(point.pose, x, y)
        if slope < 0.2:
            slope = 0.2
        s = s + longitudinal_offset(point.pose, x, y) / slope
    return s


def ahead(road: tuple[RoadPiece, ...], s: float, pose: Pose, distance: float) -> float:
    """Return the arc length [m] where the road crosses the line ``distance`` ahead of ``pose``; ``s``: a guess."""
    for _ in range(PROJECTION_STEPS):
        point = road_at(road, s).pose
        slope = math.cos(point.heading - pose.heading)
        if slope < 0.2:
            slope = 0.2
        s = s + (distance - longitudinal_offset(pose, point.x, point.y)) / slope
    return s
