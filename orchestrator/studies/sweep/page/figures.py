"""Pictures of a study as SVG texts: success maps and histograms. Colours come from the page's style."""

import html
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from orchestrator.evaluation.verdict.confidence import wilson
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.sweep.page.statistics import Axis, Map

WIDTH, HEIGHT = 540.0, 330.0
LEFT, RIGHT, TOP, BOTTOM = 84.0, 22.0, 8.0, 44.0
SCALE = ("#00224e", "#123570", "#3b496c", "#575d6d", "#707173", "#8a8678", "#a59c74", "#c3b369", "#e1cc55", "#fee838")
"""Cividis (Nunez, Anderton, Renslow 2018): read alike with and without colour vision; dark is 0, bright is 1."""
MOST_TICKS = 8
TAILS = (0.005, 0.995)
"""Share of the runs below and above what a histogram shows."""


def colour(rate: float) -> str:
    """Return the colour of a success rate in [0, 1]."""
    place = min(max(rate, 0.0), 1.0) * (len(SCALE) - 1)
    low = min(int(place), len(SCALE) - 2)
    a, b = (tuple(int(SCALE[number][at : at + 2], 16) for at in (1, 3, 5)) for number in (low, low + 1))
    return "#" + "".join(f"{round(x + (y - x) * (place - low)):02x}" for x, y in zip(a, b, strict=True))


def short(value: float) -> str:
    """Return a number in few characters, without an exponent where that is possible."""
    return f"{value:.0f}" if 1000.0 <= abs(value) < 1e6 else f"{value:.3g}"


def axis_name(axis: Axis) -> str:
    """Return the name of an axis with its unit, if it has one."""
    return axis.name if axis.unit == "1" else f"{axis.name} [{axis.unit}]"


def success_map(shown: Map, word: str) -> str:
    """Return the map as SVG; every cell tells its numbers when pointed at. ``word``: what a good run is."""
    rows, columns = shown.runs.shape
    across, up = _places(shown.x, LEFT, WIDTH - RIGHT), _places(shown.y, HEIGHT - BOTTOM, TOP)
    cells = []
    for row in range(rows):
        for column in range(columns):
            count, good = int(shown.runs[row, column]), int(shown.done[row, column])
            if count:
                low, high = wilson(good, count)
                at_x, at_y = _with_unit(shown.x, column), _with_unit(shown.y, row)
                note = (
                    f"{at_x}, {at_y}: "
                    f"{100.0 * good / count:.1f} % of {count} {word} (95 %: {100.0 * low:.0f} to {100.0 * high:.0f} %)"
                )
                at = f'x="{across[column]:.2f}" y="{up[row + 1]:.2f}"'
                width, height = across[column + 1] - across[column], up[row] - up[row + 1]
                size = f'width="{width + 0.3:.2f}" height="{height + 0.3:.2f}"'
                fill = colour(good / count)
                named = f'class="cell" data-c="{column}" data-r="{row}"'
                cells.append(f'<rect {named} {at} {size} fill="{fill}"><title>{html.escape(note)}</title></rect>')
    return _svg(cells + _axis_x(shown.x, across) + _axis_y(shown.y, up), f"Success map {shown.title}")


def _with_unit(axis: Axis, cell: int) -> str:
    return axis.labels[cell] if axis.unit == "1" else f"{axis.labels[cell]} {axis.unit}"


def scale_bar(word: str) -> str:
    """Return the colour scale of the maps as SVG."""
    steps = "".join(
        f'<rect x="{70 + 3 * step}" y="4" width="3.3" height="12" fill="{colour(step / 99)}"/>' for step in range(100)
    )
    return (
        '<svg viewBox="0 0 480 20" style="max-width:480px" role="img" aria-label="Scale">'
        f'<text x="66" y="14" text-anchor="end">0 % {word}</text>{steps}<text x="376" y="14">100 % {word}</text></svg>'
    )


def histogram(values: Array, good: NDArray[np.bool_], name: str, unit: str, word: str, bins: int = 40) -> str:
    """Return a histogram as SVG: good runs below, the others stacked on them; the end bars hold what lies beyond."""
    finite = np.isfinite(values)
    values, good = values[finite], good[finite]
    if not len(values):
        return ""
    low, high = (float(end) for end in np.quantile(values, TAILS))
    whole = bool((values == np.round(values)).all())
    if whole and high - low <= bins:
        edges = np.arange(low - 0.5, high + 1.0)
        marks = np.arange(low, high + 0.5, max(1, round((high - low) / 8)))
    else:
        edges = np.linspace(low, high if high > low else low + 1.0, bins + 1)
        marks = np.linspace(edges[0], edges[-1], 6)
    values = np.clip(values, edges[0], edges[-1])
    yes, no = (np.histogram(values[kind], edges)[0] for kind in (good, ~good))
    tallest = max(1, int((yes + no).max()))
    width, full = (WIDTH - LEFT - RIGHT) / len(yes), 200.0 - TOP - BOTTOM
    bars = []
    for place, (a, b) in enumerate(zip(yes.tolist(), no.tolist(), strict=True)):
        ends = f"{edges[place]:.4g} to {edges[place + 1]:.4g}" + ("" if unit == "1" else f" {unit}")
        note = html.escape(f"{ends}: {a} {word}, {b} not")
        x = LEFT + place * width
        for kind, count, below in (("yes", a, 0), ("no", b, a)):
            if count:
                y = TOP + full * (1.0 - (below + count) / tallest)
                size = f'width="{max(width - 0.6, 0.5):.2f}" height="{full * count / tallest:.2f}"'
                bars.append(f'<rect class="{kind}" x="{x:.2f}" y="{y:.2f}" {size}><title>{note}</title></rect>')
    where = LEFT + (WIDTH - LEFT - RIGHT) * (marks - edges[0]) / (edges[-1] - edges[0])
    ticks = _ticks_x([short(mark) for mark in marks.tolist()], where.tolist(), 200.0)
    counts = [
        f'<text x="{LEFT - 6}" y="{TOP + full * (1 - share) + 4:.1f}" text-anchor="end">{tallest * share:.0f}</text>'
        for share in (0.0, 0.5, 1.0)
    ]
    return _svg(bars + ticks + counts, name if unit == "1" else f"{name} [{unit}]", 200.0)


def _places(axis: Axis, first: float, last: float) -> list[float]:
    """Return where the edges of the cells are drawn: values not evenly spaced are not shown as if they were."""
    span = float(axis.edges[-1] - axis.edges[0])
    return [first + (last - first) * float(edge - axis.edges[0]) / span for edge in axis.edges]


def _apart(places: Sequence[float], least: float) -> list[int]:
    """Return which cells have a label: none nearer to the one before than ``least``."""
    chosen: list[int] = []
    for cell in range(len(places) - 1):
        if not chosen or abs(_middle(places, cell) - _middle(places, chosen[-1])) >= least:
            chosen.append(cell)
    return chosen


def _middle(places: Sequence[float], cell: int) -> float:
    return 0.5 * (places[cell] + places[cell + 1])


def _axis_x(axis: Axis, places: Sequence[float]) -> list[str]:
    cells = _apart(places, (WIDTH - LEFT - RIGHT) / MOST_TICKS)
    lines = _ticks_x([axis.labels[cell] for cell in cells], [_middle(places, cell) for cell in cells], HEIGHT)
    label = html.escape(axis_name(axis))
    return [
        *lines,
        f'<text class="title" x="{(LEFT + WIDTH) / 2:.1f}" y="{HEIGHT - 8:.1f}" text-anchor="middle">{label}</text>',
    ]


def _axis_y(axis: Axis, places: Sequence[float]) -> list[str]:
    lines = []
    for cell in _apart(places, (HEIGHT - TOP - BOTTOM) / (2 * MOST_TICKS)):
        at = f'x="{LEFT - 6}" y="{_middle(places, cell) + 4:.1f}"'
        lines.append(f'<text class="tick" {at} text-anchor="end">{html.escape(axis.labels[cell])}</text>')
    middle = (TOP + HEIGHT - BOTTOM) / 2
    label = html.escape(axis_name(axis))
    turned = f'transform="rotate(-90 12 {middle:.1f})"'
    return [*lines, f'<text class="title" x="12" y="{middle:.1f}" text-anchor="middle" {turned}>{label}</text>']


def _ticks_x(labels: Sequence[str], places: Sequence[float], height: float) -> list[str]:
    y = height - BOTTOM + 16.0
    return [
        f'<text class="tick" x="{x:.1f}" y="{y:.1f}" text-anchor="middle">{html.escape(label)}</text>'
        for label, x in zip(labels, places, strict=True)
    ]


def _svg(parts: list[str], label: str, height: float = HEIGHT) -> str:
    frame = (
        f'<rect class="frame" x="{LEFT}" y="{TOP}" width="{WIDTH - LEFT - RIGHT}" height="{height - TOP - BOTTOM}"/>'
    )
    name = html.escape(label, quote=True)
    return f'<svg viewBox="0 0 {WIDTH:g} {height:g}" role="img" aria-label="{name}">{"".join(parts)}{frame}</svg>'
