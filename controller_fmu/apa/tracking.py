"""Where the car is along its move, and the angle that leads it back: ``controller_fmu.common.path_law``."""

import math
from typing import NamedTuple

from controller_fmu.apa.params import ApaDriveParams
from controller_fmu.apa.ways.move import Move, length_of, point_at
from controller_fmu.common.path_law import angle_back, deviation
from modelkit.vocabulary import Pose

JUMP = 1e-6
INTO = 0.001
"""So far [m] into a leg its curvature is looked up: past a jump at its start."""


class Tracked(NamedTuple):
    """Where the car is along its move, how far off it is, and the angle that leads it back."""

    way: float = 0.0
    """Driven of the move [m]."""
    left: float = 0.0
    """Left of the move [m]."""
    to_stop: float = 0.0
    """Way [m] to the next standstill: the end, or a jump of curvature."""
    reference: Pose = Pose()
    lateral_error: float = 0.0
    heading_error: float = 0.0
    front_wheel_angle: float = 0.0
    slope: float = 0.0
    """Change of the reference's curvature over the way [1/m2]."""


class Leg(NamedTuple):
    """The part of a move between two standstills; odometry may jitter around their places, the leg does not."""

    start: float = 0.0
    end: float = 0.0


def track(move: Move, leg: Leg, way: float, pose: Pose, law: ApaDriveParams, wheelbase: float) -> Tracked:
    """Return the tracking of ``leg`` of ``move`` by a car at ``pose`` (slot's frame) that was at ``way`` before."""
    direction = float(move.direction)
    for _ in range(2):
        at = point_at(move, way).pose
        way += direction * ((pose.x - at.x) * math.cos(at.heading) + (pose.y - at.y) * math.sin(at.heading))
    point = point_at(move, way if way > leg.start + INTO else leg.start + INTO)
    at = point.pose
    off = deviation(pose, at)
    angle = angle_back(off, point.curvature, direction, law.k1, law.k2, wheelbase)
    return Tracked(way, length_of(move) - way, leg.end - way, at, off.lateral, off.heading, angle, point.slope)


def next_standstill(move: Move, after: float) -> float:
    """Return where [m] along a move the next jump of curvature after ``after`` lies, or its end."""
    along = 0.0
    last = 0.0
    begun = False
    for piece in move.pieces:
        if piece.length > 0.0:
            if begun and abs(piece.k0 - last) > JUMP and along > after + JUMP:
                return along
            along += piece.length
            last = piece.k1
            begun = True
    return along


def set_wheel(move: Move, leg: Leg, way: float, wheelbase: float) -> float:
    """Return the front-wheel angle [rad] to set at standstill before driving on from ``way`` within ``leg``."""
    at = way if way > leg.start else leg.start
    return math.atan(wheelbase * point_at(move, at + INTO).curvature)
