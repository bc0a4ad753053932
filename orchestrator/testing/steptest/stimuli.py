"""Inputs over time: constants, steps, ramps, pulses, sines, tables, CSV columns."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from modelkit.variables import Variable
from orchestrator.inputs.text.errors import BadInput, format_value, suggestion
from orchestrator.inputs.text.quantities import FACTORS, NS_PER_SECOND, number, scalar, unit_symbol
from orchestrator.inputs.text.table_file import TableError, TextTable, read_table, unit_in_name
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.system.units import UnfitUnitsError, conversion


class StimulatedInput:
    """Which input of which file a stimulus is for: reads its values in the input's unit, and names it in messages."""

    def __init__(self, variable: Variable, file: Path, key: str) -> None:
        self.variable = variable
        self.file = file
        self.key = key

    def value(self, given: object) -> float:
        """Return a value of the input: a number with or without unit, the name of a state, true or false."""
        return float(scalar(given, self.variable._replace(name=self.key), file=self.file))

    def cell(self, given: object) -> float:
        """Return a value as :meth:`value` does, but name neither file nor key where it has none."""
        return float(scalar(given, self.variable))

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
        raise place.wrong(f"{format_value(dict(given))}: expected one of {', '.join(SHAPES)}")
    (word, parts), *_ = given.items()
    if word not in SHAPES:
        raise place.wrong(f"{word}: no such shape{suggestion(str(word), SHAPES)}; known are {', '.join(SHAPES)}")
    keys, make = SHAPES[word]
    if keys and not isinstance(parts, Mapping):
        raise place.wrong(f"{word}: {format_value(parts)}: expected a mapping with {', '.join(keys)}")
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
    """A column of a table by its name, over its column of times, both in the units that the table says."""
    path = place.file.parent / str(parts["file"])
    try:
        table = read_table(path)
        column = table.column(str(parts["column"]))
        times = table_times(table)
        values = column_values(table, column, place, parts.get("unit"))
    except OSError as error:
        raise place.wrong(f"{path}: cannot be read: {error.strerror}") from error
    except (TableError, UnfitUnitsError) as error:
        raise place.wrong(f"{path}: {error}") from None
    falls = next((row for row in range(1, len(times)) if times[row] < times[row - 1]), 0)
    if falls:
        raise place.wrong(f"{path}: line {table.lines[falls]}: its time is before that of the row above")
    if times[0] > t[-1] or times[-1] < 0.0:
        text = f"{path}: its times, {times[0]:g} to {times[-1]:g} s, lie outside the test, 0 to {t[-1]:g} s"
        raise place.wrong(text)
    return _along(np.array(times), values, place, t)


def table_times(table: TextTable) -> list[float]:
    """Return the times of all rows [s]. Raises ``TableError``."""
    return [_in_unit(table, row, table.time, "s", lambda text: number(text, "s")) for row in range(len(table.rows))]


def column_values(table: TextTable, column: int, place: StimulatedInput, written: object) -> list[float]:
    """Return the numbers of a column in the unit of the input, which the table, or ``written``, says.

    Raises ``TableError``, or ``UnfitUnitsError`` for a unit of another quantity.
    """
    head, taken = table.heads[column], place.variable.signal.unit
    given = head.unit if written is None else unit_symbol(str(written))
    if head.unit not in (None, given):
        raise TableError(f"column {head.written} is in {head.unit}, unit: says {given}")
    own = head.name.rpartition(".")[2] == place.variable.name.rpartition(".")[2]
    hint = None if given is not None or own else unit_in_name(head.name)
    if hint not in (None, taken) and place.variable.kind is float:
        raise TableError(f"column {head.written} may be in {hint} by its name; write unit: {hint}, or unit: {taken}")
    filled = table._replace(heads=[item._replace(unit=given) for item in table.heads])
    return [_in_unit(filled, row, column, taken, place.cell) for row in range(len(table.rows))]


def _in_unit(table: TextTable, row: int, column: int, taken: str, value: Callable[[object], float]) -> float:
    """Return one cell in the unit ``taken``, read by ``value``. Raises ``TableError`` with its line."""
    head, cell = table.heads[column], table.rows[row][column]
    try:
        factor, offset = (1.0, 0.0) if head.unit is None else conversion(head.unit, taken, {}, {})
        if not cell:
            raise TableError("is empty")
        if (factor, offset) == (1.0, 0.0):
            return value(cell)
        magnitude = number(cell, head.unit or taken, any_value=True)
        return value(magnitude / round(1.0 / factor) if _is_inverse(factor) else magnitude * factor + offset)
    except UnfitUnitsError:
        example = next((name for name, (target, _) in FACTORS.items() if target == taken), "")
        text = f"column {head.written} is in {head.unit}; expected {taken}{' or ' + example if example else ''}"
        raise TableError(text) from None
    except ValueError as error:
        raise TableError(f"line {table.lines[row]}: {head.written}: {error}") from None


def _is_inverse(factor: float) -> bool:
    """Return whether a factor is one over a whole number, by which division is exact where it can be."""
    return 0.0 < factor < 1.0 and abs(1.0 / factor - round(1.0 / factor)) < 1e-6 and factor == 1.0 / round(1.0 / factor)


def _along(times: Array, values: list[float], place: StimulatedInput, t: Array) -> Array:
    """Return the values at ``t``: those of rows at just this nanosecond as they are, of several the last."""
    if len(times) == 0 or (np.diff(times) < 0.0).any():
        raise place.wrong("times have to rise from row to row")
    rows_ns, t_ns, given = (
        np.rint(times * NS_PER_SECOND),
        np.rint(t * NS_PER_SECOND),
        np.asarray(values, dtype=np.float64),
    )
    before = np.maximum(np.searchsorted(rows_ns, t_ns, side="right") - 1, 0)
    if place.variable.kind is not float:
        return given[before]
    return np.where(rows_ns[before] == t_ns, given[before], np.interp(t, times, given))


Shape = tuple[tuple[str, ...], Callable[[Any, StimulatedInput, Array], Array]]
SHAPES: dict[str, Shape] = {
    "step": (("at", "from", "to"), _step),
    "ramp": (("begin", "end", "from", "to"), _ramp),
    "pulse": (("at", "width", "period", "from", "to"), _pulse),
    "sine": (("amplitude", "frequency", "offset", "begin"), _sine),
    "table": ((), _table),
    "csv": (("file", "column", "unit"), _csv),
}
"""Shape -> its keys (none: a list), and what makes it."""
