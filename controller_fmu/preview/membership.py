"""Degrees of membership in a triangular partition: every value belongs to one or two neighbouring sets."""

from typing import NamedTuple


class Membership(NamedTuple):
    """Where a value lies between the peaks of two neighbouring sets."""

    lower: int
    """Index of the set whose peak lies at or below the value."""
    degree_lower: float
    """Degree of membership in that set; the next set's degree is one minus it."""


def membership(value: float, peaks: tuple[float, ...]) -> Membership:
    """Return the set below ``value`` and its degree, for triangles with rising ``peaks``.

    mu_i = (p_{i+1} - x) / (p_{i+1} - p_i), mu_{i+1} = 1 - mu_i on [p_i, p_{i+1}]; the outer sets
    have shoulders, so beyond the outer peaks the degree is one. The paper's Fig. 5 is lost: the
    shape is chosen. NaN belongs to the last set.
    """
    last = len(peaks) - 2
    if value <= peaks[0]:
        return Membership(0, 1.0)
    for lower in range(last + 1):
        if value < peaks[lower + 1]:
            return Membership(lower, (peaks[lower + 1] - value) / (peaks[lower + 1] - peaks[lower]))
    return Membership(last, 0.0)
