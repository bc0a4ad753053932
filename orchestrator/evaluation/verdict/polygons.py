"""How near a car comes to polygons: exact distance of its outline to their edges, for many poses at once.

It shares nothing with the planner that it judges.
"""

from collections.abc import Sequence

import numpy as np

from orchestrator.evaluation.verdict.geometry import CarOutline
from orchestrator.simulation.cosim.fmu_instance import Array, Indices

Polygons = Sequence[Sequence[tuple[float, float]]]
AT_ONCE = 400
"""Poses worked out together."""
POSE_SPACING = 0.01
"""Poses nearer to each other than this [m] and ``HEADING_SPACING`` [rad] are looked at once."""
HEADING_SPACING = 0.002
TOUCH_DEPTH = 1e-9
"""Penetration depth [m] of what only touches: less than any other."""


def polygon_clearances(poses: Array, polygons: Polygons, car: CarOutline) -> Array:
    """Return the distance [m] of each outline to the nearest polygon, in contact minus the depth; NaN if not known.

    A pose that hardly differs from the one before has its value, unless a polygon is as near as they may differ.
    """
    found = np.full(len(poses), np.nan)
    if not polygons or not len(poses):
        return found
    finite = np.flatnonzero(np.isfinite(poses).all(axis=1))
    if not len(finite):
        return found
    known = poses[finite]
    kept = _apart(known)
    values = _in_parts(known[kept], polygons, car)
    spread = values[np.searchsorted(kept, np.arange(len(known)), side="right") - 1]
    near = np.flatnonzero(spread < POSE_SPACING + HEADING_SPACING * (car.front + car.rear))
    spread[near] = _in_parts(known[near], polygons, car)
    found[finite] = spread
    return found


def _in_parts(poses: Array, polygons: Polygons, car: CarOutline) -> Array:
    parts = [_clearances(poses[at : at + AT_ONCE], polygons, car) for at in range(0, len(poses), AT_ONCE)]
    return np.concatenate(parts) if parts else np.empty(0)


def _apart(poses: Array) -> Indices:
    """Return the places of the poses that differ from the one kept before."""
    kept = [0]
    for row in range(1, len(poses)):
        moved = np.abs(poses[row] - poses[kept[-1]])
        if moved[0] + moved[1] > POSE_SPACING or moved[2] > HEADING_SPACING:
            kept.append(row)
    return np.array(kept, dtype=np.intp)


def _clearances(poses: Array, polygons: Polygons, car: CarOutline) -> Array:
    """Return the distance [m] of each outline to the nearest polygon, in contact minus the depth."""
    nearest = np.full(len(poses), np.inf)
    length, width = 0.5 * (car.front + car.rear), car.half_width
    bounds = _lower_bounds(poses, polygons, car)
    for place in np.argsort(bounds, kind="stable"):
        if bounds[place] > nearest.max():
            break
        polygon = polygons[place]
        corners = _in_outline_frames(poses, np.array(polygon, dtype=float), car)
        gaps = _edge_gaps(corners, np.roll(corners, -1, axis=1), length, width).min(axis=1)
        gaps[_middle_inside(corners)] = 0.0
        touching = np.flatnonzero(gaps <= 0.0)
        if len(touching):
            gaps[touching] = -np.maximum(TOUCH_DEPTH, _depths(corners[touching], _convex_parts(polygon), length, width))
        nearest = np.minimum(nearest, gaps)
    return nearest


def _lower_bounds(poses: Array, polygons: Polygons, car: CarOutline) -> Array:
    """Return for each polygon a distance [m] below which no outline comes, negative where they may touch."""
    reach = float(np.hypot(max(abs(car.front), abs(car.rear)), car.half_width))
    sizes = np.cumsum([0, *(len(polygon) for polygon in polygons)])[:-1]
    points = np.concatenate([np.asarray(polygon, dtype=float) for polygon in polygons])
    low, high = np.minimum.reduceat(points, sizes), np.maximum.reduceat(points, sizes)
    places = poses[:, :2]
    apart = np.maximum(np.maximum(low - places.max(axis=0), places.min(axis=0) - high), 0.0)
    return np.asarray(np.hypot(apart[:, 0], apart[:, 1])) - reach


def _depths(corners: Array, parts: Sequence[Sequence[int]], length: float, width: float) -> Array:
    """Return the penetration depth [m] of polygons (n, p, 2) in the rectangle of these half sizes: of the deepest part.

    Of a convex part it is the least overlap along the normals of all sides (separating axis theorem).
    """
    deepest = np.zeros(len(corners))
    for part in parts:
        points = corners[:, list(part)]
        sides = np.roll(points, -1, axis=1) - points
        sizes = np.hypot(sides[..., 0], sides[..., 1])
        normals = np.stack([-sides[..., 1], sides[..., 0]], axis=-1) / np.where(sizes > 0.0, sizes, 1.0)[..., None]
        fixed = np.broadcast_to(np.eye(2), (len(corners), 2, 2))
        axes = np.concatenate([fixed, normals], axis=1)
        seen = np.einsum("nak,npk->nap", axes, points)
        half = np.abs(axes[..., 0]) * length + np.abs(axes[..., 1]) * width
        overlap = np.minimum(seen.max(axis=2) + half, half - seen.min(axis=2))
        counts = np.concatenate([np.ones((len(corners), 2), dtype=bool), sizes > 0.0], axis=1)
        deepest = np.maximum(deepest, np.where(counts, overlap, np.inf).min(axis=1))
    return deepest


def _convex_parts(polygon: Sequence[tuple[float, float]]) -> list[list[int]]:
    """Return a polygon as convex parts, each by the places of its corners: itself, or triangles."""
    points = [(float(x), float(y)) for x, y in polygon]
    count = len(points)
    area = sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(points, [*points[1:], points[0]], strict=True))
    left = list(range(count)) if area >= 0.0 else list(range(count - 1, -1, -1))
    if all(_turn(points, left[i - 2], left[i - 1], left[i]) >= 0.0 for i in range(count)):
        return [left]
    parts = []
    while len(left) > 3:
        tip = next((i for i in range(len(left)) if _is_ear(points, left, i)), 0)
        parts.append([left[tip - 1], left[tip], left[(tip + 1) % len(left)]])
        del left[tip]
    return [*parts, left]


def _is_ear(points: Sequence[tuple[float, float]], left: Sequence[int], place: int) -> bool:
    a, b, c = left[place - 1], left[place], left[(place + 1) % len(left)]
    if _turn(points, a, b, c) <= 0.0:
        return False
    others = [item for item in left if item not in (a, b, c)]
    return not any(
        _turn(points, a, b, item) >= 0.0 and _turn(points, b, c, item) >= 0.0 and _turn(points, c, a, item) >= 0.0
        for item in others
    )


def _turn(points: Sequence[tuple[float, float]], a: int, b: int, c: int) -> float:
    """Return twice the area of a triangle, positive counter-clockwise."""
    (ax, ay), (bx, by), (cx, cy) = points[a], points[b], points[c]
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


def _in_outline_frames(poses: Array, points: Array, car: CarOutline) -> Array:
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
