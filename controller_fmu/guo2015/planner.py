"""The path: two tangent arcs of one radius with a straight line between (Guo 2015, eq. (9)).

In the slot's frame (target at the origin, heading 0) the car reverses from (x0, y0, h0): right
arc around C1 = (x0 + R sin h0, y0 - R cos h0), line of length l, left arc around C2 = (0, R).
With D = C1 - C2 and the tangent's heading h1, D is (l, -2R) turned by h1, hence

    l = sqrt(|D|^2 - 4 R^2)      h1 = atan2(Dy, Dx) - atan2(-2R, l)

Where |D| < 2R the wished radius leaves no room; the largest radius that does makes the arcs
touch: R^2 (2 cos h0 - 2) + R (2 x0 sin h0 - 2 y0 (1 + cos h0)) + x0^2 + y0^2 = 0.
"""

import math
from typing import NamedTuple

from controller_fmu.common.slot_frame import SlotFrame, to_slot
from controller_fmu.guo2015.smooth_path import Curve, PathShape, curve
from modelkit.vocabulary import Pose

HALF_PI = 0.5 * math.pi
MAX_TANGENT_HEADING = 85.0 * math.pi / 180.0
"""Largest heading of the tangent; the laws need |heading| < pi / 2."""


class TwoArcPath(NamedTuple):
    """The path in the slot's frame."""

    found: bool = False
    radius: float = 1.0
    start: Pose = Pose()
    tangent1: Pose = Pose()
    """End of the first arc, start of the line."""
    tangent2: Pose = Pose()
    """End of the line, start of the second arc: Q1."""
    curve: Curve = Curve()
    """The path where it is not two arcs; the points above are then its inflection."""


NO_PATH = TwoArcPath()


class Plan(NamedTuple):
    """A path and the frame that it is given in."""

    frame: SlotFrame = SlotFrame()
    path: TwoArcPath = TwoArcPath()


def plan(
    start: Pose, target: Pose, largest_radius: float, smallest_radius: float, shape: int = 0, wheelbase: float = 1.0
) -> Plan:
    """Return the plan from ``start`` to ``target`` (world poses); ``path.found`` tells if there is one.

    The side of the slot is that of the target seen from the start; the other side is tried when
    that fails, as a start with a heading may need it.
    """
    right = SlotFrame(target, 1.0)
    side = 1.0 if to_slot(start, right).y >= 0.0 else -1.0
    frame = SlotFrame(target, side)
    path = path_from(to_slot(start, frame), largest_radius, smallest_radius, shape, wheelbase)
    if not path.found:
        other = SlotFrame(target, -side)
        other_path = path_from(to_slot(start, other), largest_radius, smallest_radius, shape, wheelbase)
        if other_path.found:
            return Plan(other, other_path)
    return Plan(frame, path)


def path_from(start: Pose, largest_radius: float, smallest_radius: float, shape: int, wheelbase: float) -> TwoArcPath:
    """Return the path of ``shape`` from ``start`` (slot's frame) to the origin."""
    if shape == PathShape.TWO_ARCS:
        return two_arcs(start, largest_radius, smallest_radius)
    if start.x <= 0.0 or start.y <= 0.0 or not -MAX_TANGENT_HEADING < start.heading < MAX_TANGENT_HEADING:
        return NO_PATH
    found = curve(shape, start, wheelbase)
    if found.curvature * smallest_radius > 1.0 or found.inflection.heading > MAX_TANGENT_HEADING:
        return NO_PATH
    return TwoArcPath(True, 1.0 / found.curvature, start, found.inflection, found.inflection, found)


def two_arcs(start: Pose, largest_radius: float, smallest_radius: float) -> TwoArcPath:
    """Return the path from ``start`` (slot's frame) to the origin, of the largest radius that fits."""
    radius = largest_radius
    if _centre_distance_squared(start, radius) < 4.0 * radius * radius:
        radius = touching_radius(start)
    if not smallest_radius <= radius <= largest_radius or not -HALF_PI < start.heading < HALF_PI:
        return NO_PATH
    s0 = math.sin(start.heading)
    c0 = math.cos(start.heading)
    dx = start.x + radius * s0
    dy = start.y - radius * c0 - radius
    line_squared = dx * dx + dy * dy - 4.0 * radius * radius
    line = math.sqrt(line_squared) if line_squared > 0.0 else 0.0
    h1 = math.atan2(dy, dx) - math.atan2(-2.0 * radius, line)
    if h1 < start.heading - 1e-12 or h1 < -1e-12 or h1 > MAX_TANGENT_HEADING or start.x <= 0.0:
        return NO_PATH
    s1 = math.sin(h1)
    c1 = math.cos(h1)
    tangent2 = Pose(radius * s1, radius - radius * c1, h1)
    tangent1 = Pose(tangent2.x + line * c1, tangent2.y + line * s1, h1)
    return TwoArcPath(True, radius, start, tangent1, tangent2)


def touching_radius(start: Pose) -> float:
    """Return the radius [m] with which two arcs touch without a line; 0 if there is none."""
    s0 = math.sin(start.heading)
    c0 = math.cos(start.heading)
    a = 2.0 * c0 - 2.0
    b = 2.0 * start.x * s0 - 2.0 * start.y * (1.0 + c0)
    c = start.x * start.x + start.y * start.y
    divisor = -b + math.sqrt(b * b - 4.0 * a * c)
    return 2.0 * c / divisor if divisor > 0.0 else 0.0


def ahead(pose: Pose, distance: float) -> Pose:
    """Return the pose ``distance`` [m] straight ahead of ``pose``."""
    return Pose(pose.x + distance * math.cos(pose.heading), pose.y + distance * math.sin(pose.heading), pose.heading)


def _centre_distance_squared(start: Pose, radius: float) -> float:
    dx = start.x + radius * math.sin(start.heading)
    dy = start.y - radius * math.cos(start.heading) - radius
    return dx * dx + dy * dy
