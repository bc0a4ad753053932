"""Share parked of the starts that a dense grid of quintics parks: ``python -m benchmarks.quintics TABLE``.

``TABLE`` is that of ``apa sweep zhang2022-starts``. For each start two families are searched, within the car's
curvature and the planner's margin to slot and aisle: one quintic x(t), y(t) over the final time, the end speeds and
accelerations; two quintics y(x) that meet anywhere, at any heading and curvature.
"""

import argparse
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controller_fmu.common.slot_clearance import Outline, SlotBounds, outline_of
from controller_fmu.registry import MODEL
from controller_fmu.zhang2022.slot import slot_bounds
from modelkit.variables import with_values
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.studies.sweep.table import Table

Array = NDArray[np.float64]
SAMPLES = 41
T = np.linspace(0.0, 1.0, SAMPLES)
PLACES, HEADINGS, BENDS = 21, 21, 3
"""Of the meeting point along and across, of its headings, of its curvatures."""
SPEEDS, ACCELERATIONS = 25, 7
"""Of the end speeds and end accelerations of one quintic over its final time: each at both ends."""
AT_ONCE = 4_000


class Curves(NamedTuple):
    """Points, headings and curvatures of many paths, (paths, samples) each."""

    x: Array
    y: Array
    heading: Array
    curvature: Array


class Limits(NamedTuple):
    """What a path keeps."""

    curvature: float
    car: Outline
    slot: SlotBounds


def limits_of() -> Limits:
    """Return the limits of the shipped scenario as its planner has them."""
    params = with_values(MODEL.params, load_scenario("zhang2022").controller)
    car = params.car
    share = params.zhang2022.quintic.curvature_share
    curvature = share * math.tan(car.steering.angle_limit / car.steering.ratio) / car.wheelbase
    return Limits(curvature, outline_of(car), slot_bounds(params.zhang2022.slot, car))


def is_found(x: float, y: float, heading: float, limits: Limits) -> bool:
    """Return whether any path of both grids leads from the start (slot frame) to the origin within the limits."""
    grids = (_over_time(x, y, heading), _joined(x, y, heading))
    return any(_keeps(curves, limits) for grid in grids for curves in grid)


def _coefficients(p0: Array, v0: Array, a0: Array, p1: Array, v1: Array, a1: Array) -> Array:
    """Return the six coefficients, (6, paths), of quintics over [0, 1] by position, slope and bend at both ends."""
    d, e, f = p1 - p0 - v0 - 0.5 * a0, v1 - v0 - a0, a1 - a0
    return np.array(
        [p0, v0, 0.5 * a0, 10.0 * d - 4.0 * e + 0.5 * f, -15.0 * d + 7.0 * e - f, 6.0 * d - 3.0 * e + 0.5 * f]
    )


def _derivatives(c: Array) -> tuple[Array, Array, Array]:
    powers = np.vander(T, 6, increasing=True)
    first = np.column_stack([np.zeros(SAMPLES), *(k * T ** (k - 1) for k in range(1, 6))])
    second = np.column_stack([np.zeros((SAMPLES, 2)), *(k * (k - 1) * T ** (k - 2) for k in range(2, 6))])
    return c.T @ powers.T, c.T @ first.T, c.T @ second.T


def _over_time(x: float, y: float, heading: float) -> Iterator[Curves]:
    """Return single quintics x(t), y(t): end speeds times final time, and end accelerations along the path."""
    way = math.hypot(x, y)
    speeds = way * np.geomspace(0.15, 4.0, SPEEDS)
    bends = way * np.linspace(-9.0, 9.0, ACCELERATIONS)
    v0, v1, a0, a1 = (item.ravel() for item in np.meshgrid(speeds, speeds, bends, bends))
    for part in range(0, len(v0), AT_ONCE):
        at = slice(part, part + AT_ONCE)
        none = np.zeros_like(v0[at])
        c, s = math.cos(heading), math.sin(heading)
        px, vx, ax = _derivatives(_coefficients(none + x, -c * v0[at], -c * a0[at], none, -v1[at], a1[at]))
        py, vy, ay = _derivatives(_coefficients(none + y, -s * v0[at], -s * a0[at], none, none, none))
        norm = np.maximum(np.hypot(vx, vy), 1e-9)
        yield Curves(px, py, np.arctan2(-vy, -vx), np.abs(vx * ay - vy * ax) / norm**3)


def _joined(x: float, y: float, heading: float) -> Iterator[Curves]:
    """Return two quintics y(x) that meet at a point, with a heading and a curvature."""
    seen = math.atan2(y, x)
    shares, headings = np.linspace(0.1, 0.85, PLACES), seen * np.linspace(0.7, 2.8, HEADINGS)
    xs, ys, hs, ks = (
        item.ravel() for item in np.meshgrid(x * shares, y * shares, headings, np.linspace(-0.06, 0.06, BENDS))
    )
    slope = np.tan(np.minimum(hs, 1.4))
    bend = ks * (1.0 + slope**2) ** 1.5
    for part in range(0, len(xs), AT_ONCE):
        at = slice(part, part + AT_ONCE)
        none = np.zeros_like(xs[at])
        last = _graph(none, none, none, none, xs[at], ys[at], slope[at], bend[at])
        first = _graph(xs[at], ys[at], slope[at], bend[at], none + x, none + y, none + math.tan(heading), none)
        yield Curves(*(np.concatenate(both, axis=1) for both in zip(last, first, strict=True)))


def _graph(x0: Array, y0: Array, m0: Array, b0: Array, x1: Array, y1: Array, m1: Array, b1: Array) -> Curves:
    length = x1 - x0
    y, v, a = _derivatives(_coefficients(y0, m0 * length, b0 * length**2, y1, m1 * length, b1 * length**2))
    slope, bend = v / length[:, None], a / length[:, None] ** 2
    return Curves(x0[:, None] + length[:, None] * T, y, np.arctan(slope), np.abs(bend) / (1.0 + slope**2) ** 1.5)


def _keeps(curves: Curves, limits: Limits) -> bool:
    """Return whether one of the paths keeps curvature, neighbours and aisle."""
    within = np.flatnonzero(curves.curvature.max(axis=1) <= limits.curvature)
    x, y, heading = (item[within] for item in curves[:3])
    car, slot = limits.car, limits.slot
    c, s = np.cos(heading), np.sin(heading)
    clear = np.abs(heading) < 1.5
    for along in (car.front, -car.rear):
        for aside in (car.half_width, -car.half_width):
            cx, cy = x + along * c - aside * s, y + along * s + aside * c
            clear &= ~((cy > slot.far) | ((cy < slot.opening) & ((cx > slot.front) | (cx < slot.rear))))
    for end in (slot.front, slot.rear):
        ahead = (end - x) * c + (slot.opening - y) * s
        left = (slot.opening - y) * c - (end - x) * s
        clear &= ~((-car.rear < ahead) & (ahead < car.front) & (np.abs(left) < car.half_width))
    return bool(clear.all(axis=1).any())


def main(words: list[str] | None = None) -> int:
    """Print the shares. Returns 0 if at least 90 % of the starts that the grid parks are parked, else 1."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.quintics", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("table", type=Path, metavar="TABLE")
    parser.add_argument("--starts", type=int, default=150, help="first starts of the table (150)")
    asked = parser.parse_args(words)
    table, limits = Table(asked.table), limits_of()
    rows = min(asked.starts, table.count)
    names = [name for name in ("x", "y", "heading") if f"vehicle.start.{name}" in table.names()]
    columns = {name: np.asarray(table.column(f"vehicle.start.{name}")) for name in names}
    parked = [str(outcome) == "parked" for outcome in table.column("outcome")]
    both = missed = refused = 0
    for row in range(rows):
        start = {name: float(values[row]) for name, values in columns.items()}
        found = is_found(start["x"], start["y"], start.get("heading", 0.0), limits)
        both += found and parked[row]
        refused += not found and not parked[row]
        if found and not parked[row]:
            missed += 1
            print(f"row {row}: found, not parked: {start}")
    possible = both + missed
    share = 100.0 * both / possible
    print(f"{rows} starts: the grid parks {possible}; of these the system parks {both} ({share:.1f} %)")
    print(f"neither: {refused}; the system alone: {rows - possible - refused}")
    return 0 if both >= 0.9 * possible else 1


if __name__ == "__main__":
    sys.exit(main())
