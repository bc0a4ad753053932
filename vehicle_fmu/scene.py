"""What stands around the car: boxes and kerb lines, and how near the car's outline is to them.

A box may appear and disappear at given times, and move straight on between two more. A kerb or box
lower than the ground clearance stops the wheels but passes under the bumpers: clearance to it is
measured from the part of the outline between the tyres' outer ends.
"""

import math
from typing import Annotated, NamedTuple

from modelkit.car import Car
from modelkit.geometry import (
    NO_HIT,
    Box,
    OrientedBox,
    Point,
    centre_gap,
    orient,
    orient_line,
    outline_box,
    overlap_depth,
    separation,
)
from modelkit.signal import Signal
from modelkit.vocabulary import Pose

HOUSE = "project default; the source states none"
NEVER_TIME = 1e9
TOUCH_DEPTH = 1e-9
"""Penetration depth [m] of what only touches: less than any other."""
MAX_ROUNDING_ERROR = 1e-6
"""Of a bound of a gap [m]: the coordinates of a map have steps of 1.5e-8 m."""
FAR_OUT = 1e8
"""Largest coordinate [m]: that of a map will do."""


class Obstacle(NamedTuple):
    """An oriented box that stands in the way for some time."""

    x: Annotated[float, Signal("m", "x of the centre", -FAR_OUT, FAR_OUT)] = 0.0
    y: Annotated[float, Signal("m", "y of the centre", -FAR_OUT, FAR_OUT)] = 0.0
    heading: Annotated[float, Signal("rad", "direction of its length", -100.0, 100.0)] = 0.0
    length: Annotated[float, Signal("m", "length; 0: unused", 0.0, 1000.0)] = 0.0
    width: Annotated[float, Signal("m", "width", 0.0, 1000.0)] = 0.0
    appear_at: Annotated[float, Signal("s", "present from this time on", 0.0, NEVER_TIME)] = 0.0
    disappear_at: Annotated[float, Signal("s", "removed from this time on; 1e9: never", 0.0, NEVER_TIME)] = NEVER_TIME
    speed_x: Annotated[float, Signal("m/s", "speed along x while it moves", -50.0, 50.0)] = 0.0
    speed_y: Annotated[float, Signal("m/s", "speed along y while it moves", -50.0, 50.0)] = 0.0
    moves_at: Annotated[float, Signal("s", "moves from this time on", 0.0, NEVER_TIME)] = 0.0
    halts_at: Annotated[float, Signal("s", "stops at this time; 1e9: never", 0.0, NEVER_TIME)] = NEVER_TIME
    height: Annotated[float, Signal("m", "height above the ground", 0.0, 100.0, HOUSE)] = 2.0


class Kerb(NamedTuple):
    """A straight kerb from point 1 to point 2."""

    x1: Annotated[float, Signal("m", "x of the first end", -FAR_OUT, FAR_OUT)] = 0.0
    y1: Annotated[float, Signal("m", "y of the first end", -FAR_OUT, FAR_OUT)] = 0.0
    x2: Annotated[float, Signal("m", "x of the second end", -FAR_OUT, FAR_OUT)] = 0.0
    y2: Annotated[float, Signal("m", "y of the second end", -FAR_OUT, FAR_OUT)] = 0.0
    height: Annotated[float, Signal("m", "height; 0: unused", 0.0, 10.0)] = 0.0


class SceneParams(NamedTuple):
    """Everything around the car, and what passes under it."""

    boxes: tuple[Obstacle, ...] = (Obstacle(),) * 16
    kerbs: tuple[Kerb, ...] = (Kerb(),) * 4
    ground_clearance: Annotated[
        float, Signal("m", "kerbs and boxes lower than this pass under the bumpers", 0.0, 1.0, HOUSE)
    ] = 0.15
    tyre_reach: Annotated[
        float, Signal("m", "tyres reach this far beyond the axles, as high as a kerb is", 0.0, 1.0, HOUSE)
    ] = 0.3
    """At most the radius of the tyre; what the wheel rolls on is ``double_track.hub.radius``."""


def is_there(obstacle: Obstacle, time_ns: int) -> bool:
    """Return whether the obstacle stands in the scene now."""
    return obstacle.length > 0.0 and obstacle.appear_at <= time_ns * 1e-9 < obstacle.disappear_at


def obstacle_box(obstacle: Obstacle, time_ns: int) -> Box:
    """Return the obstacle's rectangle now: it keeps its heading while it moves."""
    x = obstacle.x
    y = obstacle.y
    if obstacle.speed_x != 0.0 or obstacle.speed_y != 0.0:
        moved = max(0.0, min(time_ns * 1e-9, obstacle.halts_at) - obstacle.moves_at)
        x = x + obstacle.speed_x * moved
        y = y + obstacle.speed_y * moved
    return Box(x, y, obstacle.heading, obstacle.length, obstacle.width)


def clearance(
    pose: Pose, car: Car, scene: SceneParams, kerb_height: float, time_ns: int, limit: float = NO_HIT
) -> float:
    """Return the distance [m] from the car to the nearest thing; ``limit`` if none is nearer.

    In contact it is minus the penetration depth, and at most ``-TOUCH``. A wheel at a kerb or box lower than
    ``kerb_height`` is no contact: it gives 0.
    """
    ahead = Point(math.cos(pose.heading), math.sin(pose.heading))
    body = outline_box(pose, ahead, car.wheelbase, car.front_overhang, car.rear_overhang, car.width)
    nearest = limit
    for obstacle in scene.boxes:
        if is_there(obstacle, time_ns):
            box = obstacle_box(obstacle, time_ns)
            if nearest <= 0.0 or centre_gap(body, box) < nearest:
                part = body
                if obstacle.height < scene.ground_clearance:
                    part = outline_box(pose, ahead, car.wheelbase, scene.tyre_reach, scene.tyre_reach, car.width)
                nearest = nearest_of(nearest, part, orient(box), obstacle.height >= kerb_height)
    for kerb in scene.kerbs:
        if kerb.height > 0.0:
            part = body
            if kerb.height < scene.ground_clearance:
                part = outline_box(pose, ahead, car.wheelbase, scene.tyre_reach, scene.tyre_reach, car.width)
            line = orient_line(kerb.x1, kerb.y1, kerb.x2, kerb.y2)
            nearest = nearest_of(nearest, part, line, kerb.height >= kerb_height)
    return nearest


def nearest_of(nearest: float, car: OrientedBox, thing: OrientedBox, is_obstacle: bool) -> float:
    """Return the smaller of ``nearest`` and the gap of car and thing, which is negative inside an obstacle."""
    depth = overlap_depth(car, thing)
    if nearest > 0.0 and -depth >= nearest + MAX_ROUNDING_ERROR:
        return nearest
    gap = -depth if depth > 0.0 else separation(car, thing)
    if gap <= 0.0:
        gap = -max(TOUCH_DEPTH, -gap) if is_obstacle else 0.0
    return min(nearest, gap)
