"""Inputs over time: constants, steps, ramps, pulses, sines, tables, CSV columns."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from modelkit.variables import Variable
from orchestrator.cosim.slave import Array
from orchestrator.text.errors import BadInput, shown, suggestion
from orchestrator.text.quantities import number, scalar


class StimulatedInput:
    """Which input of which file a stimulus is for: reads its values in the input's unit, and names it in messages."""

    def __init__(self, variable: Variable, file: Path, key: str) -> None:
        self.variable = variable
        self.file = file
        self.key = key

    def value(self, given: object) -> float:
        """Return a value of the input: a number with or without unit, the name of a state, true or false."""
        return float(scalar(given, self.variable._replace(name=self.key), file=self.file))

    def seconds(self, given: object, default: float | None = None) -> float:
        """Return a time [s]."""
        if given is None and default is not None:
            return default
        return number(given, "s", file=self.file, key=self.key)

    def wrong(self, text: str) -> BadInput:
        """Return the error that says what is wrong here."""
        return BadInput(text, file=self.file, key=self.key)


def stimulus(given: object, place: StimulatedInput, t: Array) -> Array:
    """Return the values at times ``t`` [s] of what is written for one input. Raises ``BadInput``."""
    if not isinstance(given, Mapping):
        return np.full(len(t), place.value(given))
    if len(given) != 1:
        raise place.wrong(f"{shown(dict(given))}: expected one of {', '.join(SHAPES)}")
    (word, parts), *_ = given.items()
    if word not in SHAPES:
        raise place.wrong(f"{word}: no such shape{suggestion(str(word), SHAPES)}; known are {', '.join(SHAPES)}")
    keys, make = SHAPES[word]
    if keys and not isinstance(parts, Mapping):
        raise place.wrong(f"{word}: {shown(parts)}: expected a mapping with {', '.join(keys)}")
    for key in parts if keys else ():
        if key not in keys:
            raise place.wrong(f"{word}: {key}: unknown{suggestion(str(key), keys)}; known are {', '.join(keys)}")
    try:
        return make(parts, place, t)
    except KeyError as missing:
        raise place.wrong(f"{word}: {missing.args[0]} is missing") from None


def _step(parts: Any, place: StimulatedInput, t: Array) -> Array:
    after = t >= place.seconds(parts["at"])
    return np.where(after, place.value(parts["to"]), place.value(parts.get("from", place.variable.start)))


def _ramp(parts: Any, place: StimulatedInput, t: Array) -> Array:
    begin, end = place.seconds(parts["begin"]), place.seconds(parts["end"])
    if not begin < end:
        raise place.wrong("ramp: begin is not before end")
    first = place.value(parts.get("from", place.variable.start))
    return np.interp(t, [begin, end], [first, place.value(parts["to"])])


def _pulse(parts: Any, place: StimulatedInput, t: Array) -> Array:
    at, width = place.seconds(parts["at"]), place.seconds(parts["width"])
    period = place.seconds(parts.get("period"), np.inf)
    if not 0.0 < width < period:
        raise place.wrong("pulse: expected 0 < width < period")
    since = t - at if period == np.inf else np.where(t >= at, np.mod(t - at, period), -1.0)
    low, high = place.value(parts.get("from", place.variable.start)), place.value(parts["to"])
    return np.where((since >= 0.0) & (since < width), high, low)


def _sine(parts: Any, place: StimulatedInput, t: Array) -> Array:
    begin = place.seconds(parts.get("begin"), 0.0)
    rate = 2.0 * np.pi * number(parts["frequency"], "Hz", file=place.file, key=place.key)
    middle = place.value(parts.get("offset", 0.0))
    swing = place.value(parts["amplitude"]) * np.sin(rate * (t - begin))
    return middle + np.where(t >= begin, swing, 0.0)


def _table(parts: Any, place: StimulatedInput, t: Array) -> Array:
    """``[[time, value], ...]``: numbers between rows are interpolated; truth values and states are held."""
    if not isinstance(parts, list) or not all(isinstance(row, list) and len(row) == 2 for row in parts):
        raise place.wrong("table: expected [[time, value], ...]")
    return _along(np.array([place.seconds(row[0]) for row in parts]), [place.value(row[1]) for row in parts], place, t)


def _csv(parts: Any, place: StimulatedInput, t: Array) -> Array:
    """A column of a CSV file by its name, over its first column, the time [s]; a row of units is skipped."""
    path = place.file.parent / str(parts["file"])
    try:
        rows = [line.split(",") for line in path.read_text(encoding="utf-8").splitlines() if line.strip()]
    except OSError as error:
        raise place.wrong(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise place.wrong(f"{path} is not text in UTF-8") from error
    if len(rows) < 2 or any(len(row) != len(rows[0]) for row in rows):
        raise place.wrong(f"{path}: expected a row of names, rows of numbers, and as many of them in each")
    heads, column = [name.strip() for name in rows[0]], str(parts["column"])
    if column not in heads:
        raise place.wrong(f"{path} has no column {column}{suggestion(column, heads)}")
    start = 1 if _is_number(rows[1][0]) else 2
    at = heads.index(column)
    times = np.array([place.seconds(row[0].strip()) for row in rows[start:]])
    return _along(times, [place.value(row[at].strip()) for row in rows[start:]], place, t)


def _along(times: Array, values: list[float], place: StimulatedInput, t: Array) -> Array:
    if len(times) == 0 or (np.diff(times) < 0.0).any():
        raise place.wrong("times have to rise from row to row")
    if place.variable.kind is float:
        return np.interp(t, times, values)
    return np.asarray(values)[np.maximum(np.searchsorted(times, t, side="right") - 1, 0)]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


Shape = tuple[tuple[str, ...], Callable[[Any, StimulatedInput, Array], Array]]
SHAPES: dict[str, Shape] = {
    "step": (("at", "from", "to"), _step),
    "ramp": (("begin", "end", "from", "to"), _ramp),
    "pulse": (("at", "width", "period", "from", "to"), _pulse),
    "sine": (("amplitude", "frequency", "offset", "begin"), _sine),
    "table": ((), _table),
    "csv": (("file", "column"), _csv),
}
"""Shape -> its keys (none: a list), and what makes it."""
