"""Units as FMI 2.0 writes them: SI base-unit exponents, and degrees for people where the unit has radians."""

import math
import re
from functools import cache
from typing import NamedTuple

BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
DEGREES_PER_RADIAN = 180.0 / math.pi

Exponents = dict[str, int]

SYMBOLS: dict[str, tuple[float, Exponents]] = {
    **{name: (1.0, {name: 1}) for name in BASE},
    "1": (1.0, {}),
    "%": (0.01, {}),
    "deg": (1.0 / DEGREES_PER_RADIAN, {"rad": 1}),
    "g": (0.001, {"kg": 1}),
    "mm": (0.001, {"m": 1}),
    "km": (1000.0, {"m": 1}),
    "ms": (0.001, {"s": 1}),
    "ns": (1e-9, {"s": 1}),
    "h": (3600.0, {"s": 1}),
    "Hz": (1.0, {"s": -1}),
    "N": (1.0, {"kg": 1, "m": 1, "s": -2}),
    "Pa": (1.0, {"kg": 1, "m": -1, "s": -2}),
    "J": (1.0, {"kg": 1, "m": 2, "s": -2}),
    "W": (1.0, {"kg": 1, "m": 2, "s": -3}),
    "V": (1.0, {"kg": 1, "m": 2, "s": -3, "A": -1}),
}
FACTOR = re.compile(r"(1|%|[A-Za-z]+)\^?(-?\d+)?")
PRODUCT = rf"{FACTOR.pattern}([.*]{FACTOR.pattern})*"
UNIT = re.compile(rf"{FACTOR.pattern}([./*]({FACTOR.pattern}|\({PRODUCT}\)))*")

NOMINAL = {"kg": 1e3, "kg.m2": 1e3, "N": 1e3, "N.m": 1e3, "N/rad": 1e4, "Pa": 1e5}
"""Typical magnitude of a car's quantity in this unit, where it is not one."""


class Unit(NamedTuple):
    """A unit: what it is in SI base units, and the unit to show it in."""

    name: str
    factor: float
    """One of this unit in SI base units."""
    exponents: Exponents
    display: str | None
    """Unit for people, or None: itself."""
    display_factor: float
    """Number in the display unit over number in this unit."""
    nominal: float


@cache
def unit(name: str) -> Unit:
    """Return the unit written as ``name``: ``m/s2``, ``1/m``, ``N.m/rad``, ``kg/(m.s)``; ``ValueError`` if not."""
    factor, exponents = 1.0, dict.fromkeys(BASE, 0)
    radians = 0
    for symbol, power in _factors(name):
        scale, parts = SYMBOLS[symbol]
        factor *= math.pow(scale, power)
        radians += power if symbol == "rad" else 0
        for base, exponent in parts.items():
            exponents[base] += exponent * power
    shown = re.sub(r"\brad(?=\d|\b)", "deg", name) if radians else None
    kept = {base: exponent for base, exponent in exponents.items() if exponent}
    return Unit(name, factor, kept, shown, math.pow(DEGREES_PER_RADIAN, radians), NOMINAL.get(name, 1.0))


def _factors(name: str) -> list[tuple[str, int]]:
    """Return (symbol, power) of each factor; a slash turns over the factor or bracket behind it."""
    if UNIT.fullmatch(name) is None:
        raise ValueError(f"unit {name!r}: expected the like of m, 1, m/s2, N.m/rad, kg/(m.s)")
    found, sign, depth_sign = [], 1, 1
    for token in re.findall(r"[./*()]|[^./*()]+", name):
        if token == "/":
            sign = -1
        elif token in ".*":
            sign = 1
        elif token == "(":
            depth_sign, sign = sign, 1
        elif token == ")":
            depth_sign, sign = 1, 1
        else:
            match = FACTOR.fullmatch(token)
            if match is None or match[1] not in SYMBOLS:
                raise ValueError(f"unit {name!r}: {token!r} is not one of {', '.join(SYMBOLS)}")
            found.append((match[1], sign * depth_sign * int(match[2] or 1)))
    return found
