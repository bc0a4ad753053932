"""The planner with the slot: several attempts, each checked for curvature and for the neighbours, or a refusal.

First the paper's way: quintics through the ends of arc, line, arc of equal radii (``path.plan``). Where that path is
too tight or touches a neighbour, quintics x(t), y(t) over a final time are searched on a grid of their speeds and
accelerations at both ends; the clear path of least curvature is refined until it keeps the limits of curvature and
steering rate. Where that fails, two quintics y(x) are searched over the place where they meet and the heading there.
"""

import math
from typing import NamedTuple

from controller_fmu.common.slot_clearance import is_pose_clear
from controller_fmu.zhang2022.path import (
    CURVATURE_WITHOUT_PATH,
    EMPTY,
    EndConditions,
    PathStatus,
    QuinticPath,
    join_quintics,
    largest_curvature,
    length_of,
    over_time,
    plan,
)
from controller_fmu.zhang2022.quintic import quintic
from controller_fmu.zhang2022.refinement import PathLimits, is_within, refine
from controller_fmu.zhang2022.slot import is_path_clear
from modelkit.vocabulary import Pose

END_SPEED_COUNT = 6
"""Speeds tried at start and target each."""
LOWEST, SPEED_STEP = 0.25, 0.12
"""The lowest and the step, as shares of the distance over the final time: with more the wheel would have to swing."""
END_ACCELERATION_COUNT = 5
"""Accelerations tried at both ends each, from none."""
ACCELERATION_STEP = 3.0
"""In the same measure."""
MEETING_POINTS = 13
"""Meeting points tried in each direction."""
HEADING_CANDIDATES = 13
"""Headings tried at each."""
NEAREST, FARTHEST = 0.2, 0.7
"""Meeting points tried, as shares of the way from the target to the start, along and across."""
FLATTEST, STEEPEST_SHARE = 1.0, 2.4
"""Headings tried, as multiples of the angle at which the target sees the start."""


class Searched(NamedTuple):
    """The best clear path, if there is one, and whether a path within the curvature limit touches a neighbour."""

    path: QuinticPath
    blocked: bool


def plan_in_slot(start: Pose, radius: float, limits: PathLimits) -> QuinticPath:
    """Return the path from ``start`` (slot frame) to the origin clear of the neighbours, or why there is none."""
    path = _choose_path(start, radius, limits)
    return path._replace(length=length_of(path)) if path.status == PathStatus.FOUND else path


def _choose_path(start: Pose, radius: float, limits: PathLimits) -> QuinticPath:
    car = limits.car
    slot = limits.slot
    path = plan(start, radius, limits.curvature)
    if not slot.known or path.status == PathStatus.BAD_START:
        return path
    if path.status == PathStatus.FOUND and is_path_clear(path, car, slot):
        return path
    if not is_pose_clear(start, car, slot) or not is_pose_clear(Pose(), car, slot):
        return QuinticPath(PathStatus.SLOT_BLOCKED, start, EMPTY, path.largest_curvature)
    found = _over_time(start, limits)
    over_time_path = refine(found.path, limits)
    if is_within(over_time_path, limits):
        return over_time_path
    met = _search_joint(start, limits)
    if is_within(met.path, limits):
        return met.path
    blocked = path.status == PathStatus.FOUND or found.blocked or met.blocked
    status = PathStatus.SLOT_BLOCKED if blocked else PathStatus.CURVATURE_LIMIT
    return QuinticPath(status, start, EMPTY, path.largest_curvature)


def _over_time(start: Pose, limits: PathLimits) -> Searched:
    """Return the clear path of least curvature among quintics over time, within the curvature limit or not."""
    distance = math.sqrt(start.x * start.x + start.y * start.y)
    best = QuinticPath(PathStatus.CURVATURE_LIMIT, start, EMPTY, CURVATURE_WITHOUT_PATH)
    blocked = False
    for first in range(END_SPEED_COUNT):
        for last in range(END_SPEED_COUNT):
            for gaining in range(END_ACCELERATION_COUNT):
                for slowing in range(END_ACCELERATION_COUNT):
                    ends = EndConditions(
                        (LOWEST + SPEED_STEP * first) * distance,
                        ACCELERATION_STEP * gaining * distance,
                        (LOWEST + SPEED_STEP * last) * distance,
                        ACCELERATION_STEP * slowing * distance,
                    )
                    path = over_time(start, ends)
                    if path.status == PathStatus.FOUND and path.largest_curvature < best.largest_curvature:
                        if is_path_clear(path, limits.car, limits.slot):
                            best = path
                        elif path.largest_curvature <= limits.curvature:
                            blocked = True
    return Searched(best, blocked)


def _search_joint(start: Pose, limits: PathLimits) -> Searched:
    """Return the clear path of least curvature of two quintics that meet, within the curvature limit."""
    seen = math.atan2(start.y, start.x)
    best = QuinticPath(PathStatus.CURVATURE_LIMIT, start, EMPTY, limits.curvature)
    blocked = False
    for along in range(MEETING_POINTS):
        x = start.x * (NEAREST + (FARTHEST - NEAREST) * along / (MEETING_POINTS - 1.0))
        for across in range(MEETING_POINTS):
            y = start.y * (NEAREST + (FARTHEST - NEAREST) * across / (MEETING_POINTS - 1.0))
            for number in range(HEADING_CANDIDATES):
                heading = seen * (FLATTEST + (STEEPEST_SHARE - FLATTEST) * number / (HEADING_CANDIDATES - 1.0))
                slope = math.tan(heading)
                if largest_curvature(quintic(0.0, 0.0, 0.0, x, y, slope)) <= best.largest_curvature:
                    path = join_quintics(start, x, y, slope)
                    if path.largest_curvature <= best.largest_curvature:
                        if is_path_clear(path, limits.car, limits.slot):
                            best = path
                        else:
                            blocked = True
    return Searched(best, blocked)
