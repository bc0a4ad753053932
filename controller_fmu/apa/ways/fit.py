"""Whether a slot is long enough, for how many moves, and what is missing if not."""

from typing import NamedTuple

from controller_fmu.apa.outline import Shape
from controller_fmu.apa.params import ApaParams
from controller_fmu.apa.slot import UNSEEN, Kind, Margins, Slot, site_of
from controller_fmu.apa.ways.exit import VARIANTS, exit_of


class Fit(NamedTuple):
    """Whether a slot can be used."""

    fits: bool = False
    moves: int = 0
    """Moves that its shortest way takes at least."""
    missing: float = 0.0
    """Length (width) [m] that it lacks, >= 0."""
    shallow: bool = False
    """Long enough, but it ends before the car does."""


LONGEST_LACK = 3.0
HALVINGS = 5
SHARES = (1.0, 0.88, 0.855, 0.855, 0.6, 0.3)
"""Of the margins: planned with, if that saves manoeuvres, driven with once under way, and as a last resort."""
WALLS = (1.0, 0.88, 0.93, 0.855, 0.6, 0.3)
"""The same of the margin to kerb or wall, where the parked car leaves as much."""
LEVEL = 2
"""Attempts of the same margins: parked in line, and standing out a little."""
UNDER_WAY = 2
ATTEMPTS = 10
"""A slot is refused if none of these leads in."""
AFTER = (2, 3, 1, 8, 6, 7, 7, 8, 9, 9)
"""Which attempt follows which before a car sets out: closer in line, standing out, closer and standing out."""


def stands_out(attempt: int) -> bool:
    """Return whether the car may stand out of the slot a little in this attempt: in odd ones."""
    return attempt % LEVEL == 1


def under_way(attempt: int, wide: bool) -> int:
    """Return the attempt to plan with from within, as far out as this one; ``wide``: see :func:`is_wide`."""
    return LEVEL * (UNDER_WAY if wide else UNDER_WAY + 1) + attempt % LEVEL


def is_wide(attempt: int) -> bool:
    """Return whether a car under way is planned for with a wider margin to kerb or wall in this attempt."""
    return attempt // LEVEL == UNDER_WAY


def following(attempt: int, kind: int) -> int:
    """Return the attempt after this one for a car that has not set out; the same if there is none."""
    if kind == Kind.PARALLEL:
        return AFTER[attempt] if attempt < ATTEMPTS else attempt
    return attempt + LEVEL if attempt + LEVEL < ATTEMPTS else attempt


def closer(attempt: int) -> int:
    """Return the attempt with closer margins for a car under way; the same if there is none."""
    return attempt + LEVEL if attempt // LEVEL + 1 < len(SHARES) else attempt


def margins_of(attempt: int, params: ApaParams) -> Margins:
    """Return the margins of an attempt."""
    plan = params.plan
    inset = -plan.stand_out if stands_out(attempt) else 0.0
    share = SHARES[attempt // LEVEL]
    wall = WALLS[attempt // LEVEL] * plan.kerb_margin
    return Margins(share * plan.margin, share * plan.kerb_margin, inset, params.end.out, wall)


def fit_of(slot: Slot, car: Shape, params: ApaParams) -> Fit:
    """Return whether the car fits. Parallel: a way out of the slot exists within the shift limit; else by width."""
    length = car.front + car.rear
    width = 2.0 * car.half_width
    if slot.kind != Kind.PARALLEL:
        missing = max(0.0, width + params.search.perpendicular_room - slot.length)
        shallow = length - params.search.depth_room - slot.depth
        return Fit(missing <= 0.0 and shallow <= 0.0, 1, missing, missing <= 0.0 and shallow > 0.0)
    moves = least_moves(slot, car, params)
    if moves > 0:
        return Fit(True, moves, 0.0)
    if slot.depth < width + params.plan.kerb_margin and least_moves(slot._replace(depth=UNSEEN), car, params) > 0:
        return Fit(shallow=True)
    low = 0.0
    high = LONGEST_LACK
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if least_moves(_longer(slot, middle), car, params) > 0:
            high = middle
        else:
            low = middle
    return Fit(False, 0, high)


def least_moves(slot: Slot, car: Shape, params: ApaParams) -> int:
    """Return the fewest moves into a parallel slot, 0 if it takes more than allowed."""
    plan = params.plan
    if slot.length < car.front + car.rear + 2.0 * plan.margin + 0.1:
        return 0
    for attempt in range(ATTEMPTS):
        site = site_of(slot, car, margins_of(attempt, params))
        for variant in range(VARIANTS):
            way_in = exit_of(variant, site, car)
            if way_in.found and way_in.moves + 1 <= plan.manoeuvres:
                return way_in.moves + 1
    return 0


def _longer(slot: Slot, by: float) -> Slot:
    return slot._replace(length=slot.length + by)
