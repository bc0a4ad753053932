"""A state chart as an SVG: states in a column, transitions as arcs, down on the right and up on the left.

Rows for any state are a short arrow at their target. Labels lie on their arcs where they cover neither another label
nor a state. Colours are those of the page (``currentColor``), so it fits light and dark pages, and nothing is fetched.
"""

import html
from collections.abc import Collection, Iterator, Mapping
from typing import NamedTuple

ROW, HEIGHT = 62.0, 30.0
FIRST_REACH, REACH = 40.0, 26.0
"""Distance of the nearest arc from the column, of each further one [px]."""
LETTER, LINE, PADDING = 6.6, 14.0, 22.0
"""Width of a letter, distance of two lines, and what a state is wider than its name [px]."""
MIN_WIDTH = 110.0
ANY = "any state"
ARROW_LENGTH = 26.0
"""Length of the arrow of a row for any state [px]."""
PLACES = (0.5, 0.42, 0.58, 0.34, 0.66, 0.27, 0.73, 0.2, 0.8, 0.14, 0.86)
"""Where along its arc a label may lie, best first."""
RED = "#d1343a"
Arc = tuple[str, str, str]
"""From, to, and when."""
Pair = tuple[str, str]


class _Box(NamedTuple):
    """An upright rectangle [px]."""

    left: float
    top: float
    right: float
    bottom: float

    def overlap(self, other: "_Box") -> float:
        """Return the area in both."""
        wide = min(self.right, other.right) - max(self.left, other.left)
        high = min(self.bottom, other.bottom) - max(self.top, other.top)
        return wide * high if wide > 0.0 and high > 0.0 else 0.0


class _Label(NamedTuple):
    """Where the words of an arc lie: the near end of their lines, and the middle of their height."""

    x: float
    y: float


class _Layout(NamedTuple):
    """Positions with x = 0 in the middle of the column of states."""

    width: float
    """Of a state."""
    place: Mapping[str, float]
    """State -> y of its middle."""
    merged: Mapping[Pair, list[str]]
    """Arc -> its guards."""
    lanes: Mapping[Pair, int]


def chart_svg(
    arcs: list[Arc], order: list[str], red_arcs: Collection[Pair] = (), red_states: Collection[str] = ()
) -> str:
    """Return the diagram of ``arcs``; states stand in the given order, others above them; some are drawn red."""
    found = [name for name in dict.fromkeys(name for arc in arcs for name in arc[:2]) if name != ANY]
    states = [name for name in found if name not in order] + [name for name in order if name in found]
    merged: dict[Pair, list[str]] = {}
    for source, target, guard in arcs:
        before = f"{ANY}: " if source == ANY and (source, target) not in merged else ""
        merged.setdefault((source, target), []).append(before + guard)
    place = {name: number * ROW + HEIGHT for number, name in enumerate(states)}
    width = max([MIN_WIDTH, *(LETTER * 1.15 * len(name) + PADDING for name in states)])
    layout = _Layout(width, place, merged, _lanes([pair for pair in merged if pair[0] != ANY], place))
    labels = _labels(layout)
    left, right = _extent(layout, labels)
    parts = [_red(_arc(pair, layout, labels[pair]), pair in red_arcs) for pair in merged]
    parts += [_red(_state(name, layout), name in red_states) for name in states]
    size = f"{left:.0f} 0 {right - left:.0f} {len(states) * ROW + HEIGHT:.0f}"
    head = f'<svg class="chart" xmlns="http://www.w3.org/2000/svg" viewBox="{size}" role="img" aria-label="state chart"'
    return f'{head} font-size="12" font-family="sans-serif">{"".join(parts)}</svg>'


def _red(part: str, is_red: bool) -> str:
    return f'<g color="{RED}">{part}</g>' if is_red else part


def _lanes(pairs: list[Pair], place: Mapping[str, float]) -> dict[Pair, int]:
    """Return for each arc which lane it takes on its side: the first where no other arc overlaps it."""
    taken: dict[tuple[int, int], list[tuple[float, float]]] = {}
    lanes = {}
    for pair in sorted(pairs, key=lambda item: abs(place[item[1]] - place[item[0]])):
        low, high = sorted((place[pair[0]], place[pair[1]]))
        side, lane = _side(pair, place), 0
        while any(low < other[1] and other[0] < high for other in taken.get((side, lane), [])):
            lane += 1
        taken.setdefault((side, lane), []).append((low, high))
        lanes[pair] = lane
    return lanes


def _side(pair: Pair, place: Mapping[str, float]) -> int:
    return 1 if pair[0] == ANY or place[pair[1]] >= place[pair[0]] else -1


def _labels(layout: _Layout) -> dict[Pair, _Label]:
    """Return where the words of each arc lie: inner lanes first, each where it covers the least of what is there."""
    taken = [_Box(-layout.width / 2, y - HEIGHT / 2, layout.width / 2, y + HEIGHT / 2) for y in layout.place.values()]
    found: dict[Pair, _Label] = {}
    for pair in sorted(layout.merged, key=lambda item: layout.lanes.get(item, -1)):
        side, guards = _side(pair, layout.place), layout.merged[pair]
        tried = [
            (_overlap(_box(label, guards, side), taken), number, label)
            for number, label in enumerate(_spots(pair, layout))
        ]
        _, _, label = min(tried)
        found[pair] = label
        taken.append(_box(label, guards, side))
    return found


def _overlap(box: _Box, taken: list[_Box]) -> float:
    return sum(box.overlap(other) for other in taken)


def _box(label: _Label, guards: list[str], side: int) -> _Box:
    """Return what the words of an arc cover."""
    far = label.x + side * LETTER * max(map(len, guards))
    high = 0.5 * LINE * len(guards)
    return _Box(min(label.x, far), label.y - high, max(label.x, far), label.y + high)


def _spots(pair: Pair, layout: _Layout) -> Iterator[_Label]:
    """Yield where the words of an arc may lie, best first."""
    if pair[0] == ANY:
        yield _Label(layout.width / 2 + ARROW_LENGTH + 5.0, layout.place[pair[1]])
        return
    start, end, edge, reach = _ends(pair, layout)
    for part in PLACES:
        x = edge + (reach - edge) * 3.0 * part * (1.0 - part)
        y = start + (end - start) * part * part * (3.0 - 2.0 * part)
        yield _Label(x + 5.0 * _side(pair, layout.place), y)


def _ends(pair: Pair, layout: _Layout) -> tuple[float, float, float, float]:
    """Return y of the start and of the end of an arc, x of both, and x of its control points."""
    side = _side(pair, layout.place)
    edge = side * layout.width / 2
    shift = 6.0 if side > 0 else -6.0
    reach = edge + side * (FIRST_REACH + REACH * layout.lanes[pair])
    return layout.place[pair[0]] + shift, layout.place[pair[1]] - shift, edge, reach


def _extent(layout: _Layout, labels: Mapping[Pair, _Label]) -> tuple[float, float]:
    """Return the least and the greatest x of the drawing."""
    boxes = [_box(label, layout.merged[pair], _side(pair, layout.place)) for pair, label in labels.items()]
    reaches = [_ends(pair, layout)[3] for pair in layout.lanes]
    xs = [-layout.width / 2, layout.width / 2, *reaches, *(box.left for box in boxes), *(box.right for box in boxes)]
    return min(xs) - 8.0, max(xs) + 8.0


def _arc(pair: Pair, layout: _Layout, label: _Label) -> str:
    """Return a curve from the side of one state to that of another, an arrow head, and the guards."""
    side, guards = _side(pair, layout.place), layout.merged[pair]
    if pair[0] == ANY:
        end, edge = layout.place[pair[1]], layout.width / 2
        curve = f"M{edge + ARROW_LENGTH:.1f},{end:.1f} L{edge:.1f},{end:.1f}"
    else:
        start, end, edge, reach = _ends(pair, layout)
        curve = f"M{edge:.1f},{start:.1f} C{reach:.1f},{start:.1f} {reach:.1f},{end:.1f} {edge:.1f},{end:.1f}"
    head = f"M{edge:.1f},{end:.1f} l{side * 8},-4 v8 z"
    anchor = "start" if side > 0 else "end"
    top = label.y + 4.0 - 0.5 * LINE * (len(guards) - 1)
    words = "".join(_text(label.x, top + LINE * number, anchor, guard, True) for number, guard in enumerate(guards))
    line = f'<path d="{curve}" fill="none" stroke="currentColor" stroke-opacity="0.55" stroke-width="1.4"/>'
    named = " ".join(f'data-{key}="{html.escape(text)}"' for key, text in _names(pair, layout.merged[pair]).items())
    return f'<g {named}>{line}<path d="{head}" fill="currentColor" fill-opacity="0.7"/>{words}</g>'


def _names(pair: Pair, guards: list[str]) -> dict[str, str]:
    return {"from": pair[0], "to": pair[1], "guards": ", ".join(guard.removeprefix(f"{ANY}: ") for guard in guards)}


def _state(name: str, layout: _Layout) -> str:
    y, width = layout.place[name], layout.width
    box = f'<rect x="{-width / 2:.1f}" y="{y - HEIGHT / 2:.1f}" width="{width:g}" height="{HEIGHT:g}" rx="7"'
    rectangle = f'{box} fill="#5c9dff" fill-opacity="0.22" stroke="#5c9dff"/>'
    return f'<g data-state="{html.escape(name)}">{rectangle}{_text(0.0, y + 4.5, "middle", name)}</g>'


def _text(x: float, y: float, anchor: str, text: str, has_halo: bool = False) -> str:
    """Return a line of text; with a halo in the colour of the page, arcs behind it do not make it hard to read."""
    halo = (
        ' paint-order="stroke" stroke="var(--card, Canvas)" stroke-width="4" stroke-linejoin="round"'
        if has_halo
        else ""
    )
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="currentColor"{halo}>{html.escape(text)}</text>'
