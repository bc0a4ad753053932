"""How cars stand: seen from their targets, in their slots, at the kerb. Each function takes a row for each car.

Sines and cosines are taken one by one by ``math``: numpy's own may differ in the last bit with the length of an
array, and a run must be judged alike alone and in a table.
"""

import math
from collections.abc import Callable
from functools import reduce

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array


def each(function: Callable[..., float], *values: Array) -> Array:
    """Return ``function`` of every element; NaN where an element is not finite."""
    rows = zip(*(item.tolist() for item in values), strict=True)
    return np.array([function(*row) if all(map(math.isfinite, row)) else math.nan for row in rows], dtype=np.float64)


def in_frames(poses: Array, frames: Array) -> Array:
    """Return (longitudinal [m], lateral [m], heading [rad, wrapped]) of poses (n, 3) in the frames of others (n, 3)."""
    dx, dy, turn = (poses - frames).T
    c, s = each(math.cos, frames[:, 2]), each(math.sin, frames[:, 2])
    wrapped = each(math.atan2, each(math.sin, turn), each(math.cos, turn))
    return np.column_stack([c * dx + s * dy, c * dy - s * dx, wrapped])


def outline_margin(poses: Array, slots: Array, cars: Array) -> Array:
    """Return the least distance [m] of the outlines to the edges of their slots, negative where they stand out.

    ``slots``: x, y, heading, length, width; ``cars``: front, rear, half width, wheelbase from the rear axle.
    """
    x, y, turn = in_frames(poses, slots[:, :3]).T
    c, s = each(math.cos, turn), each(math.sin, turn)
    front, rear, half, _ = cars.T
    margins = []
    for along in (front, -rear):
        for across in (half, -half):
            margins.append(0.5 * slots[:, 3] - np.abs(x + c * along - s * across))
            margins.append(0.5 * slots[:, 4] - np.abs(y + s * along + c * across))
    return reduce(np.minimum, margins)


def beyond_ends(poses: Array, slots: Array, cars: Array) -> tuple[Array, Array]:
    """Return how far [m] the outlines reach beyond the front and the rear boundary of their slots; negative: not.

    The front boundary is the one that the slot's heading points to.
    """
    x, _, turn = in_frames(poses, slots[:, :3]).T
    c, s = each(math.cos, turn), each(math.sin, turn)
    front, rear, half, _ = cars.T
    ends = np.array([x + c * along - s * across for along in (front, -rear) for across in (half, -half)])
    return ends.max(axis=0) - 0.5 * slots[:, 3], -ends.min(axis=0) - 0.5 * slots[:, 3]


def kerb_distances(poses: Array, kerbs: Array, cars: Array) -> tuple[Array, Array]:
    """Return (nearest, farthest) distance [m] of the tyres beside the nearest kerb; NaN without one.

    A tyre's outer face lies in the plane of the car's side. ``kerbs`` (n, k, 4): x1, y1, x2, y2; NaN: there is none.
    """
    c, s = each(math.cos, poses[:, 2]), each(math.sin, poses[:, 2])
    half, wheelbase = cars[:, 2], cars[:, 3]
    nearest = farthest = np.full(len(poses), math.nan)
    for number in range(kerbs.shape[1]):
        axles = []
        for along in (np.zeros(len(poses)), wheelbase):
            sides = [
                _to_segment(poses[:, 0] + c * along - s * side, poses[:, 1] + s * along + c * side, kerbs[:, number])
                for side in (half, -half)
            ]
            axles.append(np.minimum(*sides))
        near, far = np.minimum(*axles), np.maximum(*axles)
        better = (near < nearest) | np.isnan(nearest)
        nearest, farthest = np.where(better, near, nearest), np.where(better, far, farthest)
    return nearest, farthest


def _to_segment(x: Array, y: Array, segments: Array) -> Array:
    """Return the distance [m] of points to straight pieces x1, y1, x2, y2."""
    x1, y1, x2, y2 = segments.T
    dx, dy = x2 - x1, y2 - y1
    share = np.clip(((x - x1) * dx + (y - y1) * dy) / np.maximum(dx * dx + dy * dy, 1e-12), 0.0, 1.0)
    ex, ey = x - x1 - share * dx, y - y1 - share * dy
    return np.asarray(np.sqrt(ex * ex + ey * ey))
