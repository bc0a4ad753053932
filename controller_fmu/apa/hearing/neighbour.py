"""One neighbour is one: where it begins, farther away than it is looked at, and that it goes on past lost echoes."""

from controller_fmu.apa.hearing.consensus import taken_up
from controller_fmu.apa.hearing.edge import Heard, remember
from controller_fmu.apa.hearing.side import DEEP, WALL, SideState, anew, begin_wall
from controller_fmu.apa.params import SearchParams

STEEPEST = 0.28
"""A side slants by no more than this [m/m]."""
CLOSING = 0.2
"""A neighbour has not begun while it comes nearer by so much [m] more than a slanting side does."""
SPLIT = 0.6
SPLIT_READINGS = 3.2
"""What is heard again so soon [m], or after so many readings, as far away as before, is the same neighbour."""
SPLIT_OFF = 0.08
BEND = 0.3
"""Its end was none if the distance did not grow by so much per metre: past a corner it grows by 0.4 and more."""


def from_afar(side: SideState, sample: Heard, params: SearchParams) -> SideState:
    """Return the side before a neighbour: where it begins that is heard, farther away than it is looked at."""
    bridged = max(SPLIT, SPLIT_READINGS * side.spacing)
    if sample.r >= DEEP:
        return side if sample.u - side.missed < bridged else side._replace(first=Heard())
    begun = side.first.r <= 0.0 or sample.u - side.missed > bridged or is_closing(side.first, sample)
    begun = begun or abs(sample.r - side.samples[0].r) > params.step + STEEPEST * (sample.u - side.missed)
    return side._replace(first=sample if begun else side.first, missed=sample.u, samples=remember(side.samples, sample))


def is_closing(first: Heard, sample: Heard) -> bool:
    """Return whether what was heard ``first`` came nearer since as no side does, however it slants: it is the begin."""
    return sample.r < first.r - CLOSING - STEEPEST * (sample.u - first.u)


def comes_near(side: SideState, sample: Heard) -> SideState:
    """Return the side at whose first neighbour is near enough to be looked at: it began where it was first heard."""
    return begin_wall(side, sample)._replace(begun=side.first.u, first=side.first)


def goes_on(side: SideState, sample: Heard) -> bool:
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
    return before.u < end.u and not _rises(before, end)


def _is_level(end: Heard, sample: Heard) -> bool:
    """Return whether a sample is as far away as the last one before an end, but for how a side may slant."""
    return abs(sample.r - end.r) <= SPLIT_OFF + STEEPEST * (sample.u - end.u)


def is_split(end: Heard, past: tuple[Heard, ...]) -> bool:
    """Return whether the samples past an end are lost echoes, or level: then it may be none."""
    return all(sample.r <= 0.0 or sample.r >= DEEP or _is_level(end, sample) for sample in past)


def gone_on(side: SideState, sample: Heard) -> SideState:
    """Return the side on the neighbour before a gap that was none: its line begins anew."""
    return anew(side)._replace(
        mode=WALL,
        begun=side.begun,
        first=side.first,
        missed=sample.u,
        samples=remember(side.ends, sample),
        spare=side.before,
        window=taken_up(side.window, sample),
    )


def is_between(side: SideState, sample: Heard) -> bool:
    """Return whether what was heard last lay in a gap so short that the next neighbour is heard already.

    The distance grew as past a corner, then beyond where a corner is heard, and falls again: no lost echo does so.
    """
    end = side.samples[0]
    beyond = side.faces[1] if side.faces[1].r > side.faces[0].r else side.faces[0]
    if not 0.0 < beyond.r < DEEP or side.samples[1].r <= 0.0:
        return False
    leaves = _rises(side.samples[1], end) and _rises(end, beyond)
    return leaves and beyond.r - sample.r > BEND * (sample.u - beyond.u)


def _rises(earlier: Heard, later: Heard) -> bool:
    """Return whether the distance grows from a sample to a later one as past a corner."""
    return later.r - earlier.r > BEND * (later.u - earlier.u)
