"""Choosing signals by patterns such as ``vehicle.pose.*``."""

from collections.abc import Iterable
from fnmatch import fnmatchcase

from orchestrator.inputs.text.errors import BadInput, suggestion

NAME = r"^[A-Za-z0-9_][A-Za-z0-9._-]*$"
"""What a name of a scenario, a study, a folder may be: no path, no ``..``, nothing hidden."""


def matching(names: Iterable[str], patterns: Iterable[str] | None) -> list[str]:
    """Return the names that fit one of ``patterns``, in their order; all if there are no patterns.

    Brackets are meant as they stand: ``ultrasonic[3]`` is a name. Raises ``BadInput`` for a pattern that fits nothing.
    """
    known = list(names)
    if patterns is None:
        return known
    chosen: set[str] = set()
    for pattern in patterns:
        fitting = [name for name in known if fits(name, pattern)]
        if not fitting:
            raise BadInput(f"no signal fits{suggestion(pattern, known)}", key=pattern)
        chosen.update(fitting)
    return [name for name in known if name in chosen]


def fits(name: str, pattern: str) -> bool:
    """Return whether ``name`` fits ``pattern``, in which only * and ? have a meaning."""
    return fnmatchcase(name, pattern.replace("[", "[[]"))
