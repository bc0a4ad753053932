"""Numbers as people read them."""

import math
from collections.abc import Iterable, Mapping

from orchestrator.inputs.text.quantities import RAD_PER_DEGREE

MAX_LISTED_NAMES = 3
"""Names of one group that are listed one by one."""
WORDS = ("name", "title", "description", "source")
"""Keys of a scenario that change nothing in a run."""


def readable(value: float, unit: str) -> str:
    """Return a number for people: angles in degrees, the rest in SI."""
    if not math.isfinite(value):
        return str(value)
    if unit.startswith("rad"):
        return f"{value / RAD_PER_DEGREE:.2f} {unit.replace('rad', 'deg')}"
    return f"{value:.3f} {unit}" if unit != "1" else f"{value:g}"


def shortly(names: Iterable[str]) -> str:
    """Return names in words; more than a few of one group are given as the group and their number."""
    groups: dict[str, list[str]] = {}
    for name in names:
        groups.setdefault(".".join(name.split(".")[:2]), []).append(name)
    parts = [
        f"{len(found)} of {group}" if len(found) > MAX_LISTED_NAMES else ", ".join(found)
        for group, found in groups.items()
    ]
    return ", ".join(parts)


def precise(value: float, unit: str) -> str:
    """Return a number that may be tiny, in SI."""
    return f"{value:.3g} {unit}" if unit != "1" else f"{value:.3g}"


def manoeuvres_text(manoeuvres: int | None) -> str:
    """Return a number of manoeuvres in words."""
    return "manoeuvres not counted" if manoeuvres is None else f"{manoeuvres} manoeuvre{'' if manoeuvres == 1 else 's'}"


def changes_text(changed: Mapping[str, str]) -> str:
    """Return what was changed of a scenario in words; its own words are no change."""
    return ", ".join(f"{key} = {value}" for key, value in changed.items() if key not in WORDS)
