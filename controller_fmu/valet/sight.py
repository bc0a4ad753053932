"""What the distance sensors hear that the map does not have: slow down and stop before it, and remember it.

A reading of a sensor on the driven side is compared with what it should hear from the polygons of the map. Nearer
than that by ``surprise`` is something unknown. What is known is left to the path.
"""

import math
from typing import NamedTuple

from controller_fmu.planning.plan_store import PlanStore
from controller_fmu.planning.task import CORNERS, Corner, Scene
from controller_fmu.valet.params import MAP_CORNERS, ValetParams
from modelkit.car import CarUltrasonic, SensorMount
from modelkit.geometry import Point, cone_line
from modelkit.vocabulary import Pose

FREE = 100.0
LOOKED_AT = 1.5
"""Readings [m] up to this are looked at."""
CORNER = 0.3
"""Neighbours of a slot that was found are not known everywhere: corner sensors are heeded from here on [m]."""
CORNER_SURPRISE = 0.1
SIDE = 0.2
"""What lies beside the car is heeded from here on [m], and this much nearer [m] than known."""
SENSORS = 12
SIDE_SENSOR = 8
CLOSE = 0.18
"""Straight ahead, nothing is let come nearer than this [m] in a slot that was found, known or not."""
BOTH = 0.25
"""What a slot ends at is heard by both sensors that look straight ahead, as far off but for this [m]."""
AGAIN = 0.1
"""A standing car sets out again when there is so much more room [m]."""
SEEN_CORNERS = CORNERS - MAP_CORNERS
"""Four corners for each thing remembered."""
SEEN_WIDTH = 0.8
SEEN_DEPTH = 0.5
"""A thing that was heard is taken to be so large [m]; its front is where the echo came from."""
NUMBER = 1_000_000
"""Number of the first polygon of what was heard."""


class Sight(NamedTuple):
    """What is in the way."""

    speed: float = FREE
    """Largest speed [m/s] with which the car still stops in time."""
    blocked: bool = False
    ahead: bool = False
    """It was heard straight ahead."""
    echo: Pose = Pose()
    """Where the nearest unknown thing was heard, and in which direction."""


def look(
    readings: tuple[float, ...], pose: Pose, direction: float, speed: float, scene: Scene, params: ValetParams
) -> Sight:
    """Return the sight of a car at ``pose`` that drives in ``direction`` with ``speed`` [m/s]."""
    first = 0 if direction > 0.0 else 4
    nearest = FREE
    echo = Pose()
    straight = False
    for number in range(SENSORS):
        on_side = number >= SIDE_SENSOR and params.search.active
        reading = readings[number]
        if (first <= number < first + 4 or on_side) and reading < LOOKED_AT and reading < nearest:
            at = sensor_at(params.car.ultrasonic.mounts[number], pose)
            ahead = first < number < first + 3 and params.search.active
            corner = params.search.active and not ahead
            surprise = CORNER_SURPRISE if corner else params.guard.surprise
            heeded = not corner or reading < (SIDE if on_side else CORNER)
            nearer = heeded and reading < expected(at, scene, params) - surprise
            if nearer or (ahead and reading < CLOSE):
                nearest = reading
                beside = readings[2 * first + 3 - number] if ahead else reading
                straight = ahead and abs(beside - reading) < BOTH
                c = math.cos(at.heading)
                s = math.sin(at.heading)
                echo = Pose(at.x + reading * c, at.y + reading * s, at.heading)
    room = nearest - params.guard.gap
    drive = params.drive
    stop = abs(speed) * drive.delay + 0.5 * speed * speed / drive.brake
    if abs(speed) <= params.threshold.standstill:
        stop = AGAIN
    return Sight(math.sqrt(drive.brake * (room if room > 0.0 else 0.0)), room <= stop, straight, echo)


def sensor_at(mount: SensorMount, pose: Pose) -> Pose:
    """Return where a sensor is and looks."""
    c = math.cos(pose.heading)
    s = math.sin(pose.heading)
    return Pose(pose.x + mount.x * c - mount.y * s, pose.y + mount.x * s + mount.y * c, pose.heading + mount.yaw)


def is_told_anew(clock_ns: int, sensors: CarUltrasonic, dt_ns: int) -> bool:
    """Return whether sensors tell something new in the sample of ``dt_ns`` that ends at ``clock_ns``: every cycle."""
    return clock_ns % math.floor(sensors.cycle * 1e9 + 0.5) < dt_ns


def expected(at: Pose, scene: Scene, params: ValetParams) -> float:
    """Return the distance [m] that a sensor should hear from the scene's polygons, at most its range."""
    start = Point(at.x, at.y)
    half = params.car.ultrasonic.half_angle
    nearest = params.car.ultrasonic.max_range
    first = 0
    for number in range(CORNERS):
        a = scene.corners[number]
        if a.polygon > 0:
            if number > 0 and scene.corners[number - 1].polygon != a.polygon:
                first = number
            last = number == CORNERS - 1
            goes_on = scene.corners[0 if last else number + 1].polygon == a.polygon and not last
            b = scene.corners[number + 1 if goes_on else first]
            gap = cone_line(start, at.heading, half, Point(a.x, a.y), Point(b.x, b.y))
            nearest = gap if gap < nearest else nearest
    return nearest


def remembered(seen: tuple[Corner, ...], echo: Pose, count: int) -> tuple[Corner, ...]:
    """Return the things heard with one more, the ``count``-th; the oldest is forgotten when there is no room."""
    first = 4 * (count % (SEEN_CORNERS // 4))
    c = math.cos(echo.heading)
    s = math.sin(echo.heading)
    for corner in range(SEEN_CORNERS):
        if first <= corner < first + 4:
            side = corner - first
            x = 0.0 if side == 0 or side == 3 else SEEN_DEPTH
            y = 0.5 * SEEN_WIDTH if side < 2 else -0.5 * SEEN_WIDTH
            new = Corner(echo.x + x * c - y * s, echo.y + x * s + y * c, NUMBER + count)
            seen = seen[:corner] + (new,) + seen[corner + 1 :]
    return seen


def scene_of(store: PlanStore, params: ValetParams, seen: tuple[Corner, ...]) -> Scene:
    """Return the map's polygons, or those made of what was heard in a search, and what was heard besides."""
    heard = params.search.active
    return Scene(
        tuple(
            (
                Corner(store.around_x[number], store.around_y[number], store.around_of[number])
                if heard
                else params.map[number if number < MAP_CORNERS else 0]
            )
            if number < MAP_CORNERS
            else seen[number - MAP_CORNERS if number >= MAP_CORNERS else 0]
            for number in range(CORNERS)
        )
    )
