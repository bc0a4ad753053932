"""Path tracking: progress along the path, steering back to it, and the speed profile before a stop.

With e the lateral error (left positive) and h the heading error against the path of curvature k, the law

    phi = atan( L cos3(h) [ k - k1 e - d k2 tan(h) ] )     d: direction, 1 forward, -1 in reverse

makes e'' = -k1 e - k2 e' over the distance driven, in both directions (Guo 2015, eq. (6), both signs corrected, in the
frame of the path's tangent).
"""

import math
from typing import NamedTuple

from controller_fmu.common.path_law import TrackingError, angle_back, deviation
from controller_fmu.parking.following.params import FollowingContext
from controller_fmu.parking.following.rolling_steering import (
    UpcomingStop,
    reference_at,
    steers_for_next,
    transition_after,
    upcoming_stop,
)
from controller_fmu.parking.geometry.outline import pose_along_arc
from controller_fmu.parking.planning.planner import PlannedPath
from modelkit.car import largest_curvature
from modelkit.maths import clamp, sign
from modelkit.vocabulary import Pose

MIN_REMAINING = 0.03
"""A rest [m] of a segment that is not worth driving: the vehicle's stopping errs by as much."""
DELAY_LEARNING_TIME = 0.5
"""Time constant [s] with which the delay of the speed is learnt: a third of a stop from top speed."""
MAX_SPEED_DELAY = 0.4
"""[s]: lags of drive and brake of 0.3 s, and a sample of both measurement and request."""
RECOVERY_DISTANCE = 0.5
"""Distance [m] over which a lateral error inside a bend is taken back by what the steering has left."""
FOOT_ITERATIONS = 2
"""Newton steps to the foot of the vehicle on the path; the second changes it by under 1 mm."""


class PathProgress(NamedTuple):
    """A path being driven."""

    path: PlannedPath = PlannedPath()
    segment: int = 0
    """The one in hand."""
    begin: Pose = Pose()
    """Where it begins."""
    stand: Pose = Pose()
    """Where the vehicle stood before it set out on it, or on the segments of the same gear before it."""
    remaining: float = 0.0
    """Of it [m]."""
    reference: Pose = Pose()
    """The point of the path beside the vehicle."""
    lateral_error: float = 0.0
    heading_error: float = 0.0
    front_wheel_angle: float = 0.0
    """That leads back to the path [rad]."""
    upcoming: UpcomingStop = UpcomingStop()
    speed_delay: float = 0.0
    """The speed was found to follow its request so much [s] later while the vehicle slows down."""
    direction: float = 0.0
    """Last driven; 0: not yet."""
    manoeuvres: int = 0


class SpeedTracking(NamedTuple):
    """Speed as measured, and as last requested, both >= 0 [m/s], and by how much [s] it is delayed."""

    measured: float = 0.0
    requested: float = 0.0
    delay: float = 0.0


def begin_path(before: PathProgress, path: PlannedPath, start: Pose, context: FollowingContext) -> PathProgress:
    """Return the progress on a new ``path`` from ``start``; the count of manoeuvres goes on."""
    remaining = abs(path.segments[0].distance)
    upcoming = upcoming_stop(path, 0, remaining, context)
    kept = PathProgress(speed_delay=before.speed_delay, direction=before.direction, manoeuvres=before.manoeuvres)
    return kept._replace(path=path, begin=start, stand=start, remaining=remaining, reference=start, upcoming=upcoming)


def track_path(progress: PathProgress, pose: Pose, speed: float, context: FollowingContext) -> PathProgress:
    """Return the progress of a vehicle at ``pose`` and ``speed`` [m/s], with the steering back to the path."""
    if progress.remaining <= 0.0 and transition_after(progress.path, progress.segment, context).transition > 0.0:
        progress = _roll_to_next(progress)
    segment = progress.path.segments[progress.segment]
    direction = sign(segment.distance)
    at = _point_before_end(progress, progress.remaining)
    remaining = progress.remaining
    for _ in range(FOOT_ITERATIONS):
        ahead = (pose.x - at.x) * math.cos(at.heading) + (pose.y - at.y) * math.sin(at.heading)
        remaining = remaining - direction * ahead
        at = _point_before_end(progress, remaining)
    error = deviation(pose, at)
    law = context.drive
    soon = remaining - abs(speed) * law.steering_delay
    here = reference_at(progress.path, progress.segment, remaining, context)
    curvature = reference_at(progress.path, progress.segment, soon, context).curvature
    lateral = _recoverable(error.lateral - here.lateral, curvature, context)
    off = TrackingError(lateral, error.heading - here.heading)
    angle = angle_back(off, curvature, direction, law.k1, law.k2, context.car.wheelbase)
    upcoming = upcoming_stop(progress.path, progress.segment, remaining, context)
    if steers_for_next(upcoming, context):
        angle = math.atan(context.car.wheelbase * upcoming.standstill.next_curvature)
    progress = progress._replace(remaining=remaining, reference=at, front_wheel_angle=angle, upcoming=upcoming)
    return progress._replace(lateral_error=error.lateral, heading_error=error.heading)


def next_segment(progress: PathProgress, pose: Pose, context: FollowingContext) -> PathProgress:
    """Return the progress of a vehicle that stands at ``pose``: on the segment in hand, if driven on the next."""
    if progress.remaining > MIN_REMAINING:
        return progress
    after = _roll_to_next(progress._replace(remaining=0.0))
    upcoming = upcoming_stop(after.path, after.segment, after.remaining, context)
    return after._replace(stand=pose, reference=after.begin, upcoming=upcoming)


def set_out(progress: PathProgress) -> PathProgress:
    """Return the progress of a vehicle that begins to drive; a change of direction counts a manoeuvre."""
    direction = sign(progress.path.segments[progress.segment].distance)
    manoeuvres = progress.manoeuvres
    if direction != progress.direction and (manoeuvres > 0 or direction < 0.0):
        manoeuvres = manoeuvres + 1
    return progress._replace(direction=direction, manoeuvres=manoeuvres)


def is_at_end(progress: PathProgress) -> bool:
    """Return whether the last segment is driven."""
    return progress.remaining <= MIN_REMAINING and progress.segment + 1 >= progress.path.used


def profile_speed(progress: PathProgress, speed: SpeedTracking, limit: float, context: FollowingContext) -> float:
    """Return the speed [m/s] to request, at most ``limit`` but never below the creep speed."""
    slowing = stopping_speed(progress, speed, context)
    return max(context.drive.creep_speed, min(progress.upcoming.speed, min(slowing, limit)))


def stopping_speed(progress: PathProgress, speed: SpeedTracking, context: FollowingContext) -> float:
    """Return the speed [m/s] to request of a vehicle that slows down to the creep speed at the next stop.

    It is that of a constant deceleration where the speed will have come down to what is requested now.
    """
    law = context.drive
    delayed = 0.5 * speed.delay * (speed.measured + min(speed.requested, speed.measured))
    left = max(0.0, progress.upcoming.left - delayed)
    return math.sqrt(law.creep_speed * law.creep_speed + 2.0 * law.deceleration * left)


def must_stop(progress: PathProgress, speed: SpeedTracking, context: FollowingContext) -> bool:
    """Return whether the vehicle has to come to rest now, to stand where the next stop is planned.

    Behind a lag of first order it goes on by the speed times the lag, whatever is requested until then.
    """
    now = min(speed.requested, speed.measured)
    needed = speed.delay * speed.measured + 0.5 * now * now / context.drive.brake_deceleration
    return progress.upcoming.left <= needed


def learn_speed_delay(
    progress: PathProgress, speed: SpeedTracking, dt: float, context: FollowingContext
) -> PathProgress:
    """Return the progress ``dt`` [s] later: how far the speed is above its request while both fall before a stop."""
    law = context.drive
    slowing = stopping_speed(progress, speed, context)
    slows = law.creep_speed < slowing <= speed.requested < speed.measured
    if not slows or slowing > progress.upcoming.speed:
        return progress
    delay = min((speed.measured - speed.requested) / law.deceleration, MAX_SPEED_DELAY)
    share = min(dt / DELAY_LEARNING_TIME, 1.0)
    return progress._replace(speed_delay=progress.speed_delay + share * (delay - progress.speed_delay))


def _point_before_end(progress: PathProgress, remaining: float) -> Pose:
    segment = progress.path.segments[progress.segment]
    driven = sign(segment.distance) * (abs(segment.distance) - remaining)
    return pose_along_arc(progress.begin, driven, segment.curvature)


def _roll_to_next(progress: PathProgress) -> PathProgress:
    """Return the progress on the next segment, reached without a stop."""
    segment = progress.path.segments[progress.segment]
    begin = pose_along_arc(progress.begin, segment.distance, segment.curvature)
    remaining = progress.remaining + abs(progress.path.segments[progress.segment + 1].distance)
    return progress._replace(segment=progress.segment + 1, begin=begin, remaining=remaining)


def _recoverable(lateral: float, curvature: float, context: FollowingContext) -> float:
    """Return as much of the lateral error [m] as the vehicle can take back and be in the path's direction again.

    Inside a bend at full lock it can steer out but hardly in again.
    """
    law = context.drive
    spare = largest_curvature(context.car) - sign(lateral) * curvature
    most = max(0.0, spare) * RECOVERY_DISTANCE * law.k2 / law.k1 if law.k1 > 0.0 else 0.0
    return clamp(lateral, -most, most)
