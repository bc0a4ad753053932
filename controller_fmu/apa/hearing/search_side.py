"""What one side sensor has heard on the way past: a neighbour, a gap, the next neighbour.

Coordinates: u along the car's heading when the search began, w to the road (away from the slots), both
mirrored on the left side. Distances are averaged over about 15 cm of way before they are used.
"""

import math

from controller_fmu.apa.hearing.consensus import NO_WINDOW, agreed, taken_up
from controller_fmu.apa.hearing.edge import KEPT, NO_SAMPLES, Heard, append, corner, remember
from controller_fmu.apa.hearing.line_fit import (
    FittedLine,
    add,
    distance,
    leaning,
    offset,
    slope,
)
from controller_fmu.apa.hearing.neighbour import (
    STEEPEST,
    comes_near,
    from_afar,
    goes_on,
    gone_on,
    is_between,
    is_closing,
    is_split,
)
from controller_fmu.apa.hearing.side import (
    DEEP,
    EMPTY,
    GAP,
    NEXT_WALL,
    NOTHING,
    WALL,
    SideState,
    anew,
    begin_wall,
    confirmed,
)
from controller_fmu.apa.hearing.side_line import FEW, MANY, line_of, or_agreed, still_heard, with_sample
from controller_fmu.apa.params import SearchParams

BIN = 0.16
FLAT = 0.16
STEP = 0.016
"""Steeper than ``FLAT`` [m/m], ``STEP`` [m] for noise, the distance does not belong to a flat side along the road."""
LEANS = 0.1
"""A neighbour, or the wall, lies so much [m] off per metre along the line of the neighbour before."""
STEEP = 1.0
"""The face of a neighbour across the way comes nearer by 1 / sin(g) per metre, its corner by sin(g) at most."""
RISES = 0.2
"""A neighbour whose line is not sure has not ended before a sample is so much [m] farther off than the last one."""
LEVEL = 2
"""So many steps in a row that are level: a side that goes on; so many in a gap: its kerb or wall."""
AGREE = 0.15
"""Echoes of the same kerb or wall differ by no more than this [m]."""
STAGGER = 0.3
"""The next neighbour may stand this much [m] further in."""
FURTHER = 1.0
"""It may be this much [m] further away than the farthest first neighbour looked at: cars drive away from the row."""


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
    side = side._replace(last=sample, spacing=way, steady=steady, fresh=False)
    if side.mode == NOTHING:
        side = from_afar(side, sample, params)
        return comes_near(side, sample) if near else side
    if side.mode == WALL:
        return _on_wall(side, sample, half_angle, params)
    if side.mode == GAP:
        return _in_gap(side, sample, change > STEEP * way, half_angle, params)
    return _on_next_wall(side, sample, half_angle, params)


def _change_along(side: SideState, sample: Heard) -> float:
    """Return how the distance [m] to the side known, or to a wall along it, changes from the last bin to this one."""
    known = side.sums if side.mode == WALL else side.before
    if known.n < MANY:
        return 0.0
    line = line_of(known, EMPTY)
    return distance(line, sample.u, sample.w) - distance(line, side.last.u, side.last.w)


def _on_wall(side: SideState, sample: Heard, half_angle: float, params: SearchParams) -> SideState:
    expected = side.samples[0].r if side.samples[0].r > 0.0 else sample.r
    most = _farthest(side, sample, expected, half_angle, params)
    least = expected - params.step
    if side.sums.n >= FEW:
        least = distance(line_of(side.sums, EMPTY), sample.u, sample.w) - params.step
    if sample.r < least:
        return begin_wall(side, sample)
    if sample.r <= most and max(side.sums.n, side.spare.n) >= FEW and is_between(side, sample):
        ended = _ended(side, half_angle, params)
        if ended.mode == GAP:
            return _in_gap(ended, sample, False, half_angle, params)
    if sample.r <= most:
        window = taken_up(side.window, sample)
        sums = with_sample(side.sums, EMPTY, sample, side.steady)
        spare = side.sums if sums.n < side.sums.n and side.sums.n >= 3.0 else side.spare
        second = side.found > 0 and side.edge_b > side.edge
        sums = or_agreed(sums, window, side.before) if second else sums
        fresh = second and sums.n >= FEW
        closing = is_closing(side.first, sample)
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
    return side if sample.u - side.missed < confirmed(side) else _ended(side, half_angle, params)


def _farthest(side: SideState, sample: Heard, expected: float, half_angle: float, params: SearchParams) -> float:
    """Return the largest distance [m] at which a sample is of the neighbour in hand; ``expected``: the last one's."""
    known = side.sums if side.sums.n >= FEW else side.spare
    known = known if known.n >= FEW else agreed(side.window, STEEPEST, False, 0.0)
    if known.n < FEW:
        return expected + params.step
    rises = expected + RISES if side.sums.n < FEW else 0.0
    return max(rises, still_heard(known, EMPTY, sample, -1.0, half_angle))


def _ended(side: SideState, half_angle: float, params: SearchParams) -> SideState:
    """Return the side past a neighbour's end: in the gap after it, or anew where too little was heard of it."""
    extent = side.missed - side.begun
    side = side._replace(sums=side.spare) if side.sums.n < 3.0 else side
    side = side._replace(sums=or_agreed(side.sums, side.window, EMPTY))
    if side.sums.n < 3.0 or extent < params.wall or abs(slope(side.sums, EMPTY)) > STEEPEST:
        return anew(side)._replace(first=side.first, missed=side.missed, samples=side.samples)
    edge = corner(side.samples + side.faces, line_of(side.sums, EMPTY), -1.0, half_angle)
    extent = edge - side.begun - _short_of_it(side)
    return anew(side)._replace(
        mode=GAP,
        begun=side.begun,
        extent=extent,
        missed=side.missed,
        before=side.sums,
        edge=edge,
        first=side.first,
        window=side.window,
        ends=side.samples if is_split(side.samples[0], side.faces) else NO_SAMPLES,
    )


def _short_of_it(side: SideState) -> float:
    """Return how far [m] ahead of the sensor the neighbour's first corner was where it was first heard."""
    if side.first.r <= 0.0:
        return 0.0
    d = distance(line_of(side.sums, EMPTY), side.first.u, side.first.w)
    e = math.sqrt(max(0.0, side.first.r * side.first.r - d * d))
    return min(e, 0.6 * d) if d > 0.0 else 0.0


def _in_gap(side: SideState, sample: Heard, leaves: bool, half_angle: float, params: SearchParams) -> SideState:
    """Return the side after a bin in a gap; ``leaves``: it goes away steeply, as the end of a neighbour does."""
    if goes_on(side, sample):
        return gone_on(side, sample)
    side = side if sample.r >= DEEP else side._replace(ends=NO_SAMPLES)
    d = distance(line_of(side.before, EMPTY), sample.u, sample.w)
    most = still_heard(side.before, EMPTY, sample, 1.0, half_angle) + STAGGER + LEANS * (sample.u - side.edge)
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
            window=taken_up(NO_WINDOW, sample),
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


def _on_next_wall(side: SideState, sample: Heard, half_angle: float, params: SearchParams) -> SideState:
    if abs(sample.r - side.samples[0].r) > 2.0 * params.step + 0.4:
        if sample.u - side.missed < confirmed(side):
            return side
        told = or_agreed(EMPTY, side.window, side.before)
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
        sums=with_sample(side.sums, side.before, sample, side.steady),
        fresh=False,
        edge_b=0.0,
        faces=faces,
        window=taken_up(side.window, sample),
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
