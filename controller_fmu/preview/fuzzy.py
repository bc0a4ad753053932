"""A Mamdani controller: two inputs, 5 by 5 rules, min-max inference, exact centroid.

The clipped and joined output sets are piecewise linear, so the centroid is integrated in closed
form cell by cell; a sampled centroid converges to it as its grid is refined.
"""

from typing import NamedTuple

from controller_fmu.preview.membership import membership

INPUT_SETS = 5
OUTPUT_SETS = 7


class PieceMoment(NamedTuple):
    """Area and first moment of a piece of the output set."""

    area: float
    first: float


def infer(
    row_value: float,
    column_value: float,
    row_peaks: tuple[float, ...],
    column_peaks: tuple[float, ...],
    output_peaks: tuple[float, ...],
    rules: tuple[int, ...],
) -> float:
    """Return the crisp output, in the units of ``output_peaks``.

    A rule fires with the smaller of its two degrees; an output set is clipped at the strongest rule
    that names it; the sets are joined by maximum; the centroid of the result is returned.
    """
    row = membership(row_value, row_peaks)
    column = membership(column_value, column_peaks)
    at = row.lower * INPUT_SETS + column.lower
    r0, r1 = row.degree_lower, 1.0 - row.degree_lower
    c0, c1 = column.degree_lower, 1.0 - column.degree_lower
    fired = (_smaller(r0, c0), _smaller(r0, c1), _smaller(r1, c0), _smaller(r1, c1))
    named = (rules[at], rules[at + 1], rules[at + INPUT_SETS], rules[at + INPUT_SETS + 1])
    return centroid(output_peaks, levels(fired, named))


def levels(fired: tuple[float, ...], named: tuple[int, ...]) -> tuple[float, float, float, float, float, float, float]:
    """Return the level at which each of the seven output sets is clipped."""
    return (
        _level(0, fired, named),
        _level(1, fired, named),
        _level(2, fired, named),
        _level(3, fired, named),
        _level(4, fired, named),
        _level(5, fired, named),
        _level(6, fired, named),
    )


def centroid(peaks: tuple[float, ...], level: tuple[float, ...]) -> float:
    """Return the centroid of the joined sets, triangles with the given peaks clipped at ``level``; 0 if empty."""
    area = 0.0
    first = 0.0
    for cell in range(OUTPUT_SETS - 1):
        width = peaks[cell + 1] - peaks[cell]
        piece = cell_moment(level[cell], level[cell + 1])
        area = area + width * piece.area
        first = first + width * (peaks[cell] * piece.area + width * piece.first)
    if area <= 0.0:
        return 0.0
    return first / area


def cell_moment(falling: float, rising: float) -> PieceMoment:
    """Return area and moment about t = 0 of max(min(falling, 1 - t), min(rising, t)) over t in [0, 1]."""
    if falling >= rising:
        return _dominant(falling, rising)
    mirrored = _dominant(rising, falling)
    return PieceMoment(mirrored.area, mirrored.area - mirrored.first)


def _dominant(high: float, low: float) -> PieceMoment:
    """Return the moment of a cell whose falling set is clipped at ``high``, its rising one at ``low`` <= ``high``."""
    flat = 1.0 - high
    if low <= 0.5:
        crossing = 1.0 - low
        return _sum(
            _trapezoid(0.0, flat, high, high),
            _trapezoid(flat, crossing, high, low),
            _trapezoid(crossing, 1.0, low, low),
        )
    down = _sum(_trapezoid(0.0, flat, high, high), _trapezoid(flat, 0.5, high, 0.5), _trapezoid(0.5, low, 0.5, low))
    return _sum(down, _trapezoid(low, 1.0, low, low), PieceMoment(0.0, 0.0))


def _trapezoid(start: float, end: float, left: float, right: float) -> PieceMoment:
    """Return the moment of a line from (start, left) to (end, right)."""
    width = end - start
    area = 0.5 * width * (left + right)
    return PieceMoment(area, start * area + width * width * (left + 2.0 * right) / 6.0)


def _sum(a: PieceMoment, b: PieceMoment, c: PieceMoment) -> PieceMoment:
    return PieceMoment(a.area + b.area + c.area, a.first + b.first + c.first)


def _level(index: int, fired: tuple[float, ...], named: tuple[int, ...]) -> float:
    highest = 0.0
    for rule in range(4):
        if named[rule] == index and fired[rule] > highest:
            highest = fired[rule]
    return highest


def _smaller(a: float, b: float) -> float:
    return a if a < b else b
