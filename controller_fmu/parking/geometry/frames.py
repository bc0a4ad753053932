"""Rigid transformations in the plane between the odometry frame and a local frame."""

import math

from modelkit.geometry import Point
from modelkit.vocabulary import Pose


def planar_distance(ax: float, ay: float, bx: float, by: float) -> float:
    """Return the distance [m] of two points."""
    return math.sqrt((ax - bx) * (ax - bx) + (ay - by) * (ay - by))


def point_to_frame(x: float, y: float, frame: Pose) -> Point:
    """Return the point (x, y) [m] of the odometry frame in the local ``frame``: R' (p - t)."""
    cos = math.cos(frame.heading)
    sin = math.sin(frame.heading)
    dx = x - frame.x
    dy = y - frame.y
    return Point(dx * cos + dy * sin, dy * cos - dx * sin)


def point_from_frame(x: float, y: float, frame: Pose) -> Point:
    """Return the point (x, y) [m] of the local ``frame`` in the odometry frame: t + R p."""
    cos = math.cos(frame.heading)
    sin = math.sin(frame.heading)
    return Point(frame.x + x * cos - y * sin, frame.y + x * sin + y * cos)


def pose_to_frame(pose: Pose, frame: Pose) -> Pose:
    """Return ``pose`` relative to ``frame``; the heading [rad] is not wrapped."""
    point = point_to_frame(pose.x, pose.y, frame)
    return Pose(point.x, point.y, pose.heading - frame.heading)


def pose_from_frame(pose: Pose, frame: Pose) -> Pose:
    """Return a ``pose`` of the local ``frame`` in the odometry frame; the heading [rad] is not wrapped."""
    point = point_from_frame(pose.x, pose.y, frame)
    return Pose(point.x, point.y, pose.heading + frame.heading)
