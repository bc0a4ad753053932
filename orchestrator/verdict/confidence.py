"""How sure a success rate is."""

import math

Z95 = 1.959963984540054
"""Of the normal distribution: 95 % of it lie within +-Z95."""


def wilson(successes: int, count: int) -> tuple[float, float]:
    """Return the 95 % confidence interval of a success rate (Wilson 1927)."""
    if count == 0:
        return 0.0, 1.0
    p, z2 = successes / count, Z95 * Z95
    middle = p + z2 / (2.0 * count)
    half = Z95 * math.sqrt(p * (1.0 - p) / count + z2 / (4.0 * count * count))
    scale = 1.0 + z2 / count
    low = (middle - half) / scale if successes > 0 else 0.0
    high = (middle + half) / scale if successes < count else 1.0
    return low, high
