"""What one side sensor has heard on the way past: a neighbour, a gap, the next neighbour.

Coordinates: u along the car's heading when the search began, w to the road (away from the slots), both
mirrored on the left side. Distances are averaged over about 15 cm of way before they are used.
"""

import math
from typing import NamedTuple

from controller_fmu.apa.hearing.consensus import NO_WINDOW, agreed, newest
from controller_fmu.apa.hearing.edge import KEPT, NO_SAMPLES, Heard, append, corner, remember, seen_up_to
from controller_fmu.apa.hearing.line_fit import (
    ASKEW,
    OFF,
    FittedLine,
    Sums,
    add,
    distance,
    leaning,
    offset,
    slope,
    spread,
)
from controller_fmu.apa.params import SearchParams
from modelkit.maths import clamp

NOTHING = 0
WALL = 1
GAP = 2
NEXT_WALL = 3

BIN = 0.16
FLAT = 0.16
STEP = 0.016
"""Steeper than ``FLAT`` [m/m], ``STEP`` [m] for noise, the distance does not belong to a flat side along the road."""
BAND = 0.02
SPREAD = 0.03
"""Further than this [m], and what the noise of the readings makes the line unsure by, is off the line."""
CONFIRMED = 0.3
TWO = 1.5
"""A gap is one once it is this long [m], and two echoes were not heard: others are lost echoes."""
DEEP = 50.0
STEEPEST = 0.28
LEANS = 0.1
"""A neighbour, or the wall, lies so much [m] off per metre along the line of the neighbour before."""
CLOSING = 0.2
"""A neighbour has not begun while it comes nearer by so much [m] more than a slanting side does."""
STEEP = 1.0
"""The face of a neighbour across the way comes nearer by 1 / sin(g) per metre, its corner by sin(g) at most."""
SPLIT = 0.6
SPLIT_READINGS = 3.2
"""What is heard again so soon [m], or after so many readings, as far away as before, is the same neighbour."""
SPLIT_OFF = 0.08
BEND = 0.3
"""Its end was none if the distance did not grow by so much per metre: past a corner it grows by 0.4 and more."""
LONG_STEADY = 5
MANY = 8.0
FEW = 3.0
MORE = 2.0
ALONG = 4
UNSEEN_BEFORE = 10.0
"""A neighbour that was there before it was near enough to be looked at is taken to have begun so much [m] before: one
that was heard in so many level steps by then."""
LEVEL = 2
"""So many steps in a row that are level: a side that goes on; so many in a gap: its kerb or wall."""
AGREE = 0.15
"""Echoes of the same kerb or wall differ by no more than this [m]."""
STAGGER = 0.3
"""The next neighbour may stand this much [m] further in."""
FURTHER = 1.0
"""It may be this much [m] further away than the farthest first neighbour looked at: cars drive away from the row."""


class SideState(NamedTuple):
    """Everything remembered of one side."""

    mode: int = NOTHING
    n: float = 0.0
    """Readings in the bin being filled, and their sums."""
    u: float = 0.0
    w: float = 0.0
    r: float = 0.0
    last: Heard = Heard()
    """Last full bin."""
    spacing: float = 0.0
    """Way [m] from the bin before to the last one."""
    steady: int = 0
    """Bins in a row whose distance does not change steeply."""
    begun: float = 0.0
    """Where the neighbour in hand began [m]."""
    extent: float = 0.0
    """Length seen of the first neighbour [m]."""
    missed: float = 0.0
    """Where the neighbour was not heard any more [m]."""
    taken: int = 0
    """Samples kept of the next neighbour's beginning."""
    samples: tuple[Heard, ...] = NO_SAMPLES
    sums: Sums = Sums()
    """Of the neighbour in hand."""
    spare: Sums = Sums()
    """Of it, before they began anew: they count until there are enough of the new ones."""
    before: Sums = Sums()
    """Of the neighbour before the gap."""
    edge: float = 0.0
    """u of corner A [m]."""
    depth: float = DEEP
    found: int = 0
    """Counts the gaps between two neighbours; a slot is new or better whenever ``fresh``."""
    fresh: bool = False
    edge_b: float = 0.0
    """u of corner B [m]."""
    faces: tuple[Heard, ...] = NO_SAMPLES
    """Newest samples past corner A or short of corner B, where the cone's edge touches the neighbour's end."""
    behind: Sums = Sums()
    """Of the kerb or wall that the gap ends at."""
    first: Heard = Heard()
    """Of the neighbour in hand: its first corner, or near it; of none if it was there before it was looked at."""
    window: tuple[Heard, ...] = NO_WINDOW
    """Newest samples of the neighbour in hand, of its corners too."""
    ends: tuple[Heard, ...] = NO_SAMPLES
    """In a gap: the newest samples of the neighbour before it."""


EMPTY = Sums()
START = SideState()


def hear(side: SideState, u: float, w: float, r: float, half_angle: float, params: SearchParams) -> SideState:
    """Return the side after one reading: bins are closed after about 15 cm, or where the distance jumps."""
    if side.n > 0.0:
        mean = side.r / side.n
        first = side.u / side.n
        full = abs(u - first) >= 0.5 * BIN or abs(r - mean) > params.step
        if full:
            sample = Heard(first, side.w / side.n, mean)
            side = _sampled(side._replace(n=0.0, u=0.0, w=0.0, r=0.0), sample, half_angle, params)
            return side._replace(n=1.0, u=u, w=w, r=r)
        return side._replace(n=side.n + 1.0, u=side.u + u, w=side.w + w, r=side.r + r, fresh=False)
    return side._replace(n=1.0, u=u, w=w, r=r, fresh=False)


def _sampled(side: SideState, sample: Heard, half_angle: float, params: SearchParams) -> SideState:
    """Return the side after one full bin."""
    near = sample.r < params.beside
    way = sample.u - side.last.u
    change = sample.r - side.last.r - _change_along(side, sample)
    level = way > 0.0 and abs(change) <= FLAT * way + STEP
    steady = side.steady + 1 if level else 0
    cut = side.steady >= ALONG
    side = side._replace(last=sample, spacing=way, steady=steady, fresh=False)
    if side.mode == NOTHING:
        side = _from_afar(side, sample, params)
        return _comes_near(side, sample, cut) if near else side
    if side.mode == WALL:
        return _on_wall(side, sample, half_angle, params)
    if side.mode == GAP:
        return _in_gap(side, sample, change > STEEP * way, half_angle, params)
    return _on_next_wall(side, sample, half_angle, params)


def _from_afar(side: SideState, sample: Heard, params: SearchParams) -> SideState:
    """Return the side before a neighbour, with the begin of what is heard farther away than neighbours are looked at."""
    bridged = max(SPLIT, SPLIT_READINGS * side.spacing)
    if sample.r >= DEEP:
        return side if sample.u - side.missed < bridged else side._replace(first=Heard())
    begun = side.first.r <= 0.0 or sample.u - side.missed > bridged or _is_closing(side.first, sample)
    begun = begun or abs(sample.r - side.samples[0].r) > params.step + STEEPEST * (sample.u - side.missed)
    return side._replace(
        first=sample if begun else side.first, missed=sample.u, samples=remember(side.samples, sample)
    )


def _is_closing(first: Heard, sample: Heard) -> bool:
    """Return whether what was heard ``first`` came nearer since as no side does, however it slants: it is the begin."""
    return sample.r < first.r - CLOSING - STEEPEST * (sample.u - first.u)


def _comes_near(side: SideState, sample: Heard, cut: bool) -> SideState:
    """Return the side at whose first neighbour is near enough to be looked at; ``cut``: it was heard before."""
    first = side.first
    side = _begin_wall(side, sample)
    if first.u < sample.u:
        return side._replace(begun=first.u, first=first)
    return side._replace(begun=sample.u - UNSEEN_BEFORE, first=Heard()) if cut else side


def _change_along(side: SideState, sample: Heard) -> float:
    """Return how the distance [m] to the side known, or to a wall along it, changes from the last bin to this one."""
    known = side.sums if side.mode == WALL else side.before
    if known.n < MANY:
        return 0.0
    line = _line(known, EMPTY)
    return distance(line, sample.u, sample.w) - distance(line, side.last.u, side.last.w)


def _line(sums: Sums, other: Sums) -> FittedLine:
    b = clamp(leaning(other, sums) if other.n > 0.0 else slope(sums, EMPTY), -STEEPEST, STEEPEST)
    return FittedLine(offset(sums, b), b)


def _on_wall(side: SideState, sample: Heard, half_angle: float, params: SearchParams) -> SideState:
    expected = side.samples[0].r if side.samples[0].r > 0.0 else sample.r
    most = expected + params.step
    least = expected - params.step
    if side.sums.n >= 3.0:
        most = _still_heard(side.sums, EMPTY, sample, -1.0, half_angle)
        least = distance(_line(side.sums, EMPTY), sample.u, sample.w) - params.step
    if sample.r < least:
        return _begin_wall(side, sample)
    if sample.r <= most:
        window = newest(side.window, sample)
        sums = _with_sample(side.sums, EMPTY, sample, side.steady)
        spare = side.sums if sums.n < side.sums.n and side.sums.n >= 3.0 else side.spare
        fresh = side.found > 0 and side.steady >= 2 and side.mode == WALL and side.edge_b > side.edge
        closing = _is_closing(side.first, sample)
        first = sample if closing else side.first
        samples = remember(side.samples, sample)
        return side._replace(
            mode=WALL,
            begun=first.u if closing else side.begun,
            first=first,
            missed=samples[0].u,
            samples=samples,
            sums=sums,
            spare=spare,
            fresh=fresh,
            faces=NO_SAMPLES,
            window=window,
        )
    side = side._replace(faces=remember(side.faces, sample))
    return side if sample.u - side.missed < _confirmed(side) else _ended(side, half_angle, params)


def _ended(side: SideState, half_angle: float, params: SearchParams) -> SideState:
    """Return the side past a neighbour's end: in the gap after it, or anew where too little was heard of it."""
    extent = side.missed - side.begun
    side = side._replace(sums=side.spare) if side.sums.n < 3.0 else side
    side = side._replace(sums=_or_agreed(side.sums, side.window, EMPTY)) if side.sums.n < MANY else side
    if side.sums.n < 3.0 or extent < params.wall or abs(slope(side.sums, EMPTY)) > STEEPEST:
        return _anew(side)._replace(first=side.first, missed=side.missed, samples=side.samples)
    edge = corner(side.samples + side.faces, _line(side.sums, EMPTY), -1.0, half_angle)
    extent = edge - side.begun - _short_of_it(side)
    return _anew(side)._replace(
        mode=GAP,
        begun=side.begun,
        extent=extent,
        missed=side.missed,
        before=side.sums,
        edge=edge,
        first=side.first,
        window=side.window,
        ends=side.samples if _is_split(side.samples[0], side.faces) else NO_SAMPLES,
    )


def _with_sample(sums: Sums, other: Sums, sample: Heard, steady: int) -> Sums:
    """Return the sums with a sample that belongs to the flat side, not to its corner.

    A corner is heard further away than the side's line: such a sample is left out. While the samples are few,
    one that is nearer, or one of many in a row that are level, shows that those before it were of the corner:
    the sums begin anew. How far off is too far follows from how unsure the line is itself.
    """
    if steady < 2:
        return sums
    if sums.n >= 4.0 or (sums.n > 0.0 and other.n >= 4.0):
        off = sample.r - distance(_line(sums, other), sample.u, sample.w)
        beyond = sample.u - sums.u / sums.n
        told = spread(sums) + (OFF * OFF / (ASKEW * ASKEW) if other.n > 0.0 else 0.0)
        band = BAND + SPREAD * math.sqrt(1.0 / sums.n + beyond * beyond / told)
        if abs(off) > band and (sums.n >= MANY or (off > 0.0 and steady < LONG_STEADY)):
            return sums
        if abs(off) > band:
            sums = EMPTY
    return add(sums, sample.u, sample.w, sample.r)


def _short_of_it(side: SideState) -> float:
    """Return how far [m] ahead of the sensor the neighbour's first corner was where it was first heard."""
    if side.first.r <= 0.0:
        return 0.0
    d = distance(_line(side.sums, EMPTY), side.first.u, side.first.w)
    e = math.sqrt(max(0.0, side.first.r * side.first.r - d * d))
    return min(e, 0.6 * d) if d > 0.0 else 0.0


def _or_agreed(sums: Sums, window: tuple[Heard, ...], before: Sums) -> Sums:
    """Return the sums of a side that has ended, or of the samples that agree on a line, if those are plainly more."""
    told = agreed(window, STEEPEST, before.n >= FEW, slope(before, EMPTY))
    return told if told.n >= FEW and told.n > sums.n + MORE else sums


def _confirmed(side: SideState) -> float:
    """Return how far [m] a neighbour must not have been heard to have ended: never so short that one echo tells it."""
    return max(CONFIRMED, TWO * side.spacing)


def _still_heard(sums: Sums, other: Sums, sample: Heard, sense: float, half_angle: float) -> float:
    """Return the largest distance [m] at which a sensor there hears a side or its corner, with 2 cm for noise."""
    line = _line(sums, other)
    return 1.03 * distance(line, sample.u, sample.w) * seen_up_to(line, sense, half_angle) + 0.02


def _in_gap(side: SideState, sample: Heard, leaves: bool, half_angle: float, params: SearchParams) -> SideState:
    """Return the side after a bin in a gap; ``leaves``: it goes away steeply, as the end of a neighbour does."""
    if _goes_on(side, sample):
        return _gone_on(side, sample)
    side = side if sample.r >= DEEP else side._replace(ends=NO_SAMPLES)
    d = distance(_line(side.before, EMPTY), sample.u, sample.w)
    most = _still_heard(side.before, EMPTY, sample, 1.0, half_angle) + STAGGER + LEANS * (sample.u - side.edge)
    if sample.r < most and sample.r < params.beside + FURTHER and not leaves:
        return side._replace(
            mode=NEXT_WALL,
            steady=0,
            begun=sample.u,
            missed=sample.u,
            taken=1,
            samples=append(NO_SAMPLES, sample, 0),
            sums=EMPTY,
            fresh=False,
            edge_b=0.0,
            window=newest(NO_WINDOW, sample),
            ends=NO_SAMPLES,
        )
    depth = side.depth
    behind = side.behind
    agree = AGREE + LEANS * (sample.u - behind.u / behind.n if behind.n > 0.0 else 0.0)
    if side.steady >= LEVEL and sample.r < params.beside + 2.4 and sample.r - d < depth + agree:
        behind = add(behind if sample.r - d > depth - agree else EMPTY, sample.u, sample.w, sample.r)
        depth = sample.r - d if sample.r - d < depth else depth
    return side._replace(
        mode=GAP,
        taken=0,
        samples=NO_SAMPLES,
        sums=EMPTY,
        depth=depth,
        fresh=False,
        edge_b=0.0,
        faces=remember(side.faces, sample),
        behind=behind,
    )


def _goes_on(side: SideState, sample: Heard) -> bool:
    """Return whether a sample in a gap is of the neighbour before it: lost echoes, or a bad line, were no end of it."""
    end = side.ends[0]
    way = sample.u - end.u
    if end.r <= 0.0 or way > max(SPLIT, SPLIT_READINGS * side.spacing):
        return False
    if not _is_level(end, sample):
        return False
    before = end
    for older in side.ends:
        if older.r > 0.0 and (before.u >= end.u or end.u - older.u <= SPLIT):
            before = older
    return before.u < end.u and end.r - before.r <= BEND * (end.u - before.u)


def _is_level(end: Heard, sample: Heard) -> bool:
    """Return whether a sample is as far away as the last one before an end, but for how a side may slant."""
    return abs(sample.r - end.r) <= SPLIT_OFF + STEEPEST * (sample.u - end.u)


def _is_split(end: Heard, past: tuple[Heard, ...]) -> bool:
    """Return whether the samples past an end are lost echoes, or level: then it may be none."""
    for sample in past:
        if 0.0 < sample.r < DEEP and not _is_level(end, sample):
            return False
    return True


def _gone_on(side: SideState, sample: Heard) -> SideState:
    """Return the side on the neighbour before a gap that was none: its line begins anew."""
    return _anew(side)._replace(
        mode=WALL,
        begun=side.begun,
        first=side.first,
        missed=sample.u,
        samples=remember(side.ends, sample),
        spare=side.before,
        window=newest(side.window, sample),
    )


def _on_next_wall(side: SideState, sample: Heard, half_angle: float, params: SearchParams) -> SideState:
    if abs(sample.r - side.samples[0].r) > 2.0 * params.step + 0.4:
        if sample.u - side.missed < _confirmed(side):
            return side
        told = _or_agreed(EMPTY, side.window, side.before)
        if side.missed - side.begun >= params.wall and told.n > 0.0:
            return _found(side._replace(sums=told), half_angle)
        return side._replace(
            mode=GAP, steady=0, taken=0, samples=NO_SAMPLES, sums=EMPTY, fresh=False, edge_b=0.0, faces=NO_SAMPLES
        )
    earlier = side.samples[side.taken - 1]
    steep = side.taken < KEPT and sample.r - earlier.r < -STEEP * (sample.u - earlier.u)
    faces = remember(side.faces, earlier) if steep else side.faces
    taken = 0 if steep else side.taken
    samples = append(NO_SAMPLES if steep else side.samples, sample, taken)
    side = side._replace(
        mode=NEXT_WALL,
        missed=sample.u,
        taken=taken + 1 if taken < KEPT else KEPT,
        samples=samples,
        sums=_with_sample(side.sums, side.before, sample, side.steady),
        fresh=False,
        edge_b=0.0,
        faces=faces,
        window=newest(side.window, sample),
    )
    if sample.u - side.begun < params.wall or side.sums.n < 2.0:
        return side
    return _found(side, half_angle)._replace(samples=remember(NO_SAMPLES, sample))


def _found(side: SideState, half_angle: float) -> SideState:
    """Return the side on which the next neighbour is told from here on: the gap before it ends at its corner."""
    b = leaning(side.before, side.sums)
    line = FittedLine(offset(side.sums, b), b)
    edge_b = corner(side.samples + side.faces, line, 1.0, half_angle)
    return side._replace(
        mode=WALL,
        begun=edge_b,
        first=Heard(),
        spare=EMPTY,
        found=side.found + 1,
        fresh=True,
        edge_b=edge_b,
        faces=NO_SAMPLES,
    )


def _begin_wall(side: SideState, sample: Heard) -> SideState:
    window = newest(NO_WINDOW, sample)
    return _anew(side)._replace(
        mode=WALL, begun=sample.u, first=sample, missed=sample.u, samples=remember(NO_SAMPLES, sample), window=window
    )


def _anew(side: SideState) -> SideState:
    """Return the side as it starts, but for the bin being filled, the last one and the gaps counted."""
    return START._replace(
        n=side.n, u=side.u, w=side.w, r=side.r, last=side.last, spacing=side.spacing, found=side.found
    )
