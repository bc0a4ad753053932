"""The map around a gap, made of what both sides heard: lines that a car shall not cross.

What has not been looked at is taken to be taken: the row goes on beyond what was heard of it, between neighbours and
behind them is no way, the gap ends where a car's length ends unless something was heard before, and across the road and
ahead no more is free than the sensors hear.
"""

import math
from typing import NamedTuple

from controller_fmu.planning.plan_store import HEARD, PlanStore
from controller_fmu.sensing.gap import Gap, GapLayout
from controller_fmu.sensing.heard_store import clear_around, put_line, set_line
from controller_fmu.sensing.in_gap import along_of
from controller_fmu.sensing.places import frame_of, is_before_echo, is_certain, is_sure
from modelkit.maths import clamp
from modelkit.vocabulary import Pose

BEYOND = 10.0
"""The row and the road go on [m]."""
NARROW = 0.1
FLAT = 0.03
"""Places this near [m] to the line between others are left out."""
SPARSE = 2.0
LEVEL = 0.05
"""A front lies along its row if it stands out less than this [m/m]."""
WIDE = 5.0
NEAR_CORNER = 0.5
"""What is heard so near [m] to a gap's corner is of the neighbour there."""
SWUNG = 2.0
SWUNG_DEEP = 2.0
"""So far [m] beside a gap, and so deep, is of use to a car that swings into it."""
SWUNG_LESS = 0.1
"""The margin [m] of that."""
STEPS = 8
"""It is looked at in so many steps each way."""
OFF_CAR = 0.3
"""What was not heard of a row lies so far [m] behind the car that drives past it."""


class AroundGap(NamedTuple):
    """What else the map is made of."""

    side: int
    """Of the gap: 0 right, 1 left."""
    here: int
    """Places heard on this side."""
    opposite: int
    """And on the other one."""
    pose: Pose
    """Of the car."""
    reach: float
    """A sensor hears so far [m]."""
    half_width: float
    front: float
    """From the rear axle to the bumper [m]."""
    rear: float
    """And to the rear bumper [m]."""
    ahead: float
    """Heard before the bumper [m]."""
    length: float
    """So deep [m] the gap is needed, if nothing was heard before."""
    half_angle: float = 0.0
    """Of a sensor's cone [rad]."""
    told: bool = False
    """The gap was told from outside: so were its corners."""


def lay_around(store: PlanStore, gap: Gap, what: AroundGap) -> int:
    """Make the map of a gap; returns how many lines it has."""
    clear_around(store)
    back = 0.0 if what.told else _off_car(store, gap, what)
    b = Pose(gap.b.x + back * math.cos(gap.into), gap.b.y + back * math.sin(gap.into), gap.b.heading)
    gap = gap._replace(b=b)
    beyond = _free_beyond(store, gap, what)
    lines = _lay_gap(store, gap, min(gap.depth, what.length), beyond)
    e = along_of(gap)
    gap = gap._replace(b=Pose(gap.b.x + beyond * e.x, gap.b.y + beyond * e.y, gap.b.heading))
    if gap.layout == GapLayout.ACROSS:
        out = min(gap.out, _beside(gap, what)) if back > 0.0 else gap.out
        lines = _lay_fronts(store, lines, gap, 2.0 * what.half_width, out)
    lines = _lay_row(store, lines, gap, what)
    lines = _lay_opposite(store, lines, gap, what)
    pose = what.pose
    c = math.cos(pose.heading)
    s = math.sin(pose.heading)
    x = pose.x + (what.front + what.ahead) * c
    y = pose.y + (what.front + what.ahead) * s
    wide = 2.0 if what.ahead < what.reach - 0.2 else WIDE
    return put_line(store, lines, x - wide * s, y + wide * c, x + wide * s, y - wide * c)


def lay_end(store: PlanStore, gap: Gap, lines: int) -> None:
    """Make a line, the one after so many, of what a gap has been found to end at."""
    e = along_of(gap)
    deep = gap.front + gap.depth
    x = gap.a.x + deep * math.cos(gap.into)
    y = gap.a.y + deep * math.sin(gap.into)
    set_line(store, lines, x, y, x + gap.width * e.x, y + gap.width * e.y)


def _free_beyond(store: PlanStore, gap: Gap, what: AroundGap) -> float:
    """Return how far [m] beyond its corner B, where nothing was heard, it is known to be free beside a gap."""
    if what.told or gap.layout != GapLayout.ACROSS or _is_heard(store, gap, what):
        return 0.0
    cone = frame_of(what.side, what.here, what.pose, what.half_angle).cone
    e = along_of(gap)
    tx = math.cos(gap.into)
    ty = math.sin(gap.into)
    beyond = 0.0
    goes_on = True
    for number in range(STEPS):
        for part in range(STEPS):
            across = (number + 1) * SWUNG / STEPS
            deep = part * SWUNG_DEEP / (STEPS - 1)
            point = Pose(gap.b.x + across * e.x + deep * tx, gap.b.y + across * e.y + deep * ty, 0.0)
            goes_on = goes_on and is_before_echo(store, point, what.side, cone)
        beyond = (number + 1) * SWUNG / STEPS if goes_on else beyond
    return max(beyond - SWUNG_LESS, 0.0)


def _lay_gap(store: PlanStore, gap: Gap, deep: float, beyond: float) -> int:
    """Make the lines beside the gap and behind it; so far ``beyond`` [m] it is free as deep as ``SWUNG_DEEP``."""
    tx = math.cos(gap.into)
    ty = math.sin(gap.into)
    b = (gap.b.x - gap.a.x) * tx + (gap.b.y - gap.a.y) * ty
    end = gap.front + deep
    ax = gap.a.x + end * tx
    ay = gap.a.y + end * ty
    bx = gap.b.x + (end - b) * tx
    by = gap.b.y + (end - b) * ty
    lines = put_line(store, 0, gap.a.x, gap.a.y, ax, ay)
    x = gap.b.x
    y = gap.b.y
    if beyond > 0.0:
        e = along_of(gap)
        x = x + SWUNG_DEEP * tx
        y = y + SWUNG_DEEP * ty
        far_x = beyond * e.x
        far_y = beyond * e.y
        lines = put_line(store, lines, x, y, x + far_x, y + far_y)
        lines = put_line(store, lines, gap.b.x + far_x, gap.b.y + far_y, x + far_x, y + far_y)
    lines = put_line(store, lines, x, y, bx, by)
    return put_line(store, lines, ax, ay, bx, by)


def _lay_fronts(store: PlanStore, lines: int, gap: Gap, width: float, out: float) -> int:
    """Make the fronts of both neighbours, as wide as the car but no farther out than their row: heard or not.

    ``out``: so far [m] before corner A the row stands out at B.
    """
    e = along_of(gap)
    nx = -math.sin(gap.row) * _away(gap)
    ny = math.cos(gap.row) * _away(gap)
    rate = e.x * nx + e.y * ny
    b_out = out - (gap.b.x - gap.a.x) * nx - (gap.b.y - gap.a.y) * ny
    at_a = clamp(gap.out / -rate, 0.0, width) if rate < -LEVEL else width
    at_b = clamp(b_out / rate, 0.0, width) if rate > LEVEL else width
    lines = put_line(store, lines, gap.a.x, gap.a.y, gap.a.x - at_a * e.x, gap.a.y - at_a * e.y)
    return put_line(store, lines, gap.b.x, gap.b.y, gap.b.x + at_b * e.x, gap.b.y + at_b * e.y)


def _lay_row(store: PlanStore, lines: int, gap: Gap, what: AroundGap) -> int:
    """Make the lines of the row: from place to place, but not across the gap, where echoes of two things are none."""
    first = what.side * HEARD
    end = first + what.here
    e = along_of(gap)
    last = first
    broken = False
    for place in range(first + 1, end):
        s = _across(store, place, gap, e)
        before = _across(store, last, gap, e)
        beside = (s < NARROW and before < NARROW) or (s > gap.width - NARROW and before > gap.width - NARROW)
        if NARROW < s < gap.width - NARROW and not is_certain(store, place, first, end):
            broken = True
        elif (store.heard_joint[place] == 1 and not broken) or beside:
            through = place + 1 < end and store.heard_joint[place + 1] == 1 and _is_flat(store, last, place, place + 1)
            broken = False
            if not through:
                lines = _lay(store, lines, last, place)
                last = place
        else:
            broken = False
            last = place
    return _lay_beyond(store, lines, gap, what)


def _lay_beyond(store: PlanStore, lines: int, gap: Gap, what: AroundGap) -> int:
    """Make the lines of what was not heard of the row: beyond both ends it goes on, where it stands out."""
    first = what.side * HEARD
    end = first + what.here
    c = math.cos(gap.row)
    s = math.sin(gap.row)
    low = 0.0
    high = (gap.b.x - gap.a.x) * c + (gap.b.y - gap.a.y) * s
    for place in range(first, end):
        if is_sure(store, place, end):
            on = (store.heard_x[place] - gap.a.x) * c + (store.heard_y[place] - gap.a.y) * s
            low = min(low, on)
            high = max(high, on)
    beside = gap.out * _away(gap)
    driven = min(gap.out, _beside(gap, what)) * _away(gap)
    onwards = math.cos(gap.row - what.pose.heading) > 0.0
    lines = _lay_along_row(store, lines, gap, low, low - BEYOND, beside if onwards else driven)
    return _lay_along_row(store, lines, gap, high, high + BEYOND, driven if onwards else beside)


def _off_car(store: PlanStore, gap: Gap, what: AroundGap) -> float:
    """Return how much deeper [m] a gap's corner B lies, if nothing was heard there and the car stands before it."""
    if _is_heard(store, gap, what):
        return 0.0
    across = (gap.b.y - gap.a.y) * math.cos(gap.row) - (gap.b.x - gap.a.x) * math.sin(gap.row)
    return max(across * _away(gap) - _beside(gap, what), 0.0) / abs(math.sin(gap.into - gap.row))


def _is_heard(store: PlanStore, gap: Gap, what: AroundGap) -> bool:
    """Return whether something was heard at a gap's corner B."""
    first = what.side * HEARD
    for place in range(first, first + what.here):
        dx = store.heard_x[place] - gap.b.x
        dy = store.heard_y[place] - gap.b.y
        if dx * dx + dy * dy < NEAR_CORNER * NEAR_CORNER:
            return True
    return False


def _beside(gap: Gap, what: AroundGap) -> float:
    """Return how far [m] before corner A, across its row, a row may stand out that the car has just driven past."""
    nx = -math.sin(gap.row) * _away(gap)
    ny = math.cos(gap.row) * _away(gap)
    pose = what.pose
    middle = (pose.x - gap.a.x) * nx + (pose.y - gap.a.y) * ny
    ahead = math.cos(pose.heading) * nx + math.sin(pose.heading) * ny
    aside = math.cos(pose.heading) * ny - math.sin(pose.heading) * nx
    return middle + min(what.front * ahead, -what.rear * ahead) - what.half_width * abs(aside) - OFF_CAR


def _away(gap: Gap) -> float:
    """Return 1 if the road lies to the left of a gap's row, else -1."""
    return -1.0 if math.sin(gap.into - gap.row) > 0.0 else 1.0


def _lay_along_row(store: PlanStore, lines: int, gap: Gap, begin: float, end: float, beside: float) -> int:
    """Make a line along a row, from and to so far [m] from corner A, so far to its left."""
    c = math.cos(gap.row)
    s = math.sin(gap.row)
    x = gap.a.x - beside * s
    y = gap.a.y + beside * c
    return put_line(store, lines, x + begin * c, y + begin * s, x + end * c, y + end * s)


def _across(store: PlanStore, place: int, gap: Gap, e: Pose) -> float:
    return (store.heard_x[place] - gap.a.x) * e.x + (store.heard_y[place] - gap.a.y) * e.y


def _is_flat(store: PlanStore, a: int, place: int, b: int) -> bool:
    """Return whether a place lies near the line from a to b, and these not far apart."""
    dx = store.heard_x[b] - store.heard_x[a]
    dy = store.heard_y[b] - store.heard_y[a]
    length = math.sqrt(dx * dx + dy * dy)
    if length < 1e-6 or length > SPARSE:
        return False
    px = store.heard_x[place] - store.heard_x[a]
    py = store.heard_y[place] - store.heard_y[a]
    return abs(px * dy - py * dx) < FLAT * length and px * dx + py * dy > 0.0


def _lay(store: PlanStore, lines: int, a: int, b: int) -> int:
    return put_line(store, lines, store.heard_x[a], store.heard_y[a], store.heard_x[b], store.heard_y[b])


def _lay_opposite(store: PlanStore, lines: int, gap: Gap, what: AroundGap) -> int:
    """Make the lines across the road, which goes on as its row; where nothing was heard, as far as sensors hear."""
    first = (1 - what.side) * HEARD
    pose = what.pose
    c = math.cos(pose.heading)
    s = math.sin(pose.heading)
    if what.opposite == 0:
        off = what.half_width + what.reach if what.side == 0 else -what.half_width - what.reach
        x = pose.x - off * s
        y = pose.y + off * c
        far = BEYOND + WIDE
        return put_line(store, lines, x - far * c, y - far * s, x + far * c, y + far * s)
    last = first
    for place in range(first + 1, first + what.opposite):
        if place + 1 == first + what.opposite or not _is_flat(store, last, place, place + 1):
            lines = _lay(store, lines, last, place)
            last = place
    x = store.heard_x[first]
    y = store.heard_y[first]
    onwards = BEYOND if math.cos(gap.row - pose.heading) > 0.0 else -BEYOND
    row_c = onwards * math.cos(gap.row)
    row_s = onwards * math.sin(gap.row)
    lines = put_line(store, lines, x, y, x - row_c, y - row_s)
    x = store.heard_x[last]
    y = store.heard_y[last]
    return put_line(store, lines, x, y, x + row_c, y + row_s)
