"""A state chart as an SVG: states in a column, transitions as arcs, down on the right and up on the left.

Colours are the page's own (``currentColor``), so it fits light and dark pages, and nothing is fetched.
"""

import html
from collections.abc import Collection

ROW, WIDTH, HEIGHT = 62.0, 190.0, 30.0
FIRST_REACH, REACH, LABEL = 46.0, 50.0, 6.3
"""Distance of the nearest arc from the column, of each further one [px]; width of a letter [px]."""

RED = "#d1343a"
Arc = tuple[str, str, str]
"""From, to, and when."""


def chart_svg(
    arcs: list[Arc], order: list[str], red_arcs: Collection[tuple[str, str]] = (), red_states: Collection[str] = ()
) -> str:
    """Return the diagram of ``arcs``; states stand in the given order, others above them; some are drawn red."""
    found = list(dict.fromkeys(name for arc in arcs for name in arc[:2]))
    states = [name for name in found if name not in order] + [name for name in order if name in found]
    place = {name: number * ROW + HEIGHT for number, name in enumerate(states)}
    merged: dict[tuple[str, str], list[str]] = {}
    for source, target, guard in arcs:
        merged.setdefault((source, target), []).append(guard)
    lanes = _lanes(list(merged), place)
    left, right = (_widest(merged, lanes, place, side) for side in (-1, 1))
    middle = left + WIDTH / 2
    parts = [_red(_arc(pair, guards, place, lanes[pair], middle), pair in red_arcs) for pair, guards in merged.items()]
    parts += [_red(_state(name, middle, place[name]), name in red_states) for name in states]
    size = f"0 0 {left + WIDTH + right:.0f} {len(states) * ROW + HEIGHT:.0f}"
    head = f'<svg class="chart" xmlns="http://www.w3.org/2000/svg" viewBox="{size}" role="img" aria-label="state chart"'
    return f'{head} font-size="12" font-family="sans-serif">{"".join(parts)}</svg>'


def _red(part: str, is_red: bool) -> str:
    return f'<g color="{RED}">{part}</g>' if is_red else part


def _lanes(pairs: list[tuple[str, str]], place: dict[str, float]) -> dict[tuple[str, str], int]:
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


def _side(pair: tuple[str, str], place: dict[str, float]) -> int:
    return 1 if place[pair[1]] >= place[pair[0]] else -1


def _widest(
    merged: dict[tuple[str, str], list[str]], lanes: dict[tuple[str, str], int], place: dict[str, float], side: int
) -> float:
    """Return the room [px] that the arcs on one side and their words need."""
    widths = [
        FIRST_REACH + REACH * lanes[pair] + LABEL * max(len(guard) for guard in guards) + 16.0
        for pair, guards in merged.items()
        if _side(pair, place) == side
    ]
    return max(widths, default=20.0)


def _arc(pair: tuple[str, str], guards: list[str], place: dict[str, float], lane: int, middle: float) -> str:
    """Return a curve from the side of one state to that of another, an arrow head, and the guards."""
    side = _side(pair, place)
    edge = middle + side * WIDTH / 2
    shift = 6.0 if side > 0 else -6.0
    start, end = place[pair[0]] + shift, place[pair[1]] - shift
    reach = edge + side * (FIRST_REACH + REACH * lane)
    curve = f"M{edge:.1f},{start:.1f} C{reach:.1f},{start:.1f} {reach:.1f},{end:.1f} {edge:.1f},{end:.1f}"
    head = f"M{edge:.1f},{end:.1f} l{side * 8},-4 v8 z"
    x = edge + side * (0.75 * (FIRST_REACH + REACH * lane) + 5.0)
    anchor = "start" if side > 0 else "end"
    top = 0.5 * (start + end) + 4.0 - 7.0 * (len(guards) - 1)
    words = "".join(_text(x, top + 14.0 * number, anchor, guard) for number, guard in enumerate(guards))
    line = f'<path d="{curve}" fill="none" stroke="currentColor" stroke-opacity="0.55" stroke-width="1.4"/>'
    named = " ".join(f'data-{key}="{html.escape(text)}"' for key, text in _names(pair, guards).items())
    return f'<g {named}>{line}<path d="{head}" fill="currentColor" fill-opacity="0.7"/>{words}</g>'


def _names(pair: tuple[str, str], guards: list[str]) -> dict[str, str]:
    return {"from": pair[0], "to": pair[1], "guards": ", ".join(guards)}


def _state(name: str, middle: float, y: float) -> str:
    box = f'<rect x="{middle - WIDTH / 2:.1f}" y="{y - HEIGHT / 2:.1f}" width="{WIDTH:g}" height="{HEIGHT:g}" rx="7"'
    rectangle = f'{box} fill="#5c9dff" fill-opacity="0.22" stroke="#5c9dff"/>'
    return f'<g data-state="{html.escape(name)}">{rectangle}{_text(middle, y + 4.5, "middle", name)}</g>'


def _text(x: float, y: float, anchor: str, text: str) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="currentColor">{html.escape(text)}</text>'
