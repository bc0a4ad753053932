"""Numbers as people read them."""

import math

from orchestrator.text.quantities import DEGREE


def readable(value: float, unit: str) -> str:
    """Return a number for people: angles in degrees, the rest in SI."""
    if not math.isfinite(value):
        return str(value)
    if unit.startswith("rad"):
        return f"{value / DEGREE:.2f} {unit.replace('rad', 'deg')}"
    return f"{value:.3f} {unit}" if unit != "1" else f"{value:g}"


def precise(value: float, unit: str) -> str:
    """Return a number that may be tiny, in SI."""
    return f"{value:.3g} {unit}" if unit != "1" else f"{value:.3g}"


def shifts_text(shifts: int | None) -> str:
    """Return a number of manoeuvres in words."""
    return "shifts not counted" if shifts is None else f"{shifts} shifts"
