"""The slot as the map has it: its line and its heading, by the two neighbours and the wall, and how sure they are."""

import math

from controller_fmu.apa.around.closing import Track
from controller_fmu.apa.around.local_map import B, LocalMap, ear_on, expected, with_neighbour
from controller_fmu.apa.around.shifted import MOST, UNSURE, shifted
from controller_fmu.apa.around.thing import Thing, wider
from controller_fmu.apa.hearing.mute import is_mute
from controller_fmu.apa.params import ApaSystemParams, MapParams
from controller_fmu.apa.slot import UNSEEN, Kind, Slot, flush_with
from controller_fmu.common.slot_frame import to_world
from modelkit.vocabulary import Pose

STAGGER = 0.12
"""A neighbour's corner stands out of the row, or in, by this [m]: their line tells the road's direction."""
WALL_ASKEW = 0.01
WALL_DOUBT = 0.05
"""A wall stands askew by a tenth of what neighbours do; one that contradicts them is perhaps none."""
FOUND = 0.08
"""How far out one corner is found against the other is unsure by this [m]: the odometry has turned since."""
FOUND_DOUBT = 0.25
"""Where they contradict it, one of them was perhaps not found well."""
FAR_OUT = 0.7
"""Corners of whom one stands so much [m] further out than the other tell no direction: one had left the row before."""
MISSED = 0.4
"""What is heard so much [m] further off than a neighbour should be is something else."""
LISTENED = 3.5
"""Neighbours beside a car in a perpendicular slot are listened for up to so far [m]."""
ASIDE = 0.12
"""A car in a perpendicular slot stands so much [m] nearer to one neighbour than to the middle at most."""
HAS_MOVED = 0.2
"""A neighbour who stands so much [m] along himself from where he was found has moved since."""
MOVED_ASIDE = 0.3
"""How far out he stands beside a parallel slot is heard no better than this [m] then."""
OUT_OF_LINE = (0.12, 0.5)
"""A map in which a neighbour has come so much [m] further out, or in, than the other is lost, along the road and across
it,"""
STAYS = 0.25
"""but for one beside a perpendicular slot who has moved while the other stands to this [m] where he was found."""


def as_found(here: LocalMap) -> LocalMap:
    """Return the map with corner B as much further out than corner A as it was found, as far as that is surer.

    Both were found in one pass, a few metres apart; what is heard since, of one of them most, moves both. Cars move
    along themselves: one beside a parallel slot who has moved stands out as far as he did.
    """
    if here.kind == Kind.PARALLEL:
        here = here._replace(a=_unsure_aside(here.a, 0.0), b=_unsure_aside(here.b, here.found))
    spread = here.a.yy + here.b.yy
    off = here.out - (here.b.y - here.a.y)
    share = 1.0 / (spread + FOUND * FOUND + FOUND_DOUBT * off * off)
    a = share * here.a.yy
    b = share * here.b.yy
    return here._replace(
        a=here.a._replace(y=here.a.y - a * off, yy=(1.0 - a) * here.a.yy),
        b=here.b._replace(y=here.b.y + b * off, yy=(1.0 - b) * here.b.yy),
    )


def _unsure_aside(thing: Thing, found: float) -> Thing:
    """Return a neighbour of a parallel slot, found at x = ``found`` [m]: unsure in y if he has moved along the road."""
    moved = abs(thing.x - found) > HAS_MOVED
    return thing._replace(yy=thing.yy + MOVED_ASIDE * MOVED_ASIDE) if moved else thing


def in_row(here: LocalMap) -> LocalMap:
    """Return the map with a neighbour of a perpendicular slot who has moved since back where he was in the row.

    Of two that stand otherwise than they were found it is the one who stands further from where he was.
    """
    off = _out_of_line(here)
    if here.kind != Kind.PERPENDICULAR or abs(off) < HAS_MOVED:
        return here
    if abs(here.a.y) > abs(here.b.y - here.out):
        return here._replace(a=here.a._replace(y=here.a.y + off, yy=here.b.yy + FOUND * FOUND))
    return here._replace(b=here.b._replace(y=here.b.y - off, yy=here.a.yy + FOUND * FOUND))


def slot_of_map(here: LocalMap, slot: Slot, params: MapParams) -> Slot:
    """Return the slot as the map has it: its heading is that of what stands around, each weighted by how sure it is."""
    row = as_found(in_row(here))
    heading = slot_heading(row, params)
    here = as_found(here)
    c = math.cos(heading)
    s = math.sin(heading)
    dx = here.b.x - here.a.x
    dy = here.b.y - here.a.y
    depth = UNSEEN
    if here.walled:
        depth = (here.a.y - here.wall.y) * c - (here.a.x - here.wall.x) * s
    b_out = dy * c - dx * s
    out = (row.a.y - here.a.y) * c
    line = out + flush_with(slot.kind, b_out - out + (row.b.y - here.b.y) * c)
    return slot._replace(
        a=to_world(Pose(here.a.x, here.a.y, heading), here.frame),
        length=dx * c + dy * s,
        b_out=b_out,
        line=line - flush_with(slot.kind, b_out),
        depth=depth,
        skew_a=here.a.heading - heading,
        skew_b=here.b.heading - heading,
        unsure=_reserve(here, params),
        opposite=here.across - here.a.y if here.within and here.across < UNSEEN else slot.opposite,
    )


def slot_heading(here: LocalMap, params: MapParams) -> float:
    """Return the heading [rad] of the slot in the map: half way between the neighbours' mean one and the road's."""
    least = params.askew * params.askew
    a = 1.0 / (least + here.a.hh)
    b = 1.0 / (least + here.b.hh)
    both = (a * here.a.heading + b * here.b.heading) / (a + b)
    dx = max(here.b.x - here.a.x, 1.0)
    line = math.atan2(here.b.y - here.a.y, dx)
    corners = dx * dx / (2.0 * STAGGER * STAGGER + here.a.yy + here.b.yy)
    if here.kind == Kind.PERPENDICULAR and abs(line - both) * dx > FAR_OUT:
        corners = 0.0
    total = corners * (line - both)
    weight = a + b + corners
    if here.walled:
        off = here.wall.heading - both
        wall = 1.0 / (WALL_ASKEW * least + here.wall.hh + WALL_DOUBT * off * off)
        total += wall * off
        weight += wall
    road = both + total / weight
    stand = road + 0.5 * least * (a * (here.a.heading - road) + b * (here.b.heading - road))
    return 0.5 * (road + stand)


def _reserve(here: LocalMap, params: MapParams) -> float:
    """Return how much further in [m] than thought a neighbour may stand, beyond what the margins are there for."""
    return max(0.0, math.sqrt(_unsure_along(here)) - params.usual)


def _unsure_along(here: LocalMap) -> float:
    """Return the variance [m2] along the road of the less sure neighbour of those who are there."""
    return max(0.0 if here.empty_a else here.a.xx, 0.0 if here.empty_b else here.b.xx)


def _out_of_line(here: LocalMap) -> float:
    """Return how much further out [m] corner B is against corner A than it was found."""
    return here.b.y - here.a.y - here.out


def _has_one_moved(here: LocalMap) -> bool:
    """Return whether one neighbour beside a perpendicular slot has moved out of the row, or in, and the other stays."""
    return here.kind == Kind.PERPENDICULAR and min(abs(here.a.y), abs(here.b.y - here.out)) < STAYS


def is_certain(here: LocalMap, params: MapParams) -> bool:
    """Return whether neighbours are still where a car between them hears them, and in line as they were found."""
    most = OUT_OF_LINE[0 if here.kind == Kind.PARALLEL else 1]
    in_line = abs(_out_of_line(here)) < most or _has_one_moved(here)
    return in_line and _unsure_along(here) < params.certain * params.certain


def without_gone(
    here: LocalMap, tracks: tuple[Track, ...], readings: tuple[float, ...], params: ApaSystemParams
) -> LocalMap:
    """Return the map without the neighbour behind a parallel slot if he has gone: the middle sensors hear past him.

    What tells how deep the car stands is the neighbour ahead, so he is missed if he has gone.
    """
    gone = _hears_past(here, tracks, readings, 5, params) and _hears_past(here, tracks, readings, 6, params)
    return here._replace(empty_a=here.empty_a or gone) if here.kind == Kind.PARALLEL else here


def driven_on(
    here: LocalMap, tracks: tuple[Track, ...], readings: tuple[float, ...], params: ApaSystemParams
) -> LocalMap:
    """Return the map with the neighbour ahead in a parallel slot as far on as both middle sensors of the front hear.

    A car that stood between the neighbours when the map was begun has heard him nearest from there.
    """
    if here.kind != Kind.PARALLEL or here.empty_b or here.within:
        return here
    one = expected(ear_on(here, params.car.ultrasonic, 1), here)
    two = expected(ear_on(here, params.car.ultrasonic, 2), here)
    past = _hears_past(here, tracks, readings, 1, params) and _hears_past(here, tracks, readings, 2, params)
    if not past or one.who != B or two.who != B:
        return here
    way = min(tracks[1].now - one.echo.distance, tracks[2].now - two.echo.distance, MOST)
    return with_neighbour(here, B, wider(shifted(here, B, -way).b, UNSURE, 0.0))


def _hears_past(
    here: LocalMap, tracks: tuple[Track, ...], readings: tuple[float, ...], number: int, params: ApaSystemParams
) -> bool:
    """Return whether a sensor hears past what the map has before it; nothing, where it should hear something."""
    told = expected(ear_on(here, params.car.ultrasonic, number), here).echo.distance
    return told < params.apa.map.heard and tracks[number].now > told + MISSED and not is_mute(readings[number])


def is_heard(here: LocalMap, readings: tuple[float, ...], params: ApaSystemParams) -> bool:
    """Return whether a car that stands in a perpendicular slot hears its neighbours beside it, as deep as it stands.

    Not if both sensors of a side hear nothing where the map has its neighbour, nor if neither of the rear ones does:
    then the neighbours are as deep as cars are wide, and stand along the road.
    """
    if here.kind != Kind.PERPENDICULAR:
        return True
    front_left = _is_missed(here, readings, 8, params)
    rear_left = _is_missed(here, readings, 9, params)
    front_right = _is_missed(here, readings, 10, params)
    rear_right = _is_missed(here, readings, 11, params)
    return not ((front_left and rear_left) or (front_right and rear_right) or (rear_left and rear_right))


def is_in_the_middle(here: LocalMap, readings: tuple[float, ...], params: ApaSystemParams) -> bool:
    """Return False if a car in a perpendicular slot hears itself aside of the middle, whatever the map has.

    Both the front and the rear flank sensors must say so, by what they hear of the neighbours on either side: one pair
    alone may hear past the end of one who is shorter. It has to do where one of the other pair tells nothing.
    """
    ahead = max(readings[8], readings[10])
    behind = max(readings[9], readings[11])
    nearer = min(ahead, behind) if is_mute(max(ahead, behind)) else max(ahead, behind)
    if here.kind != Kind.PERPENDICULAR or nearer > params.apa.map.heard:
        return True
    front = 0.5 * (readings[8] - readings[10])
    rear = 0.5 * (readings[9] - readings[11])
    if is_mute(ahead):
        front = rear
    if is_mute(behind):
        rear = front
    return max(front, rear) > -ASIDE and min(front, rear) < ASIDE


def _is_missed(here: LocalMap, readings: tuple[float, ...], number: int, params: ApaSystemParams) -> bool:
    """Return whether a sensor hears nothing where the map has a neighbour in its reach, or something far behind it.

    What ends the slot is left out: a wheel stop is not as wide as a wall.
    """
    sensors = params.car.ultrasonic
    ear = ear_on(here, sensors, number)
    echo = expected(ear, here._replace(walled=False)).echo
    return echo.distance < LISTENED and readings[number] > echo.distance + MISSED


def line_unsure(here: LocalMap) -> float:
    """Return the standard deviation [m] of how far out the line between the neighbours' corners lies."""
    here = as_found(here)
    return 0.5 * math.sqrt(here.a.yy + here.b.yy)
