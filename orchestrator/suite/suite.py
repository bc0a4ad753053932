"""Many scenarios, each run, judged and kept: what ``apa test`` does."""

from collections.abc import Mapping
from fnmatch import fnmatchcase
from pathlib import Path
from typing import NamedTuple

from fmpy.model_description import read_model_description

from orchestrator.cosim.master import Interrupt
from orchestrator.cosim.recording import Recording
from orchestrator.report.results import LOG, write_pages, write_summary
from orchestrator.scenario.load_scenario import load_scenario, scenario_names
from orchestrator.scenario.requirements import Requirement
from orchestrator.scenario.scenario import Scenario
from orchestrator.session.session import run_scenario
from orchestrator.suite.junit import Case, Suite, cases_of
from orchestrator.text.errors import BadInput
from orchestrator.verdict.judge import Check, judge
from orchestrator.verdict.summary import Summary, numbers_of, summarize


class Tested(NamedTuple):
    """One scenario with its verdict."""

    scenario: Scenario
    summary: Summary | None
    """None if it could not be run."""
    recording: Recording | None
    cases: list[Case]
    ignored: list[str]
    """Parameters of the scenario that a foreign FMU does not have."""
    error: str = ""

    @property
    def passed(self) -> bool:
        """Whether every case passed."""
        return not self.error and all(case.passed or case.skipped for case in self.cases)

    def suite(self) -> Suite:
        """Return the verdict for JUnit."""
        time = self.summary.wall_time if self.summary else 0.0
        return Suite(self.scenario.name, self.cases, time, self.error)


class Bench(NamedTuple):
    """What all scenarios of a test are run with."""

    files: Mapping[str, Path] | None
    """Slave name -> FMU; None runs the models in process."""
    kind: str
    foreign: frozenset[str]
    """Slaves whose FMU is somebody else's: it need not have all parameters."""
    requirements: list[tuple[str, list[Requirement]]]
    """(file, its requirements), judged besides the scenario's own limits."""
    interrupt: Interrupt


def chosen(names: list[str]) -> list[str]:
    """Return the scenarios that ``names`` mean: names, files, and patterns such as ``guo2015-*`` over shipped ones."""
    found: list[str] = []
    for name in names:
        matching = [item for item in scenario_names() if fnmatchcase(item, name)]
        if not matching and any(sign in name for sign in "*?["):
            raise BadInput("no shipped scenario fits", key=name)
        found += [item for item in (matching or [name]) if item not in found]
    return found


def run_test(name: str, sets: list[str], bench: Bench, out: Path) -> Tested:
    """Run one scenario, judge it, and keep log, summary and replay page in ``out``/its name."""
    scenario = load_scenario(name, sets)
    scenario, ignored = _fitting(scenario, bench)
    folder = out / scenario.name
    folder.mkdir(parents=True, exist_ok=True)
    try:
        ran = run_scenario(scenario, bench.files, kind=bench.kind, log=folder / LOG, interrupt=bench.interrupt)
        summary = summarize(ran.recording, scenario, ran.wall_time)
        checks = _extra_checks(bench, ran.recording)
    except BadInput as error:
        return Tested(scenario, None, None, [], ignored, str(error))
    write_summary(folder, summary)
    write_pages(folder, ran.recording, summary.model_copy(update={"checks": [*summary.checks, *checks]}))
    broken = ran.end.reason if ran.end.reason.startswith("error") and scenario.expect != "aborted" else ""
    return Tested(scenario, summary, ran.recording, _cases(scenario, summary, checks), ignored, broken)


def _extra_checks(bench: Bench, recording: Recording) -> list[Check]:
    numbers = numbers_of(recording)
    return [check for file, items in bench.requirements for check in judge(items, recording, numbers, file)]


def _cases(scenario: Scenario, summary: Summary, extra: list[Check]) -> list[Case]:
    """Return the outcome, the limits (where a parked car is expected), and all further requirements as cases."""
    reached = f"{summary.outcome}: {summary.reason}; expected {scenario.expect}"
    outcome = Case("outcome", summary.outcome == scenario.expect, reached)
    own = cases_of(summary.checks) if scenario.expect == "parked" else []
    return [outcome, *own, *cases_of(extra)]


def _fitting(scenario: Scenario, bench: Bench) -> tuple[Scenario, list[str]]:
    """Return the scenario without the parameters that a foreign FMU does not have, and their names."""
    ignored: list[str] = []
    update: dict[str, object] = {}
    for slave in sorted(bench.foreign):
        assert bench.files is not None
        known = {item.name for item in read_model_description(str(bench.files[slave])).modelVariables}
        given: dict[str, float | int | bool] = getattr(scenario, slave)
        update[slave] = {name: value for name, value in given.items() if name in known}
        ignored += [f"{slave}.{name}" for name in given if name not in known]
    return scenario.model_copy(update=update), ignored
