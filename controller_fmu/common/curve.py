"""Where a piece of path leads: curvature linear in arc length (line, arc, clothoid).

    heading(s) = h0 + d (k0 s + (k1 - k0) s^2 / (2 l))     x' = d cos heading    y' = d sin heading

d is 1 forward, -1 in reverse; curvature is positive to the left. Arcs are closed, clothoids
integrated by Gauss and Legendre's rule with five points (under 1e-9 m for a turn of 0.5 rad).
"""

import math

from modelkit.vocabulary import Pose

NODES = (-0.906179845938664, -0.538469310105683, 0.0, 0.538469310105683, 0.906179845938664)
WEIGHTS = (0.236926885056189, 0.478628670499366, 0.568888888888889, 0.478628670499366, 0.236926885056189)
MIN_TURN = 1e-300
"""A product with a smaller turn [rad] loses digits; the chord is as long as the arc."""


def advance(pose: Pose, direction: float, length: float, k0: float, k1: float) -> Pose:
    """Return the pose after ``length`` [m] of path whose curvature goes from ``k0`` to ``k1`` [1/m]."""
    h = pose.heading
    turn = direction * 0.5 * (k0 + k1) * length
    if k0 == k1:
        half = 0.5 * turn
        chord = direction * length
        if abs(half) > MIN_TURN:
            chord = chord * math.sin(half) / half
        return Pose(pose.x + chord * math.cos(h + half), pose.y + chord * math.sin(h + half), h + turn)
    x = 0.0
    y = 0.0
    for number in range(5):
        s = 0.5 * length * (1.0 + NODES[number])
        at = h + direction * (k0 * s + 0.5 * (k1 - k0) * s * s / length)
        x += WEIGHTS[number] * math.cos(at)
        y += WEIGHTS[number] * math.sin(at)
    scale = 0.5 * direction * length
    return Pose(pose.x + scale * x, pose.y + scale * y, h + turn)
