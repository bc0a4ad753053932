"""How sure a rate is."""

import math
from statistics import NormalDist

Z = NormalDist().inv_cdf(0.975)
"""Two-sided 95 % quantile of the normal distribution."""


def wilson(successes: int, count: int) -> tuple[float, float]:
    """Return the 95 % confidence interval of a success rate (Wilson 1927); of no trials it is all there is, 0 to 1.

    (p + z^2 / 2n -+ z sqrt(p (1 - p) / n + z^2 / 4n^2)) / (1 + z^2 / n)
    """
    if count == 0:
        return 0.0, 1.0
    share = successes / count
    scale = 2.0 * (count + Z**2)
    centre = (2.0 * successes + Z**2) / scale
    half = Z * math.sqrt(4.0 * successes * (1.0 - share) + Z**2) / scale
    return 0.0 if successes == 0 else centre - half, 1.0 if successes == count else centre + half


def clopper_pearson(events: int, count: int, confidence: float = 0.95) -> tuple[float, float]:
    """Return the exact confidence interval of a probability (Clopper and Pearson 1934) from independent trials.

    Each end is one-sided at ``confidence``: the probability is below the upper one with that confidence. Of no events
    in n trials it is 1 - (1 - confidence)^(1/n), about 3.0 / n at 95 %.
    """
    from scipy.special import betaincinv  # slow to import

    low = 0.0 if events == 0 else float(betaincinv(events, count - events + 1, 1.0 - confidence))
    high = 1.0 if events == count else float(betaincinv(events + 1, count - events, confidence))
    return low, high


def percent_interval(events: int, count: int, digits: int = 2) -> str:
    """Return the exact two-sided 95 % interval of a probability in words: ``89.37 to 90.23 %``."""
    low, high = (f"{100.0 * end:.{digits}f}" for end in clopper_pearson(events, count, 0.975))
    return f"{low} to {high} %"
