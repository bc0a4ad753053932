"""The line of a neighbour's side: which samples it is made of, and how far away the side is still heard."""

import math

from controller_fmu.apa.hearing.consensus import HeardSide, agreed, support
from controller_fmu.apa.hearing.edge import Heard, seen_up_to
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
from controller_fmu.apa.hearing.neighbour import STEEPEST
from controller_fmu.apa.hearing.side import EMPTY
from modelkit.maths import clamp

BAND = 0.02
SPREAD = 0.03
"""Further than this [m], and what the noise of the readings makes the line unsure by, is off the line."""
MANY = 8.0
FEW = 3.0
LONG_STEADY = 5
MORE = 2.0
MORE_IF_ALIKE = 0.5
"""So many more samples must speak for another line; for one of the second that is more like the first, fewer."""


def line_of(sums: Sums, other: Sums) -> FittedLine:
    """Return the line of a side; ``other``: of the neighbour before it, if any, which it stands about like."""
    b = clamp(leaning(other, sums) if other.n > 0.0 else slope(sums, EMPTY), -STEEPEST, STEEPEST)
    return FittedLine(offset(sums, b), b)


def with_sample(sums: Sums, other: Sums, sample: Heard, steady: int) -> Sums:
    """Return the sums with a sample that belongs to the flat side, not to its corner.

    A corner is heard further away than the side's line: such a sample is left out. While the samples are few,
    one that is nearer, or one of many in a row that are level, shows that those before it were of the corner:
    the sums begin anew. How far off is too far follows from how unsure the line is itself.
    """
    if steady < 2:
        return sums
    if sums.n >= 4.0 or (sums.n > 0.0 and other.n >= 4.0):
        off = sample.r - distance(line_of(sums, other), sample.u, sample.w)
        beyond = sample.u - sums.u / sums.n
        told = spread(sums) + (OFF * OFF / (ASKEW * ASKEW) if other.n > 0.0 else 0.0)
        band = BAND + SPREAD * math.sqrt(1.0 / sums.n + beyond * beyond / told)
        if abs(off) > band and (sums.n >= MANY or (off > 0.0 and steady < LONG_STEADY)):
            return sums
        if abs(off) > band:
            sums = EMPTY
    return add(sums, sample.u, sample.w, sample.r)


def or_agreed(sums: Sums, window: HeardSide, before: Sums) -> Sums:
    """Return the sums of a side, or of the samples that agree on a line, if plainly more samples speak for that one."""
    told = agreed(window, STEEPEST, before.n >= FEW, slope(before, EMPTY))
    if told.n < FEW or sums.n < FEW:
        return told if told.n >= FEW else sums
    other, line = line_of(told, before), line_of(sums, before)
    first = slope(before, EMPTY)
    alike = before.n >= FEW and abs(other.b - first) <= abs(line.b - first)
    better = support(window, other) - support(window, line)
    return told if better > (MORE_IF_ALIKE if alike else MORE) else sums


def still_heard(sums: Sums, other: Sums, sample: Heard, sense: float, half_angle: float) -> float:
    """Return the largest distance [m] at which a sensor there hears a side or its corner, with 2 cm for noise."""
    line = line_of(sums, other)
    return 1.03 * distance(line, sample.u, sample.w) * seen_up_to(line, sense, half_angle) + 0.02
