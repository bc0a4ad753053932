"""From runs to verdicts: which entries of the catalogue are met, missed, or not tested, and why."""

from collections.abc import Iterable, Sequence
from typing import Any, Literal, NamedTuple

from orchestrator.evaluation.verdict.judge import Check, judge
from orchestrator.evaluation.verdict.limit_text import sentence
from orchestrator.evaluation.verdict.numbers import facts_of
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BAD_INPUT, BadInput
from orchestrator.simulation.cosim.recording import Recording
from orchestrator.testing.catalogue.entries import Clause, Standard
from orchestrator.testing.suite.junit import Case, Suite
from orchestrator.testing.suite.suite import SuiteResult

Word = Literal["met", "missed", "not tested"]
MET: Word = "met"
MISSED: Word = "missed"
NOT_TESTED: Word = "not tested"
WORDS: tuple[Word, ...] = (MET, MISSED, NOT_TESTED)


class ClauseRun(NamedTuple):
    """What one run says of one entry."""

    name: str
    """Of the scenario, or of the step test."""
    outcome: str
    """How the run came out; empty for a step test."""
    missed: list[str]
    """What was asked and not met, a sentence each."""
    unmeasured: list[str]
    """What could not be judged, as an FMU does not put it out."""
    checks: Sequence[Check] = ()
    error: str = ""
    """Why there was no run."""


class ClauseVerdict(NamedTuple):
    """What became of one entry."""

    standard: Standard
    entry: Clause
    tried: list[ClauseRun]

    @property
    def word(self) -> Word:
        """Return met, missed or not tested."""
        if any(item.missed or item.error for item in self.tried):
            return MISSED
        complete = {item.name for item in self.tried} == {*self.entry.scenarios, *self.entry.step_tests}
        measured = not any(item.unmeasured for item in self.tried)
        return MET if self.tried and complete and measured else NOT_TESTED

    @property
    def why(self) -> str:
        """Return what was missed, or why nothing was tested; what was run, if all is met."""
        if self.entry.not_tested:
            return self.entry.not_tested
        found = [f"{item.name}: {text}" for item in self.tried for text in (item.error, *item.missed) if text]
        if not found:
            found = [f"{item.name}: not measured: {name}" for item in self.tried for name in item.unmeasured]
        if not found and self.word == NOT_TESTED:
            found = ["not run"]
        return "; ".join(found) or ", ".join(item.name for item in self.tried)

    def plain(self) -> dict[str, Any]:
        """Return the verdict as plain data."""
        runs = [
            {**item._asdict(), "checks": [f"{check.id}: {sentence(check)}" for check in item.checks]}
            for item in self.tried
        ]
        entry = self.entry.model_dump(include={"id", "clause", "text", "sure"})
        return {"standard": self.standard.standard, **entry, "verdict": self.word, "why": self.why, "runs": runs}


def verdicts_of(standards: Iterable[Standard]) -> list[ClauseVerdict]:
    """Return the verdicts before any run."""
    return [ClauseVerdict(standard, entry, []) for standard in standards for entry in standard.entries]


def runs_of(verdicts: list[ClauseVerdict]) -> tuple[list[str], list[str]]:
    """Return the scenarios and the step tests that have to be run, each once."""
    scenarios = [name for item in verdicts for name in item.entry.scenarios]
    tests = [name for item in verdicts for name in item.entry.step_tests]
    return list(dict.fromkeys(scenarios)), list(dict.fromkeys(tests))


def note(verdicts: list[ClauseVerdict], tested: SuiteResult) -> None:
    """Add what a run says of each entry that it is named by."""
    name, recording = tested.scenario.name, tested.recording
    for item in verdicts:
        if name in item.entry.step_tests and not tested.could_not_run:
            item.tried.append(_run_of_step_test(name, tested))
        elif name in item.entry.scenarios:
            if tested.could_not_run:
                continue
            if recording is None or tested.summary is None or tested.error:
                item.tried.append(ClauseRun(name, "", [], [], error=tested.error or "was not run"))
            else:
                outcome = (tested.summary.outcome, tested.summary.reason)
                item.tried.append(_run_of_scenario(item.entry, tested.scenario, recording, *outcome))


def _run_of_step_test(name: str, tested: SuiteResult) -> ClauseRun:
    """Return what a step test says; one that an FMU does not have the variables for cannot be judged."""
    if tested.code == BAD_INPUT:
        return ClauseRun(name, "", [], [tested.error])
    missed = [f"{case.name}: {case.text}" for case in tested.cases if not case.passed]
    return ClauseRun(name, "", missed, [], error=tested.error)


def _run_of_scenario(entry: Clause, scenario: Scenario, recording: Recording, outcome: str, reason: str) -> ClauseRun:
    facts, checks, unmeasured = facts_of(recording, scenario), list[Check](), list[str]()
    for limit in [*entry.limits_to_keep(), scenario.contact_rule]:
        try:
            checks += judge([limit], recording, facts, scenario.file)
        except BadInput as error:  # of an FMU whose mode has other states, or a signal another unit
            unmeasured.append(str(error))
    unmeasured += [check.id for check in checks if not check.evaluated]
    missed = [f"{check.id}: {sentence(check)}" for check in checks if check.evaluated and not check.passed]
    if entry.outcome and outcome not in entry.outcome:
        missed.insert(0, f"{outcome.replace('_', ' ')} ({reason}), required {' or '.join(entry.outcome)}")
    return ClauseRun(scenario.name, outcome, missed, unmeasured, checks)


def counts(verdicts: list[ClauseVerdict]) -> dict[Word, int]:
    """Return how many entries are met, missed, not tested."""
    return {word: sum(item.word == word for item in verdicts) for word in WORDS}


def suites(verdicts: list[ClauseVerdict], error: str = "") -> list[Suite]:
    """Return a suite for each standard, for JUnit; ``error``: why it could not be judged."""
    found: dict[str, list[Case]] = {}
    for item in verdicts:
        name = f"{item.entry.clause}: {item.entry.id}" if item.entry.clause else item.entry.id
        case = Case(name, item.word == MET, f"{item.entry.text} {item.word}: {item.why}", item.word == NOT_TESTED)
        found.setdefault(item.standard.standard, []).append(case)
    return [Suite(name, [] if error else cases, 0.0, error) for name, cases in found.items()]
