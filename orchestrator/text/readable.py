"""Numbers as people read them."""

import math
from collections.abc import Mapping

from orchestrator.text.quantities import DEGREE

WORDS = ("name", "title", "description", "source")
"""Keys of a scenario that change nothing in a run."""


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
    return "shifts not counted" if shifts is None else f"{shifts} shift{'' if shifts == 1 else 's'}"


def changes_text(changed: Mapping[str, str]) -> str:
    """Return what was changed of a scenario in words; its own words are no change."""
    return ", ".join(f"{key} = {value}" for key, value in changed.items() if key not in WORDS)
