"""The line through points by least squares, from sums over the points."""

from typing import NamedTuple


class PointSums(NamedTuple):
    """How many points, and the sums of their coordinates [m] and of the products of those [m2]."""

    n: int = 0
    x: float = 0.0
    y: float = 0.0
    xx: float = 0.0
    xy: float = 0.0
    yy: float = 0.0


def add_point(sums: PointSums, x: float, y: float) -> PointSums:
    """Return the sums with the point (x, y) [m]."""
    return PointSums(sums.n + 1, sums.x + x, sums.y + y, sums.xx + x * x, sums.xy + x * y, sums.yy + y * y)


def about_mean(sums: PointSums) -> PointSums:
    """Return the mean of the points, and the sums of products about it."""
    n = float(max(sums.n, 1))
    x = sums.x / n
    y = sums.y / n
    return PointSums(sums.n, x, y, sums.xx - n * x * x, sums.xy - n * x * y, sums.yy - n * y * y)
