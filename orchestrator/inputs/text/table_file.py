"""Tables of numbers as other tools write them: commas, semicolons or tabs, quoted names, units in the header or a row.

What a table says is read, or refused with its line; nothing of it is skipped. Numbers stay text here: whoever knows
the variable brings them into its unit.
"""

import csv
import io
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from orchestrator.inputs.text.errors import suggestion
from orchestrator.inputs.text.quantities import QUANTITY, unit_symbol

MAX_BYTES = 200_000_000
DELIMITERS = (";", "\t")
"""Other than the comma, which a table has that has neither of these in its header."""
TIME_NAMES = ("time", "times", "t", "timestamp", "timestamps", "sim_time", "simulation_time", "elapsed_time", "seconds")
BRACKETS = re.compile(
    r"(?P<name>.*?\S)(?P<space>\s*)"
    r"(?:\[(?P<square>[^\[\]]*)\]|\((?P<round>[^()]*)\)|\{(?P<curly>[^{}]*)\}|<(?P<angle>[^<>]*)>)",
    re.DOTALL,
)
AFTER_WORD = re.compile(r"(?P<name>.*\S)\s+(?:in|/)\s+(?P<unit>\S+)", re.DOTALL)
INDEX = re.compile(r"[\d,\s]*")
SUFFIX = re.compile(
    r"(?:[ _.\-/|:,;]|(?-i:(?<=[a-z])(?=[A-Z])))"
    r"(degs?|degrees?|°|km[_/]?p?h|kph|mph|km|dm|cm|mm|ft|deg[_/]?s|deg_per_s(?:ec)?|rpm|mrad|%|percent|pct)$",
    re.IGNORECASE,
)
"""How the name of a signal ends that holds its unit."""
TIME_SUFFIX = re.compile(r"[ _.\-](ns|us|ms|s|sec|seconds|min|minutes|h|hours)$", re.IGNORECASE)
DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+(?:[eE][-+]?\d+)?(?:\s*[^\d\s,.;-][^,]*|\s+1)?")
GROUPED = re.compile(r"[-+]?[1-9]\d{0,2}(?:,\d{3})+(?:\s*[^\d\s,.;-][^,]*|\s+1)?")
"""A number with a decimal comma, or with commas between thousands: nobody can tell."""


class TableError(ValueError):
    """What is wrong with a table, and what would be right."""


class Head(NamedTuple):
    """One column as its header defines it."""

    written: str
    """As it stands there."""
    name: str
    """Without its unit."""
    unit: str | None
    """None: the table says none."""

    def means(self, column: str) -> bool:
        """Return whether ``column`` is this one."""
        return column.strip() in (self.written, self.name)


class TextTable(NamedTuple):
    """Columns of texts over a column of times."""

    heads: list[Head]
    rows: list[list[str]]
    lines: list[int]
    """Line of each row in the file."""
    time: int
    """Which column is the time."""

    def column(self, name: str) -> int:
        """Return which column is called ``name``, with or without its unit. Raises ``TableError``."""
        found = [place for place, head in enumerate(self.heads) if head.means(name)]
        exact = [place for place in found if self.heads[place].written == name.strip()]
        if self.time in found and not _is_time(self.heads[self.time]):
            raise TableError(f"has no column of times: the first one, {name}, would be its own time")
        if len(found) > 1 and len(exact) != 1:
            raise TableError(f"has {len(found)} columns {name}: which one is meant is ambiguous")
        if not found:
            names = [head.written for head in self.heads]
            same = [item for item in names if item.casefold().startswith(name.strip().casefold())]
            close = f"; did you mean {same[0]}?" if same else suggestion(name, names)
            raise TableError(f"has no column {name}{close or '; it has ' + ', '.join(names[:12])}")
        return exact[0] if exact else found[0]


def read_table(path: Path) -> TextTable:
    """Return the table in a file. Raises ``TableError``, or ``OSError`` if it cannot be read."""
    text = _text(path)
    first = next((line for line in text.splitlines() if line.strip()), "")
    delimiter = next((mark for mark in DELIMITERS if mark in re.sub(r'"[^"]*"', "", first)), ",")
    found = list(_cells(text, delimiter))
    if len(found) < 2:
        raise TableError("expected a row of names and rows of numbers")
    width = len(found[0][1])
    for line, row in found:
        if len(row) != width:
            raise TableError(f"line {line} has {len(row)} values, the header {width} names")
    lines, rows = [line for line, _ in found], [row for _, row in found]
    heads = [_head(cell) for cell in rows.pop(0)]
    del lines[0]
    time = _time_column(heads)
    heads[time] = _with_time_unit(heads[time])
    if not _is_quantity(rows[0][time], delimiter):
        heads = _with_units(heads, rows.pop(0), lines.pop(0))
    if not rows:
        raise TableError("has names, but no row of numbers")
    if delimiter != ",":
        rows = _with_points(rows)
    return TextTable(heads, rows, lines, time)


def unit_in_name(name: str) -> str | None:
    """Return the unit that the name of a column ends with, ``deg`` of ``angle_deg``; None if there is none."""
    match = SUFFIX.search(name)
    if match is None:
        return None
    word = match[1].lower().replace("_per_", "_")
    return {"km_h": "km/h", "deg_s": "deg/s", "degs": "deg/s", "deg_sec": "deg/s"}.get(word, unit_symbol(word))


def _text(path: Path) -> str:
    if not path.is_file():
        raise TableError("cannot be read: " + ("it is a folder" if path.is_dir() else "no such file"))
    if path.stat().st_size > MAX_BYTES:
        raise TableError(f"is larger than {MAX_BYTES} bytes")
    data = path.read_bytes()
    code = "utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"
    try:
        text = data.decode(code)
    except UnicodeDecodeError:
        raise TableError("is not text in UTF-8") from None
    if "\0" in text:
        raise TableError("is not text: it has zero bytes")
    return text


def _cells(text: str, delimiter: str) -> Iterator[tuple[int, list[str]]]:
    """Yield (line, cells) of each row that is not empty; a last column without name and values is none."""
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, skipinitialspace=True, strict=True)
    found = []
    try:
        for row in reader:
            if any(cell.strip() for cell in row):
                found.append((reader.line_num, [" ".join(cell.split()) for cell in row]))
    except csv.Error as error:
        raise TableError(f"line {reader.line_num}: {error}") from None
    while found and len(found[0][1]) > 1 and all(len(row) == len(found[0][1]) and not row[-1] for _, row in found):
        found = [(line, row[:-1]) for line, row in found]
    yield from found


def _head(written: str) -> Head:
    """Return a name with its unit in brackets of any kind, or behind a slash; ``x[3]`` and ``x(3)`` have none."""
    match = BRACKETS.fullmatch(written)
    if match is not None:
        inside = next(match[kind] for kind in ("square", "round", "curly", "angle") if match[kind] is not None)
        is_index = not match["space"] and INDEX.fullmatch(inside) is not None and inside.strip() != ""
        return Head(written, written, None) if is_index else Head(written, match["name"], unit_symbol(inside))
    match = AFTER_WORD.fullmatch(written)
    return Head(written, match["name"], unit_symbol(match["unit"])) if match else Head(written, written, None)


def _time_column(heads: list[Head]) -> int:
    """Return the column called time, else the first."""
    named = [place for place, head in enumerate(heads) if _is_time(head)]
    same = [place for place in named if heads[place].name == heads[named[0]].name]
    if len(same) > 1 or (len(named) > 1 and named[0] != 0):
        raise TableError(f"has {len(named)} columns of times: {', '.join(heads[place].written for place in named)}")
    return named[0] if named else 0


def _is_time(head: Head) -> bool:
    return TIME_SUFFIX.sub("", head.name).casefold().replace(" ", "_") in TIME_NAMES


def _with_time_unit(head: Head) -> Head:
    """Return the head of the times with the unit that its name ends with: ``time_ms``."""
    match = TIME_SUFFIX.search(head.name)
    return head if match is None or head.unit is not None else head._replace(unit=unit_symbol(match[1].lower()))


def _with_units(heads: list[Head], row: list[str], line: int) -> list[Head]:
    """Return the heads with the units in the row below them. Raises ``TableError`` if they differ."""
    found = []
    for head, cell in zip(heads, row, strict=True):
        inside = re.fullmatch(r"\[(.*)\]|\((.*)\)", cell)
        written = cell if inside is None else inside[1] if inside[1] is not None else inside[2]
        unit = unit_symbol(written) if written else None
        if unit is not None and head.unit not in (None, unit):
            raise TableError(f"line {line}: {head.written} is in {written}, and in {head.unit} by its name")
        found.append(head if unit is None else head._replace(unit=unit))
    return found


def _is_quantity(cell: str, delimiter: str) -> bool:
    text = cell.replace(",", ".") if delimiter != "," and DECIMAL_COMMA.fullmatch(cell) else cell
    return QUANTITY.fullmatch(text[:60]) is not None


def _with_points(rows: list[list[str]]) -> list[list[str]]:
    """Return the cells with decimal points. Raises ``TableError`` where commas may stand between thousands."""
    commas = [cell for row in rows for cell in row if DECIMAL_COMMA.fullmatch(cell)]
    if not commas:
        return rows
    if all(GROUPED.fullmatch(cell) for cell in commas):
        raise TableError(
            f"{commas[0]} has a decimal comma, or one between thousands: write {commas[0].replace(',', '.')}"
        )
    return [[cell.replace(",", ".") if DECIMAL_COMMA.fullmatch(cell) else cell for cell in row] for row in rows]
