"""Arc, line, arc between two parallel poses: the key points the quintics go through."""

import math
from typing import NamedTuple


class ArcLineArc(NamedTuple):
    """Two arcs of equal radius joined by a line; the target is the origin, the start ahead and to the left."""

    angle: float
    """Angle of each arc [rad]."""
    line: float
    """Length of the line [m]; negative: the radius does not fit."""
    radius: float


def largest_radius(s: float, h: float) -> float:
    """Return the radius [m] at which the two arcs meet without a line: (S^2 + H^2) / (4 H), H > 0."""
    return (s * s + h * h) / (4.0 * h)


def arc_line_arc(s: float, h: float, radius: float) -> ArcLineArc:
    """Return angle and line from longitudinal and lateral distance [m], equations (2) and (3) of Zhang 2022.

    (R1 + R2) sin th + S1 cos th = S and (R1 + R2)(1 - cos th) + S1 sin th = H, with R1 = R2. Squared
    and added: S1^2 = S^2 + H^2 - 2 H (R1 + R2); the angle is that between (S1, R1 + R2) turned and unturned.
    """
    both = 2.0 * radius
    square = s * s + h * h - 2.0 * h * both
    if square < 0.0:
        return ArcLineArc(0.0, -1.0, radius)
    line = math.sqrt(square)
    return ArcLineArc(math.atan2(s, both - h) - math.atan2(line, both), line, radius)
