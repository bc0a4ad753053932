"""The collision monitor: the outline swept over the stopping distance against the map, and unexplained echoes.

It knows nothing of the plan but the steering angle and the direction in hand. It limits the speed so that the vehicle
can always stop before what it may not touch; where it cannot move at all it reports ``is_blocked``.
"""

import math
from typing import NamedTuple

from controller_fmu.parking.geometry.outline import (
    OutlineFrame,
    VehicleOutline,
    frame_along_arc,
    max_point_speed_ratio,
    outline_frame,
)
from controller_fmu.parking.geometry.outline_distance import edge_distance_squared, overlap_ahead
from controller_fmu.parking.map.landmark import Landmark, end_point, start_point
from controller_fmu.parking.map.local_map import is_confirmed
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.measurement.predicted_range import EchoSurface
from controller_fmu.parking.monitor.params import MonitorParams
from modelkit.geometry import Point
from modelkit.vocabulary import Pose

MAX_POSES = 8
"""Poses of the swept outline: over half a metre they are 6 cm apart; what is free up to the last free one counts."""
LOOK_AHEAD = 0.4
"""The outline is swept this far [m] beyond the stopping distance, so that the speed falls smoothly."""
SLOWING_FRACTION = 0.5
"""Of the brake's deceleration: the other half is left for a vehicle that follows the limit late."""
NO_LIMIT = 100.0
"""Speed [m/s] or distance [m] that is not limited."""
MIN_APPROACH = 0.005
"""The vehicle may leave what it stands beside, if it comes nearer by at most this [m] until it stands again."""
MIN_RESTART_DISTANCE = 0.1
"""A standing vehicle sets out only where it may go at least this far [m]."""
MAX_RATE_TIME = 2.0
"""An object's approach is foreseen for at most this long [s]."""


class EchoObstacle(NamedTuple):
    """An echo: its point, on the sensor's axis where it is unexplained, and how fast it approaches [m/s]."""

    x: float = 0.0
    y: float = 0.0
    closing_speed: float = 0.0
    is_present: bool = False
    is_unexplained: bool = False
    """Else it is what the map predicts, but where it is measured."""
    ux: float = 1.0
    """Unit vector from the sensor to it."""
    uy: float = 0.0
    range: float = 0.0
    """Its distance from the sensor [m]."""
    surface: EchoSurface = EchoSurface()
    """The side that it is of, where that is known."""


class VehicleMotion(NamedTuple):
    """How the vehicle moves: pose, direction (1, -1), speed >= 0, curvature, and how it brakes; SI units."""

    pose: Pose
    direction: float
    speed: float
    curvature: float
    remaining: float
    """Distance to the next planned stop."""
    delay: float
    deceleration: float
    stand: Pose = Pose()
    """Where it stood before it set out in this direction."""


class OutlineSweep(NamedTuple):
    """The outline along the next ``horizon`` [m]."""

    horizon: float
    poses: tuple[OutlineFrame, ...] = (OutlineFrame(),) * MAX_POSES
    """At horizon / POSES, twice that and so on."""
    outline: VehicleOutline = VehicleOutline()
    here: OutlineFrame = OutlineFrame()
    """Where it is now."""
    stand: OutlineFrame = OutlineFrame()
    """Where it stood."""
    reach: float = 0.0
    """No point of it moves farther [m]."""


class MonitorVerdict(NamedTuple):
    """What the monitor allows."""

    speed_limit: float = NO_LIMIT
    is_blocked: bool = False
    free_distance: float = NO_LIMIT
    """[m]"""
    is_mapped: bool = False
    """It is the map that limits it: waiting does not help."""


def monitor_collision(
    motion: VehicleMotion,
    outline: VehicleOutline,
    landmarks: tuple[Landmark, ...],
    echoes: tuple[EchoObstacle, ...],
    params: MonitorParams,
    mapping: MappingParams,
) -> MonitorVerdict:
    """Return the speed limit for the motion in hand, by the distance that is free for it."""
    stop = stopping_distance(motion.speed, motion.delay, motion.deceleration)
    horizon = min(stop + LOOK_AHEAD, max(motion.remaining, stop + MIN_APPROACH))
    free = NO_LIMIT
    by_map = NO_LIMIT
    if horizon > 0.0:
        here = outline_frame(motion.pose)
        part = motion.direction * horizon / MAX_POSES
        poses = tuple(
            frame_along_arc(here, motion.pose.heading, part * (step + 1), motion.curvature) for step in range(MAX_POSES)
        )
        reach = horizon * max_point_speed_ratio(outline, motion.curvature)
        sweep = OutlineSweep(horizon, poses, outline, here, outline_frame(motion.stand), reach)
        for landmark in landmarks:
            if is_confirmed(landmark, mapping):
                a = start_point(landmark)
                by_map = min(by_map, free_towards(motion, sweep, a, end_point(landmark), params.map_distance, 0.0))
        by_echoes = min(free_by_echo(motion, sweep, echo, False, params) for echo in echoes)
        by_map = min(by_map, by_echoes)
        free = min(by_map, min(free_by_echo(motion, sweep, echo, True, params) for echo in echoes))
    slowing = SLOWING_FRACTION * motion.deceleration
    limit = NO_LIMIT if free >= NO_LIMIT else speed_for_distance(free, motion.delay, slowing)
    least = MIN_RESTART_DISTANCE if motion.speed <= 0.0 else stop
    return MonitorVerdict(limit, free < NO_LIMIT and free <= min(least, motion.remaining), free, by_map <= free)


def free_by_echo(
    motion: VehicleMotion, sweep: OutlineSweep, echo: EchoObstacle, unexplained: bool, params: MonitorParams
) -> float:
    """Return how far [m] the outline goes before it comes too near to an echo that is ``unexplained``, or not.

    An unexplained one may approach by itself. A side that overlaps the vehicle is not there: then only the point that
    the echo came from counts.
    """
    if not echo.is_present or echo.is_unexplained != unexplained:
        return NO_LIMIT
    inside = line_distance(side_start(echo), side_end(echo), sweep.here, sweep.outline) <= 0.0
    start = Point(echo.x, echo.y) if inside else side_start(echo)
    end = Point(echo.x, echo.y) if inside else side_end(echo)
    kept = params.echo_distance if unexplained else params.map_distance
    return free_towards(motion, sweep, start, end, kept, echo.closing_speed if unexplained else 0.0)


def free_towards(
    motion: VehicleMotion, sweep: OutlineSweep, a: Point, b: Point, kept: float, closing_speed: float
) -> float:
    """Return how far [m] the outline goes before it is nearer than ``kept`` [m] to the line a-b, as that approaches.

    The vehicle may leave what it stands beside, but come no nearer: what it may at each sample it must not at all. What
    overlaps it is left by driving away from the half of the vehicle that it is in.
    """
    here = line_distance(a, b, sweep.here, sweep.outline)
    if here <= 0.0:
        start = in_outline(a, sweep.here, sweep.outline)
        ahead = overlap_ahead(start, in_outline(b, sweep.here, sweep.outline), sweep.outline)
        return 0.0 if motion.direction * ahead > 0.0 else NO_LIMIT
    if here - sweep.reach >= kept + closing_speed * (motion.delay + MAX_RATE_TIME):
        return NO_LIMIT
    least = kept
    if closing_speed <= 0.0:
        stood = max(line_distance(a, b, sweep.stand, sweep.outline), 2.0 * MIN_APPROACH)
        least = min(kept, min(here, stood - MIN_APPROACH))
    for step in range(1, MAX_POSES + 1):
        travelled = sweep.horizon * step / MAX_POSES
        time = motion.delay + min(MAX_RATE_TIME, 2.0 * travelled / max(motion.speed, MIN_APPROACH))
        if line_distance(a, b, sweep.poses[step - 1], sweep.outline) < least + closing_speed * time:
            return sweep.horizon * (step - 1) / MAX_POSES
    return NO_LIMIT


def side_start(echo: EchoObstacle) -> Point:
    """Return where the side of an echo begins; of a point, that point."""
    side = echo.surface
    return Point(echo.x + side.low * side.along_x, echo.y + side.low * side.along_y)


def side_end(echo: EchoObstacle) -> Point:
    """Return where the side of an echo ends."""
    side = echo.surface
    return Point(echo.x + side.high * side.along_x, echo.y + side.high * side.along_y)


def landmark_distance(landmark: Landmark, pose: Pose, outline: VehicleOutline) -> float:
    """Return the distance [m] from the outline of a vehicle at ``pose`` to a landmark, at most ``NO_LIMIT``."""
    return line_distance(start_point(landmark), end_point(landmark), outline_frame(pose), outline)


def line_distance(a: Point, b: Point, frame: OutlineFrame, outline: VehicleOutline) -> float:
    """Return the distance [m] from the outline of a vehicle at ``frame`` to the segment a-b, at most ``NO_LIMIT``."""
    start = in_outline(a, frame, outline)
    end = in_outline(b, frame, outline)
    return math.sqrt(edge_distance_squared(start.x, start.y, end.x, end.y, outline, NO_LIMIT * NO_LIMIT))


def in_outline(point: Point, frame: OutlineFrame, outline: VehicleOutline) -> Point:
    """Return a point [m] relative to the centre of the outline of a vehicle at ``frame``: x ahead, y to the left."""
    dx = point.x - (frame.x + outline.centre_ahead * frame.cos)
    dy = point.y - (frame.y + outline.centre_ahead * frame.sin)
    return Point(dx * frame.cos + dy * frame.sin, dy * frame.cos - dx * frame.sin)


def stopping_distance(speed: float, delay: float, deceleration: float) -> float:
    """Return the distance [m] in which a vehicle at ``speed`` [m/s] >= 0 stops; delay [s], deceleration [m/s2] > 0."""
    return speed * delay + 0.5 * speed * speed / deceleration


def speed_for_distance(distance: float, delay: float, deceleration: float) -> float:
    """Return the largest speed [m/s] from which a vehicle stops within ``distance`` f [m]; 0 for none.

    It is the root v = b (sqrt(d2 + 2 f / b) - d) of v d + v2 / 2 b = f with delay d [s] and deceleration b [m/s2].
    """
    if distance <= 0.0:
        return 0.0
    return max(0.0, deceleration * (math.sqrt(delay * delay + 2.0 * distance / deceleration) - delay))
