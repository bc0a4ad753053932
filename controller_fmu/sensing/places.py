"""Places heard on one side as they are looked at, and what their echoes say about the space before them.

Seen from the sensor: u forward, w to its side. A corridor leads into the side by the angle a from forward; along it t
grows, across it s: (t, s) = (u cos a + w sin a, u sin a - w cos a). An echo from the distance r says besides that
nothing stands nearer in the whole cone.
"""

import math
from typing import NamedTuple

from controller_fmu.planning.plan_store import HEARD, RAYS, PlanStore
from modelkit.vocabulary import Pose

BEFORE_ECHO = 0.05
"""So much [m] before an echo nothing stands."""
STRAY = 3
"""A place, with those joined to it, needs so many echoes, else it may be of two things heard in turn."""
NEXT = 0.3
"""Places heard once are of one thing if they are so near [m] to each other."""
CERTAIN = 6
"""What a gap ends at was heard so often within ``NEXT``."""
UNSEEN = -50.0
"""Where [m] a row is of which too little was seen."""


class PlacesFrame(NamedTuple):
    """How places are looked at: whose they are, from where, along which way, row and corridor."""

    side: int
    """0 right, 1 left."""
    first: int
    """Of the places."""
    end: int
    mirror: float
    """1 on the right side, -1 on the left."""
    at: Pose
    """The sensor; its heading is that of the way."""
    way_c: float
    """Cosine and sine of the way's direction."""
    way_s: float
    cone: float
    """Cosine of the cone's half angle, squared."""
    row: float = 0.0
    """Direction of the row against the way, towards the side [rad]."""
    into: float = 0.0
    """Direction into the corridor against the way, towards the side [rad]."""
    row_c: float = 1.0
    """Cosines and sines of the two."""
    row_s: float = 0.0
    into_c: float = 0.0
    into_s: float = 1.0
    line: float = UNSEEN
    """Where the row's line lies [m]."""
    cars: bool = False
    """Sides as long as those of cars were seen: what is small among them is a post."""


class Spot(NamedTuple):
    """A place in a frame [m]: along the corridor, across it, and how far behind the row's line."""

    t: float
    s: float
    z: float


def frame_of(side: int, places: int, at: Pose, half_angle: float) -> PlacesFrame:
    """Return the frame of a side that has heard so many places, for a sensor ``at`` whose heading is the way's."""
    narrow = math.cos(0.95 * half_angle)
    first = side * HEARD
    mirror = 1.0 if side == 0 else -1.0
    c = math.cos(at.heading)
    s = math.sin(at.heading)
    return PlacesFrame(side, first, first + places, mirror, at, c, s, narrow * narrow)


def along(frame: PlacesFrame, row: float, into: float) -> PlacesFrame:
    """Return a frame with a row and a corridor of other directions [rad]."""
    return frame._replace(
        row=row,
        into=into,
        row_c=math.cos(row),
        row_s=math.sin(row),
        into_c=math.cos(into),
        into_s=math.sin(into),
    )


def seen(store: PlanStore, place: int, frame: PlacesFrame) -> Pose:
    """Return a place as the sensor sees it: x forward, y to its side [m]."""
    return turned(store.heard_x[place], store.heard_y[place], frame)


def turned(x: float, y: float, frame: PlacesFrame) -> Pose:
    """Return a point of the world as the sensor sees it [m]."""
    dx = x - frame.at.x
    dy = y - frame.at.y
    return Pose(dx * frame.way_c + dy * frame.way_s, frame.mirror * (dx * frame.way_s - dy * frame.way_c), 0.0)


def spot_of(point: Pose, frame: PlacesFrame) -> Spot:
    """Return a point that the sensor sees, in the corridor's coordinates."""
    behind = point.y * frame.row_c - point.x * frame.row_s
    t = point.x * frame.into_c + point.y * frame.into_s
    return Spot(t, point.x * frame.into_s - point.y * frame.into_c, behind)


def spot(store: PlanStore, place: int, frame: PlacesFrame) -> Spot:
    """Return a place in the corridor's coordinates."""
    return spot_of(seen(store, place, frame), frame)


def in_world(t: float, s: float, frame: PlacesFrame) -> Pose:
    """Return the world's point of coordinates in the corridor [m]; its heading is 0."""
    u = t * frame.into_c + s * frame.into_s
    right = frame.mirror * (t * frame.into_s - s * frame.into_c)
    x = frame.at.x + u * frame.way_c + right * frame.way_s
    return Pose(x, frame.at.y + u * frame.way_s - right * frame.way_c, 0.0)


def is_sure(store: PlanStore, place: int, end: int) -> bool:
    """Return whether a place is of something: heard ``STRAY`` times, with the near ones joined to it."""
    count = store.heard_count[place]
    if count >= STRAY:
        return True
    count = count + store.heard_count[place - 1] if _goes_on(store, place) else count
    count = count + store.heard_count[place + 1] if place + 1 < end and _goes_on(store, place + 1) else count
    return count >= STRAY


def is_certain(store: PlanStore, place: int, first: int, end: int) -> bool:
    """Return whether enough was heard around a place to take it for what a gap ends at: no echoes of two things."""
    count = 0
    for other in range(first, end):
        dx = store.heard_x[other] - store.heard_x[place]
        dy = store.heard_y[other] - store.heard_y[place]
        count = count + store.heard_count[other] if dx * dx + dy * dy < NEXT * NEXT else count
    return count >= CERTAIN


def _goes_on(store: PlanStore, place: int) -> bool:
    """Return whether a place is joined to the one before, and near.

    At the rim of the cone places jump; the first place of a side is joined to nothing, and 0 is the first of all.
    """
    if store.heard_joint[place] == 0:
        return False
    dx = store.heard_x[place] - store.heard_x[place - 1]
    dy = store.heard_y[place] - store.heard_y[place - 1]
    return dx * dx + dy * dy < NEXT * NEXT


def is_free(store: PlanStore, t: float, s: float, frame: PlacesFrame) -> bool:
    """Return whether a point of the corridor is known to be free."""
    return is_before_echo(store, in_world(t, s, frame), frame.side, frame.cone)


def is_before_echo(store: PlanStore, point: Pose, side: int, cone: float) -> bool:
    """Return whether a point of the world lies before an echo, in the cone (``PlacesFrame``) of a side's sensor."""
    for ray in range(side * RAYS, side * RAYS + RAYS):
        dx = point.x - store.ray_x[ray]
        dy = point.y - store.ray_y[ray]
        ex = store.ray_end_x[ray] - store.ray_x[ray]
        ey = store.ray_end_y[ray] - store.ray_y[ray]
        dot = dx * ex + dy * ey
        if dot > 0.0:
            square = dx * dx + dy * dy
            reach = math.sqrt(ex * ex + ey * ey)
            free = reach - BEFORE_ECHO
            if square < free * free and dot * dot > cone * square * reach * reach:
                return True
    return False
