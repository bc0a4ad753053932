"""The side that most of what is heard of a neighbour agrees on: what noise or a slanting pass hides from the rest.

All of a neighbour is kept, in places of equal way: when none is left, two by two become one of their mean. Each two
samples that lie far enough apart tell a line; the one that most samples lie on is it. Samples of a corner are heard
further away than the side, never nearer, so a line that samples lie before is none.
"""

import math
from typing import NamedTuple

from controller_fmu.apa.hearing.edge import NO_SAMPLE, Heard
from controller_fmu.apa.hearing.line_fit import FittedLine, Sums, add

PLACES = 16
NOTHING_HEARD = (NO_SAMPLE,) * PLACES
APART = 0.5
"""Two samples tell a line if they lie so far [m] apart."""
ON = 0.04
"""A sample is of the line up to so much [m]."""
BEFORE = 2.0
"""One that lies before it takes back so many that lie on it."""
TURNED = 0.12
"""A side leans against the one before by so much [m/m]; by twice that it loses what two samples tell."""


class HeardSide(NamedTuple):
    """What is heard of one neighbour, of its corners too: the newest sample first, r <= 0: none."""

    samples: tuple[Heard, ...] = NOTHING_HEARD
    each: int = 1
    """Samples of the search that one of these is the mean of."""
    held: int = 0
    """Samples in the next one, and their mean."""
    mean: Heard = NO_SAMPLE


NO_WINDOW = HeardSide()


def taken_up(window: HeardSide, sample: Heard) -> HeardSide:
    """Return the window with one more sample of the search."""
    held = window.held + 1
    share = 1.0 / held
    mean = Heard(
        window.mean.u + share * (sample.u - window.mean.u),
        window.mean.w + share * (sample.w - window.mean.w),
        window.mean.r + share * (sample.r - window.mean.r),
    )
    if held < window.each:
        return window._replace(held=held, mean=mean)
    samples = (mean,) + window.samples[: PLACES - 1]
    if samples[PLACES - 1].r <= 0.0:
        return HeardSide(samples, window.each)
    return HeardSide(_two_by_two(samples), 2 * window.each)


def _two_by_two(samples: tuple[Heard, ...]) -> tuple[Heard, ...]:
    """Return half as many samples, each the mean of two."""
    found = NOTHING_HEARD
    for number in range(PLACES // 2):
        one = samples[PLACES - 1 - 2 * number]
        two = samples[PLACES - 2 - 2 * number]
        both = Heard(0.5 * (one.u + two.u), 0.5 * (one.w + two.w), 0.5 * (one.r + two.r))
        found = (both,) + found[: PLACES - 1]
    return found


def agreed(window: HeardSide, steepest: float, known: bool, before: float) -> Sums:
    """Return the sums of the samples that lie on the line that most agree on; of none if no two tell one.

    ``steepest`` slope [m/m] of a line; ``before``: slope of the side before, if that is ``known``.
    """
    best = 0.0
    line = FittedLine()
    for one in window.samples:
        for two in window.samples:
            if two.r > 0.0 and one.u - two.u > APART:
                tried = _through(one, two)
                if abs(tried.b) <= steepest:
                    score = support(window, tried)
                    if known:
                        lean = (tried.b - before) / TURNED
                        score -= 0.5 * lean * lean
                    if score > best:
                        best = score
                        line = tried
    sums = Sums()
    for sample in window.samples:
        if best > 0.0 and sample.r > 0.0 and abs(_off(line, sample)) <= ON:
            sums = add(sums, sample.u, sample.w, sample.r)
    return sums


def _through(one: Heard, two: Heard) -> FittedLine:
    """Return the line whose distance both samples tell: w - r sqrt(1 + b^2) = a + b u."""
    b = 0.0
    for _ in range(2):
        stretch = math.sqrt(1.0 + b * b)
        b = (one.w - two.w - (one.r - two.r) * stretch) / (one.u - two.u)
    return FittedLine(one.w - one.r * math.sqrt(1.0 + b * b) - b * one.u, b)


def _off(line: FittedLine, sample: Heard) -> float:
    """Return by how much [m] a sample is heard further away than the line is."""
    return sample.r - (sample.w - line.a - line.b * sample.u) / math.sqrt(1.0 + line.b * line.b)


def support(window: HeardSide, line: FittedLine) -> float:
    """Return how many samples speak for a line, less those that speak against it."""
    score = 0.0
    for sample in window.samples:
        if sample.r > 0.0:
            off = _off(line, sample) / ON
            if off * off <= 1.0:
                score += 1.0 - 0.5 * off * off
            elif off < -1.0:
                score -= BEFORE
    return score
