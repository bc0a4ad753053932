"""How sure a rate is."""


def wilson(successes: int, count: int) -> tuple[float, float]:
    """Return the 95 % confidence interval of a success rate (Wilson 1927); of no trials it is all there is, 0 to 1."""
    return _interval(successes, count, 0.95, "wilson")


def clopper_pearson(events: int, count: int, confidence: float = 0.95) -> tuple[float, float]:
    """Return the exact confidence interval of a probability (Clopper and Pearson 1934) from independent trials.

    Each end is one-sided at ``confidence``: the probability is below the upper one with that confidence. Of no events
    in n trials it is 1 - (1 - confidence)^(1/n), about 3.0 / n at 95 %.
    """
    low, high = _interval(events, count, 2.0 * confidence - 1.0, "exact")
    return low, high


def percent_interval(events: int, count: int, digits: int = 2) -> str:
    """Return the exact two-sided 95 % interval of a probability in words: ``89.37 to 90.23 %``."""
    low, high = (f"{100.0 * end:.{digits}f}" for end in clopper_pearson(events, count, 0.975))
    return f"{low} to {high} %"


def _interval(events: int, count: int, confidence: float, method: str) -> tuple[float, float]:
    from scipy.stats import binomtest  # slow to import

    if count == 0:
        return 0.0, 1.0
    interval = binomtest(events, count).proportion_ci(confidence, method=method)
    return float(interval.low), float(interval.high)
