"""Descent from a clear path to one within the limits of curvature and steering rate, by moving its joints."""

from typing import NamedTuple

from controller_fmu.common.slot_clearance import Outline, SlotBounds
from controller_fmu.zhang2022.path import Joints, PathStatus, QuinticPath, joints_of, through_joints
from controller_fmu.zhang2022.quintic import Knot
from controller_fmu.zhang2022.slot import is_path_clear
from controller_fmu.zhang2022.steering_rate import PlannedMotion, largest_wheel_rate

MAX_ROUNDS = 40
COORDINATE_COUNT = 8
"""Position, slope and bend of both joints."""
STEP_X, STEP_Y, STEP_SLOPE, STEP_BEND = 0.3, 0.15, 0.1, 0.05
"""First steps [m, m, 1, 1/m]; halved when no coordinate helps any more."""
MIN_STEP_SHARE = 0.05
"""Smallest share of these steps."""
LEAST_GAIN = 1e-4
"""A step that gains less is not taken."""


class PathLimits(NamedTuple):
    """What a planned path keeps."""

    curvature: float
    """[1/m]."""
    motion: PlannedMotion
    car: Outline
    slot: SlotBounds


class Refined(NamedTuple):
    """The path so far, how far it is beyond its limits, and the share of the first steps."""

    path: QuinticPath
    excess: float
    share: float


def excess(path: QuinticPath, limits: PathLimits) -> float:
    """Return the larger of curvature and front-wheel rate, as shares of their limits."""
    return max(
        path.largest_curvature / limits.curvature, largest_wheel_rate(path, limits.motion) / limits.motion.rate_limit
    )


def is_within(path: QuinticPath, limits: PathLimits) -> bool:
    """Return whether there is a path that keeps the limits of curvature and steering rate."""
    return path.status == PathStatus.FOUND and excess(path, limits) <= 1.0


def refine(path: QuinticPath, limits: PathLimits) -> QuinticPath:
    """Return the path, or a clear one nearer to the limits; it ends as soon as both are kept."""
    if path.status != PathStatus.FOUND:
        return path
    now = Refined(path, excess(path, limits), 1.0)
    for _ in range(MAX_ROUNDS):
        if now.excess > 1.0 and now.share > MIN_STEP_SHARE:
            now = _one_round(now, limits)
    return now.path


def _one_round(now: Refined, limits: PathLimits) -> Refined:
    """Return what remains after each coordinate of the joints was moved to both sides once."""
    best = now
    for number in range(COORDINATE_COUNT):
        for side in (1.0, -1.0):
            if best.excess > 1.0:
                joints = move_joint(joints_of(best.path), number, side * now.share)
                path = through_joints(now.path.start, joints)
                if path.status == PathStatus.FOUND and path.largest_curvature < best.excess * limits.curvature:
                    found = excess(path, limits)
                    if found < best.excess - LEAST_GAIN and is_path_clear(path, limits.car, limits.slot):
                        best = Refined(path, found, now.share)
    if best.excess < now.excess:
        return best
    return now._replace(share=0.5 * now.share)


def move_joint(joints: Joints, number: int, share: float) -> Joints:
    """Return the joints with the so many-th coordinate moved by a share of its first step."""
    if number < 4:
        return joints._replace(upper=_move_knot(joints.upper, number, share))
    return joints._replace(lower=_move_knot(joints.lower, number - 4, share))


def _move_knot(knot: Knot, number: int, share: float) -> Knot:
    if number == 0:
        return knot._replace(x=knot.x + share * STEP_X)
    if number == 1:
        return knot._replace(y=knot.y + share * STEP_Y)
    if number == 2:
        return knot._replace(slope=knot.slope + share * STEP_SLOPE)
    return knot._replace(bend=knot.bend + share * STEP_BEND)
