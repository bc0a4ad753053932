"""Tables of inputs in all their dialects: what is written is what is read; what is damaged is refused, or the same."""

import csv
import io
import math
import random
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np

from modelkit.signal import Signal
from modelkit.variables import Variable
from orchestrator.inputs.text.errors import BadInput
from orchestrator.testing.steptest.stimuli import StimulatedInput, stimulus

T = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
UNITS = {
    "m/s": {"m/s": 1.0, "km/h": 1.0 / 3.6, "kph": 1.0 / 3.6, "mph": 0.44704, "m/sec": 1.0},
    "rad": {"rad": 1.0, "deg": math.pi / 180.0, "°": math.pi / 180.0},
    "m": {"m": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0},
    "m/s2": {"m/s2": 1.0, "m/s^2": 1.0, "m/s²": 1.0},
    "1": {"1": 1.0, "-": 1.0, "%": 0.01},
}
"""Unit of the input -> unit of a table -> factor."""
TIMES = {"s": 1.0, "ms": 0.001, "min": 60.0}
NAMES = ("v", "speed request", "vehicle.speed", "x[3]", "y[2,1]", "left, front", "Geschw. über Grund", "a (b) c")
DAMAGES = ("no cell", "one cell more", "not a number", "nan", "empty", "earlier", "twice", "other unit", "no rows")


class Written(NamedTuple):
    """A table as it is written."""

    data: bytes
    column: str
    unit: str
    """Of the input."""
    values: list[float]
    """What the input gets at ``T``."""
    what: str


def written(draw: random.Random, damage: str = "") -> Written:
    """Return a random table, with one mistake if that is requested."""
    unit = draw.choice(list(UNITS))
    given, factor = draw.choice(list(UNITS[unit].items()))
    time_unit, time_factor = draw.choice(list(TIMES.items()))
    delimiter = draw.choice(",;\t")
    comma = delimiter != "," and draw.random() < 0.5
    name, form = draw.choice(NAMES), draw.choice(("none", "[]", "()", "row", "row[]", "cells", " / "))
    if form == "none" or (given in ("%", "°") and form == "cells") or (form == " / " and " " in given):
        form, given, factor = "none", unit, 1.0
    if form in ("none", "cells"):
        time_unit, time_factor = "s", 1.0
    si = [round(draw.uniform(-50.0, 50.0), draw.randrange(4)) + draw.randrange(2) for _ in T]
    numbers = [repr(value / factor) for value in si]
    cells = [[repr(t / time_factor), text, "7.5"] for t, text in zip(T.tolist(), numbers, strict=True)]
    heads = _heads(form, name, given, time_unit)
    rows = [[_cell(cell, form, place, given) for place, cell in enumerate(row)] for row in cells]
    below = (
        [time_unit, given, ""] if form == "row" else [f"[{time_unit}]", f"[{given}]", "[]"] if form == "row[]" else None
    )
    if damage:
        rows = _damaged(damage, rows, heads, draw)
        if damage == "other unit":
            heads, below = [heads[0], f"{name} [kg]", heads[2]], None
    order = [1, 0, 2] if draw.random() < 0.3 and not damage else [0, 1, 2]
    table = [heads, *([below] if below is not None else []), *rows]
    if draw.random() < 0.3:
        table = [[*row, ""] for row in table] if not damage else table
    text = _text(
        [[row[place] for place in (*order, *range(3, len(row)))] if not damage else row for row in table],
        delimiter,
        comma,
        draw,
    )
    code = draw.choice(("utf-8", "utf-8-sig", "utf-16")) if delimiter == "\t" else draw.choice(("utf-8", "utf-8-sig"))
    column = draw.choice((heads[1], name)) if form in ("[]", "()", " / ") else name
    what = (
        f"{unit} from {given} {form}, time {time_unit}, {delimiter!r}{' with commas' if comma else ''} {code} {damage}"
    )
    return Written(text.encode(code), column, unit, [float(text) * factor for text in numbers], what)


def _heads(form: str, name: str, unit: str, time_unit: str) -> list[str]:
    if form in ("[]", "()"):
        return [f"time {form[0]}{time_unit}{form[1]}", f"{name} {form[0]}{unit}{form[1]}", "other"]
    return [f"time / {time_unit}", f"{name} / {unit}", "other"] if form == " / " else ["time", name, "other"]


def _cell(cell: str, form: str, place: int, unit: str) -> str:
    return f"{cell} {unit}" if form == "cells" and place == 1 and unit != "-" else cell


def _damaged(damage: str, rows: list[list[str]], heads: list[str], draw: random.Random) -> list[list[str]]:
    number = draw.randrange(1, len(rows))
    row, changed = rows[number], [list(item) for item in rows]
    changes: dict[str, Callable[[], list[list[str]]]] = {
        "no cell": lambda: [*changed[:number], row[:-1], *changed[number + 1 :]],
        "one cell more": lambda: [*changed[:number], [*row, "1"], *changed[number + 1 :]],
        "not a number": lambda: [*changed[:number], [row[0], "one", row[2]], *changed[number + 1 :]],
        "nan": lambda: [*changed[:number], [row[0], "nan", row[2]], *changed[number + 1 :]],
        "empty": lambda: [*changed[:number], [row[0], "", row[2]], *changed[number + 1 :]],
        "earlier": lambda: [*changed[:number], ["-1", *row[1:]], *changed[number + 1 :]],
        "no rows": lambda: [],
    }
    if damage == "twice":
        heads[2] = heads[1]
    return changes[damage]() if damage in changes else changed


def _text(table: list[list[str]], delimiter: str, comma: bool, draw: random.Random) -> str:
    stream = io.StringIO()
    end, is_quoted = draw.choice(("\n", "\r\n")), draw.random() < 0.5
    quoting: Literal[0, 1] = csv.QUOTE_ALL if is_quoted else csv.QUOTE_MINIMAL
    writer = csv.writer(stream, delimiter=delimiter, quoting=quoting, lineterminator=end)
    heads = 1 if table else 0
    for place, row in enumerate(table):
        is_number = place >= heads and comma
        writer.writerow([cell.replace(".", ",") if is_number and cell[:1] in "-0123456789" else cell for cell in row])
    return stream.getvalue()


def fuzz(folder: Path, log: Path, draw: random.Random) -> Iterator[tuple[list[str], str]]:
    """Read one table after the other without end; yield what it is and what was wrong, empty if nothing."""
    file = folder / "odd.csv"
    while True:
        kind = draw.randrange(3)
        damage = draw.choice(DAMAGES) if kind == 1 else ""
        table = written(draw, damage)
        data = _scrambled(table.data, draw) if kind == 2 else table.data
        file.write_bytes(data)
        variable = Variable("input", float, Signal(table.unit, "an input"), 0.0)
        place = StimulatedInput(variable, folder / "odd.yaml", "inputs.input")
        try:
            found = stimulus({"csv": {"file": file.name, "column": table.column}}, place, T)
        except BadInput as error:
            mistake = _refused(str(error)) or (f"refused: {error}" if kind == 0 else "")
        except Exception as error:
            mistake = f"{type(error).__name__}: {error}"
        else:
            mistake = "" if np.isfinite(found).all() else "not finite"
            if kind == 1:
                mistake = f"read as {found.tolist()}"
            elif kind == 0 and not np.allclose(found, table.values, rtol=1e-12, atol=1e-12):
                mistake = f"read as {found.tolist()}, expected {table.values}"
        yield ["table", table.what], mistake and f"{mistake}\n{data[:400]!r}"


def _refused(text: str) -> str:
    """Return what is wrong with a message; empty if it is one line that names the file."""
    return "" if "odd.csv" in text and "\n" not in text else f"message: {text!r}"


def _scrambled(data: bytes, draw: random.Random) -> bytes:
    changed = bytearray(data)
    for _ in range(draw.choice((1, 2, 5))):
        at = draw.randrange(len(changed))
        change = draw.randrange(3)
        if change == 0:
            changed[at] = draw.randrange(256)
        elif change == 1:
            del changed[at : at + draw.randrange(1, 6)]
        else:
            changed[at:at] = draw.choice((b'"', b",", b";", b"\n", b"\t", b"[km/h]", b"\r", b"\0", b"1e999", b"NaN"))
        if not changed:
            return b"x"
    return bytes(changed)
