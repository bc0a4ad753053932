"""Many scenarios, each run, judged and kept: what ``apa test`` does."""

import re
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor, wait
from contextvars import copy_context
from datetime import datetime
from fnmatch import fnmatchcase
from pathlib import Path
from threading import Lock
from types import MappingProxyType
from typing import Any, NamedTuple

from orchestrator.evaluation.verdict.judge import Check, judge
from orchestrator.evaluation.verdict.numbers import facts_of
from orchestrator.evaluation.verdict.summary import Summary, summarize
from orchestrator.inputs.scenario.load_scenario import scenario_names
from orchestrator.inputs.scenario.requirements import Requirement
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.console import progress_text
from orchestrator.inputs.text.errors import PARKED, RESOURCES, BadInput, NotRunError
from orchestrator.inputs.text.failures import exit_code_and_message
from orchestrator.inputs.text.locked_folder import lock_folder
from orchestrator.inputs.text.readable import changes_text
from orchestrator.presentation.report.results import LOG, PAGE, is_shown, write_page, write_summary
from orchestrator.session.foreign import Files, ImportedFmus, load_bound_scenario
from orchestrator.session.provenance import versions
from orchestrator.session.run_clock import RunClock
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.algorithm import Interrupt
from orchestrator.simulation.cosim.recording import Recording
from orchestrator.testing.steptest.curves import write_curves
from orchestrator.testing.steptest.run import run_step_test
from orchestrator.testing.steptest.step_test import StepTest, is_step_test, load_step_test
from orchestrator.testing.suite.junit import Case, Suite, cases_of, number_duplicates

CLAIMING = Lock()
POLL_INTERVAL = 0.2
"""Between two looks for Ctrl-C [s]."""
MOST_LETTERS = 100
UNNAMEABLE = re.compile(r"[^A-Za-z0-9._-]+")


class SuiteResult(NamedTuple):
    """One scenario with its verdict."""

    scenario: Scenario
    summary: Summary | None
    """None if it could not be run."""
    recording: Recording | None
    cases: list[Case]
    ignored: list[str]
    """Parameters of the scenario that a foreign FMU does not have."""
    error: str = ""
    """Why it could not be run or judged."""
    remarks: tuple[str, ...] = ()
    """What was said of the system before it ran."""
    code: int = PARKED
    """The exit code of an error that is not one of the run: bad input, or a mistake of ours."""
    could_not_run: bool = False
    """It could not take place: no memory, no file, no process, or an FMU that cannot be loaded."""

    @property
    def passed(self) -> bool:
        """Whether every case passed."""
        return not self.error and all(case.passed or case.skipped for case in self.cases)

    def suite(self) -> Suite:
        """Return the verdict for JUnit."""
        time = self.summary.wall_time if self.summary else 0.0
        notes = {
            "overrides": changes_text(self.scenario.overrides),
            "left out": ", ".join(self.ignored),
            "warning": "; ".join(self.remarks),
            **fmus_of(self),
        }
        return Suite(
            self.scenario.name, self.cases, time, self.error, {key: text for key, text in notes.items() if text}
        )


class SuiteConfig(NamedTuple):
    """What all scenarios of a test are run with."""

    files: Files
    """FmuInstance name -> FMU of ours; those that lack run in process."""
    kind: str
    foreign: ImportedFmus
    """Third-party FMUs in their place: they need not have all parameters."""
    requirements: list[tuple[str, list[Requirement]]]
    """(file, its requirements), judged besides the scenario's own limits."""
    interrupt: Interrupt
    warn: Callable[[str], None] = lambda text: None
    look: Callable[[Scenario, Files, Recording], None] = lambda scenario, files, recording: None
    """Receives each run with third-party FMUs in it."""
    started: Mapping[str, Any] = MappingProxyType({})
    """When and by which command the test was started, for the logs."""
    progress: Callable[[str], None] = lambda text: None
    """Receives how far the scenario in hand is, a few times a second."""

    def clock(self, name: str, stop_time: float) -> RunClock:
        """Return the observer that reports the progress of a scenario."""
        return RunClock(lambda t: self.progress(f"{name} at {progress_text(t, stop_time, 's')}"))


def select_scenarios(names: list[str]) -> list[str]:
    """Return the scenarios that ``names`` mean: names, files, and patterns such as ``guo2015-*`` over shipped ones."""
    found: list[str] = []
    for name in names:
        matching = [item for item in scenario_names() if fnmatchcase(item, name)]
        if not matching and any(sign in name for sign in "*?["):
            raise BadInput("no shipped scenario fits", key=name)
        found += [item for item in (matching or [name]) if item not in found]
    return found


def run_tests(names: list[str], sets: list[str], bench: SuiteConfig, out: Path, jobs: int = 1) -> Iterator[SuiteResult]:
    """Yield the verdicts of scenarios in their order, ``jobs`` of them at a time; none begins after an interrupt."""
    taken: set[str] = set()
    if jobs == 1:
        for name in names:
            if not bench.interrupt.requested:
                yield run_test(name, sets, bench, out, taken)
        return
    with ThreadPoolExecutor(jobs) as pool:
        running = [pool.submit(copy_context().run, run_test, name, sets, bench, out, taken) for name in names]
        for future in running:
            while not future.done() and not bench.interrupt.requested:
                wait([future], POLL_INTERVAL)
            if bench.interrupt.requested:
                pool.shutdown(wait=True, cancel_futures=True)
            if not future.cancelled():
                yield future.result()


def _claim(name: str, taken: set[str], what: str, file: object) -> None:
    """Note that a test is called ``name``. Raises ``BadInput`` if another one is."""
    with CLAIMING:
        if name in taken:
            raise BadInput(f"another {what} is called {name}", file=file, key="name")
        taken.add(name)


def run_test(name: str, sets: list[str], bench: SuiteConfig, out: Path, taken: set[str] | None = None) -> SuiteResult:
    """Run one scenario, judge it, and keep log, summary and replay page in ``out``/its name.

    Whatever is wrong with it or with an FMU is an error of this scenario alone; so is a name already ``taken``.
    """
    taken = set() if taken is None else taken
    scenario = Scenario(name=_nameable(Path(name).stem))
    ignored: list[str] = []
    try:
        if is_step_test(name):
            return _step_tested(load_step_test(Path(name)), sets, bench, out, taken)
        scenario, ignored, foreign = load_bound_scenario(name, sets, bench.foreign)
        bench = bench._replace(foreign=foreign)
        _claim(scenario.name, taken, "scenario of this test", name)
        return _evaluate(scenario, ignored, bench, out / scenario.name)
    except Exception as error:
        code, line = exit_code_and_message(error, ["test", name])
        could_not_run = isinstance(error, (NotRunError, *RESOURCES))
        return SuiteResult(scenario, None, None, [], ignored, line, code=code, could_not_run=could_not_run)


def _nameable(text: str) -> str:
    """Return the name of a scenario, and of its folder, that is nearest to a text."""
    return UNNAMEABLE.sub("-", text).lstrip(".-")[:MOST_LETTERS] or "unnamed"


def _evaluate(scenario: Scenario, ignored: list[str], bench: SuiteConfig, folder: Path) -> SuiteResult:
    with lock_folder(folder):
        ran = run_scenario(
            scenario,
            bench.files,
            kind=bench.kind,
            log=folder / LOG,
            observers=(bench.clock(scenario.name, scenario.longest),),
            interrupt=bench.interrupt,
            warn=bench.warn,
            foreign=bench.foreign,
            started=bench.started,
        )
        bench.look(scenario, bench.foreign.files, ran.recording)
        summary = summarize(ran.recording, scenario, ran.wall_time)
        checks = _extra_checks(bench, ran.recording, scenario)
        write_summary(folder, summary)
        if is_shown(ran.recording):
            judged = summary.model_copy(update={"checks": [*summary.checks, *checks]})
            write_page(folder, ran.recording, judged, ran.lines)
    broken = ran.end.reason if ran.end.reason.startswith("error") and scenario.expected_outcome != "aborted" else ""
    cases = [] if broken else _cases(scenario, summary, checks)
    return SuiteResult(scenario, summary, ran.recording, cases, ignored, broken, tuple(ran.remarks))


def _step_tested(test: StepTest, sets: list[str], bench: SuiteConfig, out: Path, taken: set[str]) -> SuiteResult:
    """Run the test of one model alone, and keep its curves and checks in ``out``/its name."""
    if sets or bench.requirements:
        raise BadInput(
            "open-loop tests do not support --set and --requirements: write both in the file",
            file=test.file,
        )
    scenario = Scenario(name=_nameable(test.name), title=test.title or f"step test of {test.model}")
    _claim(scenario.name, taken, "test", test.file)
    recording, checks = run_step_test(
        test, bench.kind, bench.foreign, (bench.clock(scenario.name, test.stop_time),), bench.interrupt
    )
    bench.look(scenario, bench.foreign.files, recording)
    folder = out / scenario.name
    with lock_folder(folder):
        write_curves(folder / PAGE, test, recording, checks)
    end = str(recording.info["end"]["reason"])
    broken = end if end.startswith("error") else ""
    return SuiteResult(scenario, None, None, [] if broken else number_duplicates(cases_of(checks)), [], broken)


def provenance_of(tested: list[SuiteResult], command: str) -> dict[str, str]:
    """Return what was tested, when and how: for the page and JUnit."""
    used = [fmus_of(item) for item in tested if item.summary is not None]
    fmus = {
        name: text for name, text in (used[0] if used else {}).items() if all(one.get(name) == text for one in used)
    }
    when = datetime.now().astimezone().isoformat(timespec="seconds")
    about = {**fmus, "command": command, "when": when, "apa-cosim": versions()["apa-cosim"]}
    remarks = dict.fromkeys(text for item in tested for text in item.remarks)
    return {**about, "warning": "; ".join(remarks)} if remarks else about


def fmus_of(tested: SuiteResult) -> dict[str, str]:
    """Return FMU instance -> its file (or the folder of its sources) and hash."""
    used = tested.summary.fmus if tested.summary is not None else []
    return {item.name: f"{item.path}, SHA-256 {item.sha256}" for item in used}


def _extra_checks(bench: SuiteConfig, recording: Recording, scenario: Scenario) -> list[Check]:
    facts = facts_of(recording, scenario)
    return [check for file, items in bench.requirements for check in judge(items, recording, facts, file)]


def _cases(scenario: Scenario, summary: Summary, extra: list[Check]) -> list[Case]:
    """Return the outcome, the limits (where the task shall be done), contact, and all further requirements as cases."""
    reached = f"{summary.outcome}: {summary.headline}; expected {scenario.expected_outcome}"
    outcome = Case("outcome", summary.outcome == scenario.expected_outcome, reached)
    contact = [check for check in summary.checks if check.id == scenario.contact_rule.id]
    own = cases_of(summary.checks if scenario.expected_outcome == scenario.success else contact)
    return number_duplicates([outcome, *own, *cases_of(extra)])
