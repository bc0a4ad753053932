"""Where a neighbour's side ends, from the last (or first) distances heard of it.

Past the corner the sensor hears the corner itself, at r = sqrt(d^2 + e^2): d the distance to the side's
line, e how far the corner lies behind (or ahead) along it, until the corner leaves the cone of half
angle g at e = d tan(g). So e = sqrt(r^2 - d^2), and each sample tells the corner anew.
"""

import math
from typing import NamedTuple

from controller_fmu.apa.hearing.line_fit import FittedLine, distance


class Heard(NamedTuple):
    """One sample: sensor at (u, w), distance r; r <= 0: none."""

    u: float = 0.0
    w: float = 0.0
    r: float = 0.0


KEPT = 4
NO_SAMPLE = Heard(0.0, 0.0, 0.0)
NO_SAMPLES = (NO_SAMPLE,) * KEPT
SHALLOW = 0.03
DEEPEST = 0.8
"""A sample tells the neighbour's end if it was heard between so far [m] behind its side."""
TELLING = 1.03
"""A sample tells the corner well if r is larger than the distance to the line by this factor."""
UNTOLD = 0.25
"""A sample that does not tell the corner lies at most this times d short of it: sqrt(1.03^2 - 1)."""


def seen_up_to(line: FittedLine, sense: float, half_angle: float) -> float:
    """Return r / d at which the corner leaves the cone, the car driving along u: 1 / cos(g - sense beta)."""
    return 1.0 / math.cos(half_angle - sense * math.atan(line.b))


def remember(samples: tuple[Heard, ...], new: Heard) -> tuple[Heard, ...]:
    """Return the samples with a new one first, the oldest dropped."""
    return (new, samples[0], samples[1], samples[2])


def append(samples: tuple[Heard, ...], new: Heard, count: int) -> tuple[Heard, ...]:
    """Return the samples with a new one at place ``count``; unchanged if all places are taken."""
    return (
        new if count == 0 else samples[0],
        new if count == 1 else samples[1],
        new if count == 2 else samples[2],
        new if count == 3 else samples[3],
    )


def corner(samples: tuple[Heard, ...], line: FittedLine, sense: float, half_angle: float) -> float:
    """Return u [m] of the corner on ``line``; ``sense`` -1: it lies behind the sensor, 1: ahead.

    The mean over the samples that tell it, weighted by how well, those of the end most. If none does, the
    corner lies between what the outermost sample still heard and what the next one, one spacing on, did not:
    the middle.
    """
    total = 0.0
    weights = 0.0
    outermost = NO_SAMPLE
    spacing = abs(samples[0].u - samples[1].u) if samples[1].r > 0.0 else 0.0
    cos = 1.0 / math.sqrt(1.0 + line.b * line.b)
    most = seen_up_to(line, sense, half_angle)
    across = math.sqrt(1.0 - 1.0 / (most * most))
    for sample in samples:
        d = distance(line, sample.u, sample.w)
        if sample.r > 0.0 and d > 0.0 and sample.r <= 1.01 * most * d + 0.01:
            if sample.r > TELLING * d:
                e = math.sqrt(sample.r * sample.r - d * d)
                weight = e * e / (sample.r * sample.r)
                total += weight * (sample.u + cos * (line.b * d + sense * e))
                weights += weight
            if outermost.r <= 0.0 or sense * (sample.u - outermost.u) < 0.0:
                outermost = sample
        elif SHALLOW < sample.r / most - d < DEEPEST and d > 0.0:
            total += sample.u + cos * (line.b * d + sense * across * sample.r)
            weights += 1.0
    if weights > 0.0:
        return total / weights
    d = distance(line, outermost.u, outermost.w)
    e = 0.5 * (d * math.sqrt(most * most - 1.0) - spacing + d * UNTOLD)
    return outermost.u + cos * (line.b * d + sense * e)
