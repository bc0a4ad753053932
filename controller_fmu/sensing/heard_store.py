"""What was heard, in the store: places along both sides, and the map made of them; the only functions that write it."""

from controller_fmu.planning.plan_store import HEARD, RAYS, SIDES, PlanStore
from modelkit.vocabulary import Pose

MERGED = 0.1
"""Echoes from places nearer to each other than this [m] are of one place."""
JOINT = 0.5
"""Places nearer than this [m] are of one thing."""
MOST_LINES = 179
"""One more, and things heard on the way, are left room for."""
MANY = 40
"""A place is the mean of so many echoes at most."""


def forget_side(store: PlanStore, side: int) -> None:
    """Forget what was heard on one side, or by one of the ears after these."""
    for place in range(side * HEARD, side * HEARD + HEARD):
        store.heard_count[place] = 0
    if side < SIDES:
        for ray in range(side * RAYS, side * RAYS + RAYS):
            store.ray_x[ray] = 0.0
            store.ray_y[ray] = 0.0
            store.ray_end_x[ray] = 0.0
            store.ray_end_y[ray] = 0.0


def forget_place(store: PlanStore, place: int) -> None:
    """Forget one place: no echo came from there, and it belongs to nothing."""
    store.heard_count[place] = 0
    store.heard_joint[place] = 0


def put_heard(store: PlanStore, side: int, count: int, x: float, y: float, broken: bool) -> int:
    """Take in an echo from a place; returns how many places the side has. The oldest is forgotten when it is full.

    ``broken``: nothing, or something else, was heard since the echo before.
    """
    first = side * HEARD
    if count > 0:
        last = first + count - 1
        n = store.heard_count[last]
        dx = x - store.heard_x[last]
        dy = y - store.heard_y[last]
        square = dx * dx + dy * dy
        if square < MERGED * MERGED and not broken:
            more = n + 1 if n < MANY else MANY
            store.heard_x[last] += dx / more
            store.heard_y[last] += dy / more
            store.heard_count[last] = more
            return count
        broken = broken or square > JOINT * JOINT
    if count == HEARD:
        for place in range(first, first + HEARD - 1):
            store.heard_x[place] = store.heard_x[place + 1]
            store.heard_y[place] = store.heard_y[place + 1]
            store.heard_count[place] = store.heard_count[place + 1]
            store.heard_joint[place] = store.heard_joint[place + 1]
        count = HEARD - 1
    place = first + count
    store.heard_x[place] = x
    store.heard_y[place] = y
    store.heard_count[place] = 1
    store.heard_joint[place] = 0 if broken or count == 0 else 1
    return count + 1


def put_ray(store: PlanStore, side: int, number: int, at: Pose, end: Pose) -> None:
    """Remember what a sensor looked along without hearing anything nearer; the oldest of ``RAYS`` is forgotten."""
    ray = side * RAYS + number % RAYS
    store.ray_x[ray] = at.x
    store.ray_y[ray] = at.y
    store.ray_end_x[ray] = end.x
    store.ray_end_y[ray] = end.y


def clear_around(store: PlanStore) -> None:
    """Empty the map."""
    for corner in range(len(store.around_x)):
        store.around_x[corner] = 0.0
        store.around_y[corner] = 0.0
        store.around_of[corner] = 0


def set_line(store: PlanStore, line: int, ax: float, ay: float, bx: float, by: float) -> None:
    """Set a line of the map, from a to b."""
    corner = 2 * line
    store.around_x[corner] = ax
    store.around_y[corner] = ay
    store.around_of[corner] = line + 1
    store.around_x[corner + 1] = bx
    store.around_y[corner + 1] = by
    store.around_of[corner + 1] = line + 1


def put_line(store: PlanStore, lines: int, ax: float, ay: float, bx: float, by: float) -> int:
    """Add a line from a to b to the map; returns how many it has. There is no room for more than ``MOST_LINES``."""
    if lines >= MOST_LINES:
        return lines
    set_line(store, lines, ax, ay, bx, by)
    return lines + 1
