"""The table of sines and cosines that ``lane_math.h`` starts from: as glibc's, each number in two doubles."""

from collections.abc import Iterator
from decimal import Decimal, localcontext
from functools import cache

ANGLE_COUNT = 128
ANGLE_STEP = Decimal(1) / 128
"""From one angle of the table to the next [rad]; the largest that is looked up is 0.86."""
SERIES_TERMS = 40
"""Of the power series: beyond it they are below 1e-40."""


@cache
def sine_table() -> str:
    """Return the table as a C file: sine and its rest, cosine and its rest, for 0, 1/128, 2/128, ... rad."""
    with localcontext() as context:
        context.prec = 50
        rows = [", ".join(part.hex() for part in parts(number * ANGLE_STEP)) for number in range(ANGLE_COUNT)]
    lines = "".join(f"    {{{row}}},\n" for row in rows)
    return f"#define LANE_SINES {ANGLE_COUNT}\nstatic const double lane_sines[LANE_SINES][4] = {{\n{lines}}};\n"


def parts(angle: Decimal) -> Iterator[float]:
    """Yield sine and cosine of an angle [rad], each as the nearest double and what it leaves over."""
    term = Decimal(1)
    sums = [Decimal(0), Decimal(0)]
    for number in range(SERIES_TERMS):
        sums[(number + 1) % 2] += -term if number & 2 else term
        term *= angle / (number + 1)
    for whole in sums:
        yield float(whole)
        yield float(whole - Decimal(float(whole)))
