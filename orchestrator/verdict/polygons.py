"""How near a car comes to polygons: exact distance of its outline to their edges, for many poses at once.

It shares nothing with the planner that it judges.
"""

from collections.abc import Sequence

import numpy as np

from orchestrator.cosim.slave import Array
from orchestrator.verdict.geometry import CarOutline

AT_ONCE = 400
"""Poses worked out together."""
SPACING = 0.01
"""Poses nearer to each other than this [m] and ``TURN`` [rad] are looked at once."""
TURN = 0.002


def polygon_clearance(poses: Array, polygons: Sequence[Sequence[tuple[float, float]]], car: CarOutline) -> float:
    """Return the least distance [m] of the outlines at ``poses`` (n, 3) to the polygons; 0 in contact, NaN for none."""
    poses = poses[np.isfinite(poses).all(axis=1)]
    if not polygons or not len(poses):
        return float("nan")
    rows = _apart(poses)
    return min(float(_clearances(rows[at : at + AT_ONCE], polygons, car).min()) for at in range(0, len(rows), AT_ONCE))


def _apart(poses: Array) -> Array:
    """Return the poses without those that hardly differ from one before; the last is among them."""
    kept = [0]
    for row in range(1, len(poses)):
        moved = np.abs(poses[row] - poses[kept[-1]])
        if moved[0] + moved[1] > SPACING or moved[2] > TURN:
            kept.append(row)
    return poses[[*kept, len(poses) - 1]]


def _clearances(poses: Array, polygons: Sequence[Sequence[tuple[float, float]]], car: CarOutline) -> Array:
    """Return the distance [m] of each outline to the nearest polygon."""
    nearest = np.full(len(poses), np.inf)
    for polygon in polygons:
        corners = _seen(poses, np.array(polygon, dtype=float), car)
        gaps = _edge_gaps(corners, np.roll(corners, -1, axis=1), 0.5 * (car.front + car.rear), car.half_width)
        nearest = np.minimum(nearest, np.where(_middle_inside(corners), 0.0, gaps.min(axis=1)))
    return nearest


def _seen(poses: Array, points: Array, car: CarOutline) -> Array:
    """Return points (p, 2) in the frames of the outlines' middles, (n, p, 2)."""
    c, s = np.cos(poses[:, 2, None]), np.sin(poses[:, 2, None])
    dx, dy = points[None, :, 0] - poses[:, 0, None], points[None, :, 1] - poses[:, 1, None]
    return np.stack([dx * c + dy * s - 0.5 * (car.front - car.rear), dy * c - dx * s], axis=-1)


def _edge_gaps(a: Array, b: Array, length: float, width: float) -> Array:
    """Return the distances of straight pieces a-b to the rectangle of these half sizes about the origin."""
    found = np.minimum(_to_rectangle(a, length, width), _to_rectangle(b, length, width))
    for x, y in ((length, width), (-length, width), (-length, -width), (length, -width)):
        found = np.minimum(found, _to_piece(np.array([x, y]), a, b))
    return np.where(_crosses(a, b, length, width), 0.0, found)


def _to_rectangle(points: Array, length: float, width: float) -> Array:
    out = np.maximum(np.abs(points) - np.array([length, width]), 0.0)
    return np.asarray(np.hypot(out[..., 0], out[..., 1]))


def _to_piece(point: Array, a: Array, b: Array) -> Array:
    along, to = b - a, point - a
    square = (along**2).sum(axis=-1)
    t = np.clip((to * along).sum(axis=-1) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    off = to - t[..., None] * along
    return np.asarray(np.hypot(off[..., 0], off[..., 1]))


def _crosses(a: Array, b: Array, length: float, width: float) -> Array:
    """Return whether a piece a-b shares a point with the rectangle: the part of it in both strips is not empty."""
    low, high = np.zeros(a.shape[:-1]), np.ones(a.shape[:-1])
    for axis, half in ((0, length), (1, width)):
        at, rate = a[..., axis], b[..., axis] - a[..., axis]
        flat = rate == 0.0
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = np.stack([(-half - at) / rate, (half - at) / rate])
        outside = flat & (np.abs(at) > half)
        low = np.maximum(low, np.where(flat, np.where(outside, 2.0, 0.0), ends.min(axis=0)))
        high = np.minimum(high, np.where(flat, 1.0, ends.max(axis=0)))
    return np.asarray(low <= high)


def _middle_inside(corners: Array) -> Array:
    """Return whether the origin lies inside the polygon with these corners (n, p, 2): a ray meets an odd count."""
    a, b = corners, np.roll(corners, -1, axis=1)
    passes = (a[..., 1] > 0.0) != (b[..., 1] > 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        x = a[..., 0] - a[..., 1] * (b[..., 0] - a[..., 0]) / (b[..., 1] - a[..., 1])
    return np.asarray((passes & (x > 0.0)).sum(axis=1) % 2 == 1)
