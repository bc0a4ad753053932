"""Signed distances of a rectangular outline to straight edges, with their derivatives, for many poses at once.

Frame of the outline: origin at its middle, x ahead. Apart: Euclidean distance. In contact: minus the least overlap
along the outline's axes and the edge's normal (separating axis theorem), since a distance has no direction there.
"""

from typing import NamedTuple

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.benchmark.optimal.motion import MotionLimits


class Gaps(NamedTuple):
    """Distance [m] of pose p to edge e, and its derivative by x, y [1] and heading [m/rad] of the pose."""

    distance: Array
    """(p, e)"""
    gradient: Array
    """(p, e, 3)"""


def measure_gaps(poses: Array, edges: Array, limits: MotionLimits) -> Gaps:
    """Return the distances of outlines at ``poses`` (p, 3) of the rear axle to ``edges`` (p, e, 2, 2)."""
    ahead = limits.ahead
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    shift = edges - poses[:, None, None, :2]
    local = np.stack(
        [
            shift[..., 0] * c[:, None, None] + shift[..., 1] * s[:, None, None] - ahead,
            shift[..., 1] * c[:, None, None] - shift[..., 0] * s[:, None, None],
        ],
        axis=-1,
    )
    a, b = local[..., 0, :], local[..., 1, :]
    half = np.array([limits.half_length, limits.half_width])
    distance, on_outline, normal = _apart(a, b, half)
    depth, deep_point, deep_normal = _overlap(a, b, half)
    touching = depth >= 0.0
    distance = np.where(touching, -depth, distance)
    on_outline = np.where(touching[..., None], deep_point, on_outline)
    normal = np.where(touching[..., None], deep_normal, normal)
    nx = normal[..., 0] * c[:, None] - normal[..., 1] * s[:, None]
    ny = normal[..., 0] * s[:, None] + normal[..., 1] * c[:, None]
    # the outline's point turns about the rear axle: its velocity in its own frame is (-y, x + ahead)
    turn = -(normal[..., 1] * (on_outline[..., 0] + ahead) - normal[..., 0] * on_outline[..., 1])
    return Gaps(distance, np.stack([-nx, -ny, turn], axis=-1))


def _apart(a: Array, b: Array, half: Array) -> tuple[Array, Array, Array]:
    """Return distance, the outline's nearest point and the unit vector from there to the edge's."""
    corners = half * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    pairs = [(np.clip(end, -half, half), end) for end in (a, b)]
    along = b - a
    square = np.maximum((along**2).sum(axis=-1), 1e-18)
    for corner in corners:
        t = np.clip(((corner - a) * along).sum(axis=-1) / square, 0.0, 1.0)
        pairs.append((np.broadcast_to(corner, a.shape), a + t[..., None] * along))
    points = np.stack([own for own, _ in pairs])
    offsets = np.stack([other - own for own, other in pairs])
    distances = np.hypot(offsets[..., 0], offsets[..., 1])
    best = distances.argmin(axis=0)[None]
    distance = np.take_along_axis(distances, best, axis=0)[0]
    point = np.take_along_axis(points, best[..., None], axis=0)[0]
    offset = np.take_along_axis(offsets, best[..., None], axis=0)[0]
    return distance, point, offset / np.maximum(distance, 1e-12)[..., None]


def _overlap(a: Array, b: Array, half: Array) -> tuple[Array, Array, Array]:
    """Return the least overlap, negative where they are apart; the outline's point there, and the axis to the edge."""
    along = b - a
    normal = np.stack([-along[..., 1], along[..., 0]], axis=-1)
    normal = normal / np.maximum(np.hypot(normal[..., 0], normal[..., 1]), 1e-12)[..., None]
    depths, points, axes = [], [], []
    for axis in (0, 1):
        for sign in (1.0, -1.0):
            nearest = np.minimum(sign * a[..., axis], sign * b[..., axis])
            first = (sign * a[..., axis] <= sign * b[..., axis])[..., None]
            direction = np.zeros(2)
            direction[axis] = sign
            depths.append(half[axis] - nearest)
            points.append(np.clip(np.where(first, a, b), -half, half))
            axes.append(np.broadcast_to(direction, a.shape))
    for sign in (1.0, -1.0):
        toward = sign * normal
        reach = np.abs(toward) @ half
        depths.append(reach - (toward * a).sum(axis=-1))
        points.append(np.sign(toward) * half)
        axes.append(toward)
    stacked = np.stack(depths)
    best = stacked.argmin(axis=0)[None]
    depth = np.take_along_axis(stacked, best, axis=0)[0]
    point = np.take_along_axis(np.stack(points), best[..., None], axis=0)[0]
    return depth, point, np.take_along_axis(np.stack(axes), best[..., None], axis=0)[0]
