"""The catalogue run: every scenario and step test that its entries name, once, and what they say of each entry."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

from orchestrator.inputs.text.console import console
from orchestrator.inputs.text.errors import NOT_PARKED, PARKED
from orchestrator.testing.catalogue.entries import STEP_TESTS, select_standards
from orchestrator.testing.catalogue.show import count_text, verdict_tables, write_catalogue
from orchestrator.testing.catalogue.verdicts import MISSED, ClauseVerdict, counts, note, runs_of, suites, verdicts_of
from orchestrator.testing.suite.junit import write_junit
from orchestrator.testing.suite.suite import SuiteConfig, SuiteResult, provenance_of, run_tests

NOT_RUN = "the test ended before this standard was judged"
NOTHING: Mapping[str, str] = MappingProxyType({})


class Catalogue:
    """Chosen standards, and the verdicts on them as they come."""

    def __init__(self, words: list[str]) -> None:
        self.verdicts = verdicts_of(select_standards(words))
        scenarios, tests = runs_of(self.verdicts)
        self._scenarios = scenarios
        self._tests = [str(STEP_TESTS / f"{name}.yaml") for name in tests]
        self._kept: list[SuiteResult] = []

    @property
    def count(self) -> int:
        """Return how many runs there are."""
        return len(self._scenarios) + len(self._tests)

    def run(self, sets: list[str], bench: SuiteConfig, out: Path, jobs: int, on_run: Callable[[int], None]) -> None:
        """Run all; what a run recorded is let go once it is judged. ``on_run`` receives how many are done."""
        steps = bench._replace(requirements=[])
        for tests in (run_tests(self._scenarios, sets, bench, out, jobs), run_tests(self._tests, [], steps, out)):
            for tested in tests:
                note(self.verdicts, tested)
                self._kept.append(tested._replace(recording=None))
                on_run(len(self._kept))

    def about(self, command: str) -> dict[str, str]:
        """Return what was tested, when and how."""
        return provenance_of(self._kept, command)

    def write(self, junit: Path, page: Path, about: Mapping[str, str] = NOTHING) -> None:
        """Write JUnit and the page; before the runs are done, JUnit with an error for each standard."""
        write_junit(junit, suites(self.verdicts, "" if about else NOT_RUN), about)
        if about:
            write_catalogue(page, self.verdicts, about)
        else:
            page.unlink(missing_ok=True)

    def show(self, about: Mapping[str, str], out: Path, as_json: bool) -> None:
        """Print the verdicts."""
        if as_json:
            rows = [item.plain() for item in self.verdicts]
            print(json.dumps({"counts": counts(self.verdicts), "about": dict(about), "entries": rows}, indent=2))
            return
        for table in verdict_tables(self.verdicts):
            console().print(table)
            console().print()
        lost = [item for item in self._kept if item.could_not_run]
        why = f"; {len(lost)} runs could not take place: {lost[0].error}" if lost else ""
        console().print(f"{count_text(self.verdicts)}{why}; results in {out}", markup=False, soft_wrap=True)

    def code(self) -> int:
        """Return the exit code: 2 or 3 for a scenario that could not be run, 1 if an entry is missed, else 0."""
        counted = [item for item in self._kept if item.scenario.name in self._scenarios or item.could_not_run]
        worst = max((item.code for item in counted), default=PARKED)
        return worst or (NOT_PARKED if counts(self.verdicts)[MISSED] else PARKED)


def judge_standards(words: list[str], bench: SuiteConfig, out: Path) -> list[ClauseVerdict]:
    """Return the verdicts on the standards that ``words`` mean, with their runs in ``out``."""
    catalogue = Catalogue(words)
    catalogue.run([], bench, out, 1, lambda done: None)
    return catalogue.verdicts
