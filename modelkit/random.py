"""A small random generator whose whole state is one 32-bit integer in the model's state.

xorshift32 (Marsaglia 2003, "Xorshift RNGs", triple 13, 17, 5): period 2^32 - 1. Shifts and
masks only, so that CPython's integers and 64-bit machine integers agree. It is linear in its bits: numbers
of neighbouring seeds are uniform each, but correlate a little with each other (first ones: 0.08).
"""

import math

from modelkit.maths import TWO_PI

UINT32_MASK = 0xFFFFFFFF


def seed_state(seed: int) -> int:
    """Return a non-zero generator state for any integer ``seed``, well mixed by 16 rounds."""
    state = (seed ^ 0x6A09E667) & UINT32_MASK
    if state == 0:
        state = 0x3C6EF372
    for _ in range(16):
        state = next_state(state)
    return state


def next_state(state: int) -> int:
    """Return the next generator state, in [1, 2^32 - 1]."""
    state = state ^ ((state << 13) & UINT32_MASK)
    state = state ^ (state >> 17)
    return state ^ ((state << 5) & UINT32_MASK)


def uniform(state: int) -> tuple[int, float]:
    """Return (new state, a number in (0, 1))."""
    state = next_state(state)
    return state, state / 4294967296.0


def normal(state: int) -> tuple[int, float]:
    """Return (new state, a standard normal number), by Box and Muller's transform."""
    state, first = uniform(state)
    state, second = uniform(state)
    return state, math.sqrt(-2.0 * math.log(first)) * math.cos(TWO_PI * second)
