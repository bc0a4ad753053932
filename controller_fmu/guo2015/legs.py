"""The ways to drive: the path and the four points Q1 to Q4, each with its steering law.

Q1 is where the second arc begins, Q2 lies ahead of it on the tangent, Q3 is the target, Q4 lies
straight ahead of it (Guo 2015, Fig. 9, Table 2): all from the geometry of the path.
"""

from typing import NamedTuple

from controller_fmu.guo2015.params import GuoParams, GuoSystemParams
from controller_fmu.guo2015.path import Reference, reference_at
from controller_fmu.guo2015.path_tracking import path_tracking_angle
from controller_fmu.guo2015.phases import GuoPhase
from controller_fmu.guo2015.planner import TwoArcPath, ahead
from controller_fmu.guo2015.point_tracking import point_error, point_tracking_angle
from modelkit.vocabulary import Pose


class Tracking(NamedTuple):
    """Where the car should be, how far it is off, and the angle that leads it there."""

    reference: Reference = Reference()
    """Of a point its pose, with no curvature, and the piece that the path is latched at."""
    ahead: float = 0.0
    """The car lies this far [m] ahead of the point tracked, along the point's heading."""
    lateral_error: float = 0.0
    heading_error: float = 0.0
    front_wheel_angle: float = 0.0


def track(leg: int, pose: Pose, path: TwoArcPath, piece: int, params: GuoSystemParams) -> Tracking:
    """Return what ``leg`` asks of a car at ``pose`` (slot's frame), the path latched at ``piece``."""
    gains = params.guo2015
    if leg == GuoPhase.PATH_TRACKING:
        reference = reference_at(path, pose.x, piece)
        angle = path_tracking_angle(pose, reference, gains.k1, gains.k2, params.car.wheelbase)
        return Tracking(reference, 0.0, pose.y - reference.y, pose.heading - reference.heading, angle)
    point = point_of_leg(leg, path, gains)
    error = point_error(pose, point)
    direction = 1.0 if leg in (GuoPhase.TO_Q2, GuoPhase.TO_Q4) else -1.0
    angle = point_tracking_angle(error, direction, gains.k3, gains.k4, params.car.wheelbase)
    return Tracking(Reference(point.x, point.y, point.heading, 0.0, piece), error.x, error.y, error.heading, angle)


def point_of_leg(leg: int, path: TwoArcPath, params: GuoParams) -> Pose:
    """Return the point that ``leg`` tracks, in the slot's frame; Q3 for the path itself."""
    if leg == GuoPhase.TO_Q2:
        return ahead(path.tangent2, params.q2_distance)
    if leg == GuoPhase.TO_Q1:
        return path.tangent2
    if leg == GuoPhase.TO_Q4:
        return Pose(params.q4_distance, 0.0, 0.0)
    return Pose(0.0, 0.0, 0.0)
