"""NTBPT along a move: Guo 2015, eq. (6), both signs corrected, in the frame of the reference point.

The law needs |heading| < pi/2 in its frame, which one fixed frame cannot give on a path that turns by
90 deg. So its x axis is the path's tangent at the reference point, where the reference heading is 0 and
the point of equal x is the foot of the car on the tangent. With e the car's offset to the left of the
path and h_e its heading against it

    phi = atan( L cos^3(h_e) [ k_r - k1 e - direction k2 tan(h_e) ] )

Driving forward the way runs with x, not against it: e' = direction tan(h_e) over the way, hence the
factor in the k2 term; e'' = k - k_r in both directions. So e'' = -k1 e - k2 e' either way.
"""

import math
from typing import NamedTuple

from controller_fmu.apa.move import Move, length_of, point_at
from modelkit.maths import clamp, wrap_angle
from modelkit.vocabulary import Pose

STEEPEST = 1.3
JUMP = 1e-6
PASSED = 0.004


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


def track(move: Move, way: float, pose: Pose, k1: float, k2: float, wheelbase: float) -> Tracked:
    """Return the tracking of ``move`` by a car at ``pose`` (slot's frame) that was at ``way`` before."""
    direction = float(move.direction)
    for _ in range(2):
        at = point_at(move, way).pose
        way += direction * ((pose.x - at.x) * math.cos(at.heading) + (pose.y - at.y) * math.sin(at.heading))
    point = point_at(move, way)
    at = point.pose
    e = (pose.y - at.y) * math.cos(at.heading) - (pose.x - at.x) * math.sin(at.heading)
    turned = clamp(wrap_angle(pose.heading - at.heading), -STEEPEST, STEEPEST)
    c = math.cos(turned)
    angle = math.atan(wheelbase * c * c * c * (point.curvature - k1 * e - direction * k2 * math.tan(turned)))
    return Tracked(way, point.left, to_standstill(move, way), at, e, turned, angle, point.slope)


def to_standstill(move: Move, way: float) -> float:
    """Return the way [m] to the next jump of curvature, or to the end; one within 4 mm counts as passed."""
    along = 0.0
    last = 0.0
    begun = False
    for piece in move.pieces:
        if piece.length > 0.0:
            if begun and abs(piece.k0 - last) > JUMP and along > way + PASSED:
                return along - way
            along += piece.length
            last = piece.k1
            begun = True
    return along - way


def set_wheel(move: Move, way: float, wheelbase: float) -> float:
    """Return the front-wheel angle [rad] to set at standstill before driving on from ``way``."""
    ahead = way + 1.5 * PASSED if way + 1.5 * PASSED < length_of(move) else way
    return math.atan(wheelbase * point_at(move, ahead if ahead > 0.0 else 0.0).curvature)
