"""How far a signal may be from its reference, in value and in time."""

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from orchestrator.inputs.text.errors import BadInput, format_value, suggestion_or_choices
from orchestrator.inputs.text.patterns import fits
from orchestrator.inputs.text.quantities import number
from orchestrator.inputs.text.yaml_file import read_mapping


class Tolerance(NamedTuple):
    """A value may differ by max(``absolute``, ``relative`` * \\|reference\\|) from any value within ``time``."""

    absolute: float = 1e-9
    """[SI unit of the signal]"""
    relative: float = 1e-9
    time: float = 0.0
    """Half-width of the tube along time [s]."""


FIELDS = {"abs": "absolute", "rel": "relative", "time": "time"}
KEYS = tuple(FIELDS)
UNITS = {"rel": "1", "time": "s"}


class Tolerances:
    """A tolerance for every signal: a default, and rows of (pattern, changes); the last match wins."""

    def __init__(self, default: Tolerance, rows: list[tuple[str, dict[str, object], str]] | None = None) -> None:
        self._default = default
        self._rows = rows or []

    def of(self, signal: str, unit: str) -> Tolerance:
        """Return the tolerance of ``signal``, whose SI unit is ``unit``. Raises ``BadInput`` for a wrong unit."""
        last = {key: row for row in self._rows if fits(signal, row[0]) for key in row[1]}
        bounds = {}
        for key, (pattern, given, file) in last.items():
            bounds[FIELDS[key]] = _bound(given[key], UNITS.get(key, unit), file, f"{pattern}: {key}")
        return self._default._replace(**bounds)

    def patterns_without_match(self, signals: Iterable[str]) -> list[str]:
        """Return the patterns that fit none of ``signals``: a misspelt one would change nothing."""
        names = list(signals)
        return [pattern for pattern, _, _ in self._rows if not any(fits(name, pattern) for name in names)]


def read_tolerances(path: Path | None, default: Tolerance) -> Tolerances:
    """Return the tolerances in a YAML file: ``"vehicle.pose.*": {abs: 1 cm, rel: 0.01, time: 100 ms}``.

    Raises ``BadInput``.
    """
    rows = []
    for pattern, given in (read_mapping(path) if path else {}).items():
        if not isinstance(given, dict):
            raise BadInput(f"{format_value(given)}: expected a mapping with {', '.join(KEYS)}", file=path, key=pattern)
        for key in given:
            if key not in KEYS:
                hint = suggestion_or_choices(str(key), KEYS)
                raise BadInput(f"unknown{hint}", file=path, key=f"{pattern}: {key}")
        rows.append((pattern, given, str(path)))
    return Tolerances(default, rows)


def _bound(value: object, unit: str, file: str, key: str) -> float:
    bound = number(value, unit, file=file, key=key, any_value=True)
    if not bound >= 0.0:
        raise BadInput(f"{format_value(value)} is not 0 or more", file=file, key=key)
    return bound
