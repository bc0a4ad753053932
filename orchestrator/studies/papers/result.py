"""What a reproduction says: rows of printed and measured numbers, and plain notes."""

from collections import Counter
from collections.abc import Callable
from typing import Any, NamedTuple

from orchestrator.evaluation.verdict.summary import Summary, summarize
from orchestrator.inputs.scenario.scenario import Outcome, Scenario
from orchestrator.simulation.cosim.recording import Recording


class Driven(NamedTuple):
    """One scenario that has been run."""

    scenario: Scenario
    recording: Recording
    summary: Summary

    def in_line(self) -> Outcome:
        """Return the outcome wherever along the slot the car stands: what the papers call parked."""
        return summarize(self.recording, in_line(self.scenario), 0.0).outcome


def in_line(scenario: Scenario) -> Scenario:
    """Return a scenario without our limit along the slot, of which the papers say nothing."""
    limits = [item for item in scenario.requirements if item.signal != "final.longitudinal_error"]
    return scenario.with_requirements(limits)


PRINTED = "printed number"
CONCLUSION = "conclusion of the paper"
OWN = "own regression"
"""What a check is about."""


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
    """Largest difference allowed, largest size where the paper prints nothing; None: reported only."""
    note: str = ""
    basis: str = ""
    """``PRINTED``, ``CONCLUSION`` or ``OWN``."""
    differs: str = ""
    """Why it is known to be beyond the limit."""
    untestable: str = ""
    """Why there is no limit to what the paper says."""

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
        if self.paper is None and isinstance(self.ours, float):
            return abs(self.ours) <= self.limit
        if self.difference is None:
            return self.paper == self.ours
        return abs(self.difference) <= self.limit

    @property
    def as_expected(self) -> bool | None:
        """Whether it is within its limit, or beyond it and known to be; None where nothing is asked."""
        return None if self.passed is None else self.passed == (self.differs == "")

    def as_json(self) -> dict[str, Any]:
        """Return the row as plain data."""
        verdict = {"difference": self.difference, "passed": self.passed, "as_expected": self.as_expected}
        return {**self._asdict(), **verdict}


def bound_row(run: str, item: str, unit: str, bound: float, ours: float, differs: str = "") -> Row:
    """Return the check of a number that the paper prints as a bound on its size."""
    printed = f"at most {bound:g} {unit}"
    here = printed if abs(ours) <= bound else f"{ours:.3g} {unit}"
    return Row(run, item, "", printed, here, 0.0, f"{ours:.3g} {unit}", PRINTED, differs)


def not_tested(item: str, why: str, printed: str = "") -> Row:
    """Return what the paper has and no check here is about, with the reason."""
    return Row("", item, "", printed, "-", untestable=why)


def yes_row(run: str, item: str, holds: bool, basis: str, differs: str = "") -> Row:
    """Return the check of a statement."""
    return Row(run, item, "", "yes", "yes" if holds else "no", 0.0, basis=basis, differs=differs)


class Tally(NamedTuple):
    """How many rows of a reproduction are what."""

    agrees: int
    differs: int
    untestable: int
    own: int
    own_held: int


class Reproduction(NamedTuple):
    """All of one paper."""

    paper: str
    title: str
    rows: list[Row]
    notes: list[str]

    @property
    def passed(self) -> bool:
        """Whether every row that asks something got it, and what is known to differ still does."""
        return all(row.as_expected is not False for row in self.rows)

    @property
    def tally(self) -> Tally:
        """How many rows agree with the paper, differ from it, cannot be tested; own checks apart."""
        papers = Counter(row.passed for row in self.rows if row.basis in (PRINTED, CONCLUSION))
        own = [row.passed for row in self.rows if row.basis == OWN and row.limit is not None]
        untestable = sum(row.untestable != "" for row in self.rows)
        return Tally(papers[True], papers[False], untestable, len(own), sum(held is True for held in own))

    def as_json(self) -> dict[str, Any]:
        """Return the reproduction as plain data."""
        return {
            "paper": self.paper,
            "title": self.title,
            "passed": self.passed,
            "tally": self.tally._asdict(),
            "rows": [row.as_json() for row in self.rows],
            "notes": self.notes,
        }


Reproduce = Callable[[Drive], Reproduction]
