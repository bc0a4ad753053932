"""The side of a neighbour that most of the newest samples agree on: what noise or a slanting pass hides from the rest.

Each two samples that lie far enough apart tell a line; the one that most samples lie on is it. Samples of a corner
are heard further away than the side, never nearer, so a line that samples lie before is none.
"""

import math

from controller_fmu.apa.hearing.edge import Heard
from controller_fmu.apa.hearing.line_fit import FittedLine, Sums, add

WINDOW = 12
NO_WINDOW = (Heard(0.0, 0.0, 0.0),) * WINDOW
APART = 0.5
"""Two samples tell a line if they lie so far [m] apart."""
ON = 0.04
"""A sample is of the line up to so much [m]."""
BEFORE = 2.0
"""One that lies before it takes back so many that lie on it."""
TURNED = 0.12
"""A side leans against the one before by so much [m/m]; by twice that it loses what two samples tell."""


def newest(window: tuple[Heard, ...], sample: Heard) -> tuple[Heard, ...]:
    """Return the window with a new sample first, the oldest dropped."""
    return (sample,) + window[: WINDOW - 1]


def agreed(window: tuple[Heard, ...], steepest: float, known: bool, before: float) -> Sums:
    """Return the sums of the samples that lie on the line that most agree on; of none if no two tell one.

    ``steepest`` slope [m/m] of a line; ``before``: slope of the side before, if that is ``known``.
    """
    best = 0.0
    line = FittedLine()
    for one in window:
        for two in window:
            if two.r > 0.0 and one.u - two.u > APART:
                tried = _through(one, two)
                if abs(tried.b) <= steepest:
                    score = _score(window, tried)
                    if known:
                        lean = (tried.b - before) / TURNED
                        score -= 0.5 * lean * lean
                    if score > best:
                        best = score
                        line = tried
    sums = Sums()
    for sample in window:
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


def _score(window: tuple[Heard, ...], line: FittedLine) -> float:
    score = 0.0
    for sample in window:
        if sample.r > 0.0:
            off = _off(line, sample) / ON
            if off * off <= 1.0:
                score += 1.0 - 0.5 * off * off
            elif off < -1.0:
                score -= BEFORE
    return score
