"""Numbers as people write them, ``570 deg``, ``5 km/h``, and back: the only place with conversion factors."""

import math
import re
from contextlib import suppress
from typing import Annotated

from pydantic import BeforeValidator, Field

from modelkit.variables import Variable
from orchestrator.inputs.text.errors import BadInput, format_value, suggestion

RAD_PER_DEGREE = math.pi / 180.0
NS_PER_SECOND = 1_000_000_000
"""In a second."""
FACTORS: dict[str, tuple[str, float]] = {
    "deg": ("rad", RAD_PER_DEGREE),
    "deg/s": ("rad/s", RAD_PER_DEGREE),
    "deg/s2": ("rad/s2", RAD_PER_DEGREE),
    "km/h": ("m/s", 1.0 / 3.6),
    "mph": ("m/s", 0.44704),
    "cm": ("m", 0.01),
    "mm": ("m", 0.001),
    "km": ("m", 1000.0),
    "ms": ("s", 0.001),
    "us": ("s", 1e-6),
    "ns": ("s", 1e-9),
    "min": ("s", 60.0),
    "h": ("s", 3600.0),
    "kN": ("N", 1000.0),
    "%": ("1", 0.01),
}
QUANTITY = re.compile(
    r"\s*+([-+]?(?:\d++(?:\.\d*+)?|\.\d++)(?:[eE][-+]?\d++)?|[-+]?inf|nan)\s*+([A-Za-z%/0-9^.*°²µ]*+)\s*+", re.ASCII
)
SAME_UNIT = {
    **dict.fromkeys(("", "-", "--", "none", "n/a", "NA", "N/A", "bool", "boolean", "enum"), "1"),
    **dict.fromkeys(("°", "degree", "degrees", "degs", "Deg"), "deg"),
    **dict.fromkeys(("radian", "radians", "Rad"), "rad"),
    **dict.fromkeys(("°/s", "deg/sec", "degrees/s", "degree/s"), "deg/s"),
    **dict.fromkeys(("rad/sec", "radians/s"), "rad/s"),
    **dict.fromkeys(("kph", "kmh", "kmph", "km/hr", "Km/h", "KM/H"), "km/h"),
    **dict.fromkeys(("m/sec", "mps"), "m/s"),
    **dict.fromkeys(("sec", "secs", "second", "seconds"), "s"),
    **dict.fromkeys(("msec", "milliseconds"), "ms"),
    **dict.fromkeys(("minute", "minutes"), "min"),
    **dict.fromkeys(("hour", "hours"), "h"),
    **dict.fromkeys(("meter", "meters", "metre", "metres"), "m"),
}
"""How others write a unit -> how it is written here."""
MOST_LETTERS = 60
"""A number with its unit is not longer."""
MOST_WHOLE = 1 << 31
Whole = Annotated[int, Field(ge=-MOST_WHOLE, lt=MOST_WHOLE)]
"""A whole number as FMI has them."""
MAX_MAGNITUDE = 1e15
"""No number that anybody means is larger, in SI."""


def number(value: object, unit: str, *, file: object = None, key: str | None = None, any_value: bool = False) -> float:
    """Return ``value`` (a number, or text such as ``30 deg/s``) in the SI ``unit``.

    Raises ``BadInput`` if it is no number, has another dimension or, unless ``any_value`` will do, is not finite or
    larger than anything that is.
    """
    result = _in_si(value, unit, file, key)
    if not any_value and not abs(result) <= MAX_MAGNITUDE:
        text = f"expected a finite number, not beyond {MAX_MAGNITUDE:g}"
        raise BadInput(f"{format_value(value)}: {text}", file=file, key=key)
    return result


def _in_si(value: object, unit: str, file: object, key: str | None) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise BadInput(f"{format_value(value)} is not a number, expected {_example(unit)}", file=file, key=key)
    if not isinstance(value, str):
        return float(value) if isinstance(value, float) or abs(value) <= MAX_MAGNITUDE else math.inf
    match = _parts(value)
    if match is None:
        raise BadInput(f"{format_value(value)} is not a number, expected {_example(unit)}", file=file, key=key)
    magnitude, written = float(match[1]), unit_symbol(match[2]) if match[2] else ""
    if written in ("", unit) or match[2] == unit or written == unit_symbol(unit):
        return magnitude
    target, factor = FACTORS.get(written, ("", 0.0))
    if target != unit:
        raise BadInput(f"{format_value(value)} is in {written!r}, expected {_example(unit)}", file=file, key=key)
    return magnitude * factor


def unit_symbol(written: str) -> str:
    """Return a unit as it is written here: ``km/h`` for kph, ``m/s2`` for m/s^2, ``1`` for a dash."""
    text = written.strip().replace("²", "2").replace("³", "3").replace("**", "^").replace("µ", "u").replace("μ", "u")
    return SAME_UNIT.get(text, re.sub(r"\^(?=-?\d)", "", text).replace("°", "deg"))


def _parts(text: str) -> "re.Match[str] | None":
    """Return a quantity as number and unit; None if it is none."""
    return QUANTITY.fullmatch(text) if len(text) <= MOST_LETTERS else None


def parse_quantity(value: object, *, file: object = None, key: str | None = None) -> tuple[float, str | None]:
    """Return ``value`` in SI and the SI unit its text has (None if it has none). Raises ``BadInput``."""
    match = _parts(value) if isinstance(value, str) else None
    if match is None or not match[2]:
        return number(value, "1", file=file, key=key), None
    written = unit_symbol(match[2])
    unit = FACTORS[written][0] if written in FACTORS else written
    return number(value, unit, file=file, key=key), unit


def text_or_scalar(value: object, variable: Variable, *, file: object = None) -> float | int | bool | str:
    """Return ``value`` as the type of a parameter: as :func:`scalar` does, or a text. Raises ``BadInput``."""
    if variable.kind is not str:
        return scalar(value, variable, file=file)
    if not isinstance(value, str):
        text = f"{format_value(value)} is no text, which this is; write it in quotes: {str(value)!r}"
        raise BadInput(text, file=file, key=variable.name)
    return value


def scalar(value: object, variable: Variable, *, file: object = None) -> float | int | bool:
    """Return ``value`` as the type of ``variable``: numbers with unit, names of states, true and false.

    Raises ``BadInput`` with what would be right if it has no meaning or is out of range.
    """
    key = variable.name
    if variable.kind is bool:
        result: float | int | bool = _boolean(value, file, key)
    elif variable.kind is int:
        result = _integer(value, variable, file)
    else:
        result = number(value, variable.signal.unit, file=file, key=key)
    low, high = variable.signal.low, variable.signal.high
    if not low <= result <= high:
        unit = f" {variable.signal.unit}".removesuffix(" 1")
        text = f"{format_value(value)} is out of range, expected {low:g} to {high:g}{unit}"
        raise BadInput(text, file=file, key=key)
    return result


def _seconds(value: object) -> float | None:
    seconds = None if value is None else number(value, "s")
    if seconds is not None and not 0.0 <= seconds <= MAX_TIME:
        raise BadInput(f"{format_value(value)} is not a time from 0 to {MAX_TIME:g} s")
    return seconds


def _until(value: object) -> float | None:
    """Return a time [s]; one that never comes is ``inf``."""
    never = isinstance(value, int | float | str) and not isinstance(value, bool)
    return math.inf if never and number(value, "s", any_value=True) > MAX_TIME else _seconds(value)


def _within(most: float, unit: str) -> BeforeValidator:
    """Return what reads a quantity whose size is at most ``most``."""

    def read(value: object) -> float:
        found = number(value, unit)
        if abs(found) > most:
            raise BadInput(f"{format_value(value)} is out of range, expected {-most:g} to {most:g} {unit}")
        return found

    return BeforeValidator(read)


MAX_TIME = 1e9
"""The latest time [s]."""
Seconds = Annotated[float, BeforeValidator(_seconds)]
"""A time or duration [s] in a pydantic model; ``200 ms`` will do."""
Until = Annotated[float, BeforeValidator(_until)]
"""A time [s], or never."""
Metres = Annotated[float, _within(1e6, "m")]
Radians = Annotated[float, _within(1e3, "rad")]


def _boolean(value: object, file: object, key: str) -> bool:
    words = {"true": True, "yes": True, "on": True, "1": True, "false": False, "no": False, "off": False, "0": False}
    text = str(value).strip().lower()
    if text not in words:
        raise BadInput(f"{format_value(value)} is neither true nor false", file=file, key=key)
    return words[text]


def _integer(value: object, variable: Variable, file: object) -> int:
    states = variable.signal.states
    if isinstance(value, str) and states is not None and not value.strip().lstrip("+-").isdigit():
        names = {name.lower(): int(member) for name, member in states.__members__.items()}
        word = value.strip().lower().replace("-", "_").replace(" ", "_")
        if word not in names:
            close = suggestion(word, names)
            raise BadInput(f"{format_value(value)} is none of {', '.join(names)}{close}", file=file, key=variable.name)
        return names[word]
    exact = math.nan
    with suppress(BadInput):
        exact = number(value, variable.signal.unit)
    if not exact.is_integer():
        raise BadInput(f"{format_value(value)} is not a whole number", file=file, key=variable.name)
    if states is not None and int(exact) not in {int(member) for member in states}:
        known = ", ".join(f"{int(member)} {member.name.lower()}" for member in states)
        raise BadInput(f"{format_value(value)} is none of {known}", file=file, key=variable.name)
    return int(exact)


def _example(unit: str) -> str:
    others = [name for name, (target, _) in FACTORS.items() if target == unit]
    example = f" or text such as '5 {others[0]}'" if others else ""
    return ("a number" if unit == "1" else f"a number in {unit}") + example
