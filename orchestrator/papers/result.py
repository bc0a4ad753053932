"""What a reproduction says: rows of printed and measured numbers, pictures, and plain notes."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from orchestrator.cosim.recording import Recording
from orchestrator.scenario.scenario import Scenario
from orchestrator.verdict.summary import Summary


class Driven(NamedTuple):
    """One scenario that has been run."""

    scenario: Scenario
    recording: Recording
    summary: Summary


Drive = Callable[[str], Driven]
"""Runs the scenario of that name."""


class Row(NamedTuple):
    """One number or word of the paper and what it is here."""

    run: str
    """Scenario it was measured in; empty for what no run is needed for."""
    item: str
    unit: str
    paper: float | str | None
    """As printed; None where the paper prints nothing."""
    ours: float | str
    limit: float | None = None
    """Largest difference allowed; None: reported only."""
    note: str = ""

    @property
    def difference(self) -> float | None:
        """Ours minus the paper's, where both are numbers."""
        if isinstance(self.paper, float) and isinstance(self.ours, float):
            return self.ours - self.paper
        return None

    @property
    def passed(self) -> bool | None:
        """Whether the difference is within the limit; equal words pass; None where nothing is asked."""
        if self.limit is None:
            return None
        if self.difference is None:
            return self.paper == self.ours
        return abs(self.difference) <= self.limit

    def as_json(self) -> dict[str, Any]:
        """Return the row as plain data."""
        return {**self._asdict(), "difference": self.difference, "passed": self.passed}


class Reproduction(NamedTuple):
    """All of one paper."""

    paper: str
    title: str
    rows: list[Row]
    figures: list[Path]
    notes: list[str]

    @property
    def passed(self) -> bool:
        """Whether every row that asks something got it."""
        return all(row.passed is not False for row in self.rows)

    def as_json(self) -> dict[str, Any]:
        """Return the reproduction as plain data."""
        return {
            "paper": self.paper,
            "title": self.title,
            "passed": self.passed,
            "rows": [row.as_json() for row in self.rows],
            "figures": [str(figure) for figure in self.figures],
            "notes": self.notes,
        }


Reproduce = Callable[[Path, Drive], Reproduction]
"""Writes pictures to a folder and returns the result; drives scenarios through the second argument."""
