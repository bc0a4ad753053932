"""The guards of the manoeuvre chart, worked out from the pose, the wheel and the speed."""

from controller_fmu.common.chart import bit
from controller_fmu.guo2015.chart import Guard
from controller_fmu.guo2015.legs import Tracking, point_of_leg
from controller_fmu.guo2015.params import GuoSystem, GuoSystemParams
from controller_fmu.guo2015.path import distance_to_end
from controller_fmu.guo2015.phases import GuoPhase
from controller_fmu.guo2015.planner import TwoArcPath
from controller_fmu.guo2015.prompts import stopping_distance
from controller_fmu.interface import ParkingInput
from modelkit.vocabulary import Pose


def within(lateral: float, heading: float, lateral_limit: float, heading_limit: float) -> bool:
    """Return whether both errors are within their limits."""
    return abs(lateral) <= lateral_limit and abs(heading) <= heading_limit


def wheel_guards(leg: int, wheel: float, request: float, tolerance: float) -> int:
    """Return the bits that say the wheel stands at ``request`` for its leg, or straight."""
    there = abs(wheel - request) <= tolerance
    return (
        bit(Guard.WHEEL_SET_FOR_PATH, there and leg == GuoPhase.PATH_TRACKING)
        | bit(Guard.WHEEL_SET_FOR_Q2, there and leg == GuoPhase.TO_Q2)
        | bit(Guard.WHEEL_SET_FOR_Q1, there and leg == GuoPhase.TO_Q1)
        | bit(Guard.WHEEL_SET_FOR_Q4, there and leg == GuoPhase.TO_Q4)
        | bit(Guard.WHEEL_SET_FOR_Q3, there and leg == GuoPhase.TO_Q3)
        | bit(Guard.WHEEL_STRAIGHT, abs(wheel) <= tolerance)
    )


def way_guards(
    leg: int, tracking: Tracking, pose: Pose, path: TwoArcPath, speed: float, params: GuoSystemParams
) -> int:
    """Return the bits that say the car left the path or reached the end of its leg."""
    limit = params.guo2015.threshold
    points = params.system == GuoSystem.NTBPTCWPT
    left = not within(tracking.lateral_error, tracking.heading_error, limit.leave_lateral, limit.leave_heading)
    q2 = point_of_leg(GuoPhase.TO_Q2, path, params.guo2015)
    at_q1 = tracking.ahead <= 0.0
    resumed = within(tracking.lateral_error, tracking.heading_error, limit.resume_lateral, limit.resume_heading)
    share = limit.moving_share
    right = within(pose.y, pose.heading, share * limit.park_lateral, share * limit.park_heading)
    stop = stopping_distance(speed, params.guo2015.prompting)
    at_end = leg == GuoPhase.PATH_TRACKING and distance_to_end(path, tracking.reference) <= stop
    return (
        bit(Guard.OFF_PATH, points and left)
        | bit(Guard.PATH_END, at_end)
        | bit(Guard.PAST_Q2, pose.x > q2.x or pose.y > q2.y)
        | bit(Guard.AT_Q1_RIGHT, at_q1 and resumed)
        | bit(Guard.AT_Q1_WRONG, at_q1 and not resumed)
        | bit(Guard.POSE_RIGHT, right)
        | bit(Guard.PAST_Q4, pose.x > params.guo2015.q4_distance)
        | bit(Guard.AT_Q3, pose.x <= stop)
    )


def standing_guards(leg: int, pose: Pose, inputs: ParkingInput, params: GuoSystemParams) -> int:
    """Return the bits that say the car stands and what it stands for."""
    limit = params.guo2015.threshold
    if abs(inputs.measured_speed) > params.threshold.standstill:
        return 0
    at_end = leg == GuoPhase.STRAIGHTEN
    wrong = params.system == GuoSystem.NTBPTCWPT and not within(
        pose.y, pose.heading, limit.park_lateral, limit.park_heading
    )
    ahead = params.system == GuoSystem.NTBPTCWPT and pose.x > limit.park_longitudinal
    return (
        bit(Guard.STANDING_TO_DRIVE, not at_end)
        | bit(Guard.STANDING_AHEAD, at_end and not wrong and ahead)
        | bit(Guard.STANDING_AT_END, at_end and not wrong and not ahead)
        | bit(Guard.STANDING_AT_END_WRONG, at_end and wrong)
    )
