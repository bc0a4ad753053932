"""What is kept to on the way out of a slot: margins attempt by attempt, manoeuvres, moves cut short, the lock."""

from controller_fmu.apa.outline import Shape
from controller_fmu.apa.params import ApaParams
from controller_fmu.apa.slot import LESS_BESIDE, Margins
from controller_fmu.apa.ways.planner import FOUND, NOTHING, PlanSearch

MARGINS = (0.14, 0.1, 0.07, 0.045, 0.035)
MOVES = (4, 6, 10, 30, 30)
"""Distance kept to everything [m], attempt by attempt, and the moves up to which a way is looked for with it."""
AT_FIRST = 5
"""A car sets out with one of so many attempts; the last is for what it missed on the way."""
SHIFTS = 30
"""Most manoeuvres."""
CUTS = 30
"""A car whose moves were cut short more often than this finds no way."""
LOCK = 0.99
"""Planned curvature over the car's largest: what a move misses is planned anew at its end."""


def margins_out(attempt: int, params: ApaParams) -> Margins:
    """Return the margins of an attempt to come out."""
    return Margins(MARGINS[attempt], MARGINS[attempt] + LESS_BESIDE, 0.0, params.end.out)


def next_attempt_out(attempt: int, plan: PlanSearch, manoeuvres: int, direction: int) -> int:
    """Return the attempt to make after this plan, with closer margins where it leads nowhere or takes many moves.

    ``manoeuvres``: at the end of the plan; ``direction``: last driven, 0: the car has not set out.
    """
    closer = plan.status == NOTHING or (plan.status == FOUND and manoeuvres > SHIFTS)
    count = AT_FIRST if direction == 0 else len(MARGINS)
    return attempt + 1 if closer and attempt + 1 < count else attempt


def with_lock(car: Shape, params: ApaParams) -> Shape:
    """Return the car as it is planned with on the way out."""
    return car._replace(curvature=LOCK / params.plan.curvature_share * car.curvature)
