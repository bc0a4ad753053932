"""How sure a success rate is."""


def wilson(successes: int, count: int) -> tuple[float, float]:
    """Return the 95 % confidence interval of a success rate (Wilson 1927); of no trials it is all there is, 0 to 1."""
    from scipy.stats import binomtest  # type: ignore[import-untyped]  # slow to import

    if count == 0:
        return 0.0, 1.0
    interval = binomtest(successes, count).proportion_ci(0.95, method="wilson")
    return float(interval.low), float(interval.high)
