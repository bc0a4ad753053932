"""``apa test``: run scenarios, judge each, write JUnit and one page: the test step of a controller in CI."""

import argparse
import json
import os
import shlex
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from types import MappingProxyType
from typing import Any

from orchestrator.inputs.scenario.files import find_file
from orchestrator.inputs.scenario.models import MODELS, apart_models
from orchestrator.inputs.scenario.requirements import read_requirements
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.console import Meter, Warnings, console, say
from orchestrator.inputs.text.errors import INTERRUPTED, BadInput
from orchestrator.inputs.text.locked_folder import lock_folder
from orchestrator.inputs.text.readable import shortly
from orchestrator.session.foreign import Files, foreign_of
from orchestrator.session.options import add_fmus_argument, add_foreign_arguments
from orchestrator.session.provenance import start_record
from orchestrator.simulation.cosim.algorithm import Interrupt
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.simulation.cosim.interrupts import on_interrupt
from orchestrator.simulation.cosim.recording import Recording
from orchestrator.testing.catalogue.entries import is_catalogue
from orchestrator.testing.suite.collection import write_collection
from orchestrator.testing.suite.junit import Suite, write_junit
from orchestrator.testing.suite.suite import SuiteConfig, SuiteResult, provenance_of, run_tests, select_scenarios

EXAMPLES = """examples:
  apa test "guo2015-*" --out results
  apa test guo2015-case4 my.yaml --controller their.fmu --junit results/junit.xml
  apa test "*" --requirements gbt41630 --set vehicle.body=double_track
  apa test catalogue --out results
  apa test "catalogue/gbt*" --controller their.fmu --junit results/junit.xml

A scenario passes if it has its expected outcome, meets its own required limits if it is to be parked or finished, and
meets those of --requirements in any case. A third-party FMU needs the variable names, types and units of the FMU that
it replaces, or a scenario whose key system connects it. A missing unit is assumed to be the SI unit of the variable.
Parameters of the scenario that the FMU lacks are omitted and listed; parameters of the FMU are set by --set
controller.THEIR_GAIN=3.

apa test catalogue tests clauses of parking standards; apa test catalogue/gbt41630 tests one standard.

writes DIR/index.html, DIR/junit.xml and for each scenario DIR/NAME/run.mcap, summary.json and report.html
exit codes: 0 all passed, 1 one failed, 2 a scenario, requirement or FMU that cannot be read, or a path that cannot be
written, 3 internal error in a scenario; junit.xml exists from the start, with an error for each scenario not yet run
"""
PASSED, FAILED = 0, 1
Look = Callable[[Scenario, Files, Recording], None]
MOST_JOBS = 64
NOT_RUN = "the test ended before this scenario was run"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("scenarios", nargs="+", metavar="SCENARIO", help="names, patterns of names, or YAML files")
    add_foreign_arguments(parser)
    add_fmus_argument(parser)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="as in apa run, for all")
    parser.add_argument(
        "--requirements", action="append", default=[], metavar="FILE", help="further requirements, or a shipped set"
    )
    parser.add_argument("--out", type=Path, metavar="DIR", default=Path("runs/test"), help="output folder (runs/test)")
    parser.add_argument("--junit", type=Path, metavar="FILE", help="where JUnit XML goes (default: DIR/junit.xml)")
    parser.add_argument(
        "-j", "--jobs", type=jobs, default=1, metavar="N", help="scenarios run in parallel (1; 0: all cores)"
    )
    parser.add_argument("--coverage", action="store_true", help="run in process and report coverage of charts and code")
    for what in ("transition", "branch"):
        parser.add_argument(
            f"--min-{what}-coverage", type=percentage, metavar="PERCENT", help="fail below this; means --coverage"
        )
    parser.add_argument("--json", action="store_true", help="print the verdicts as JSON")


def run(arguments: argparse.Namespace) -> int:
    """Run all, print a line for each. Returns 0 if all passed, 1 if not, 130 if interrupted."""
    out: Path = arguments.out
    if any(is_catalogue(word) for word in arguments.scenarios):
        with lock_folder(out):
            return _catalogue(arguments)
    names = select_scenarios(arguments.scenarios)
    with lock_folder(out):
        verdicts = Verdicts(arguments.junit or out / "junit.xml", out / "index.html", names)
        if arguments.coverage or (arguments.min_transition_coverage, arguments.min_branch_coverage) != (None, None):
            return _test_with_coverage(arguments, names, verdicts)
        return _run(arguments, names, verdicts)


def jobs(text: str) -> int:
    """Return how many scenarios run at a time; 0 means one for each processor."""
    if not text.isdecimal() or int(text) > MOST_JOBS:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 0 to {MOST_JOBS}")
    return int(text) or os.cpu_count() or 1


def percentage(text: str) -> float:
    """Return a number from 0 to 100."""
    with suppress(ValueError):
        if 0.0 <= float(text) <= 100.0:
            return float(text)
    raise argparse.ArgumentTypeError(f"{text!r} is not a number from 0 to 100")


def _test_with_coverage(arguments: argparse.Namespace, names: list[str], verdicts: "Verdicts") -> int:
    """Test with the models in process, and say what of their charts and code was covered."""
    from orchestrator.testing.coverage.coverage import looking_on
    from orchestrator.testing.coverage.modes import Modes
    from orchestrator.testing.coverage.show import coverage_tables, write_coverage

    arguments.fmus, arguments.jobs = "none", 1
    modes = Modes()
    with looking_on([*MODELS.values(), *apart_models().values()]) as so_far:
        code = _run(arguments, names, verdicts, modes.look)
        found = so_far().of_ours(
            {MODELS[name].package.__name__ for name in modes.ours & set(MODELS)}, modes.chart_coverages()
        )
    if arguments.min_transition_coverage is not None and not found.has_list:
        advice = "list the transitions of the mode in the scenario, under system: modes:"
        raise BadInput(f"nothing says which transitions there are; {advice}", key="--min-transition-coverage")
    page = write_coverage(arguments.out, found)
    parts = {"transitions": found.transitions_percent, "branches": found.branches_percent}
    if not arguments.json:
        for table in coverage_tables(found):
            console().print(table)
        text = ", ".join(f"{part:.0f} % of the {what}" for what, part in parts.items())
        console().print(f"{text}; {page}", markup=False, soft_wrap=True)
    asked = {"transitions": arguments.min_transition_coverage, "branches": arguments.min_branch_coverage}
    for what, least in asked.items():
        if code == PASSED and least is not None and parts[what] < least:
            say(f"apa: {parts[what]:.1f} % of the {what} are covered, required {least:g} %")
            code = FAILED
    return code


def _catalogue(arguments: argparse.Namespace) -> int:
    """Test the catalogue of standards. Returns 0 if no clause is missed."""
    from orchestrator.testing.catalogue.run import Catalogue

    other = [word for word in arguments.scenarios if not is_catalogue(word)]
    if other:
        raise BadInput("the catalogue is tested by itself, without other scenarios", key=other[0])
    if arguments.coverage or arguments.min_transition_coverage is not None:
        raise BadInput("the catalogue says nothing of charts; test its scenarios by name", key="--coverage")
    interrupt = Interrupt()
    bench, catalogue = _bench(arguments, interrupt), Catalogue(arguments.scenarios)
    files = (arguments.junit or arguments.out / "junit.xml", arguments.out / "index.html")
    catalogue.write(*files)
    with on_interrupt(interrupt), Meter("apa test", catalogue.count, "runs") as meter:
        catalogue.run(arguments.set, bench._replace(progress=meter.note), arguments.out, arguments.jobs, meter.at)
    about = catalogue.about(shlex.join(["apa", *arguments.words]))
    catalogue.write(*files, about)
    catalogue.show(about, arguments.out, arguments.json)
    return INTERRUPTED if interrupt.requested else catalogue.code()


def _run(arguments: argparse.Namespace, names: list[str], verdicts: "Verdicts", look: Look | None = None) -> int:
    interrupt = Interrupt()
    bench = _bench(arguments, interrupt)
    bench = bench if look is None else bench._replace(look=look)
    tested = verdicts.tested
    with on_interrupt(interrupt), Meter("apa test", len(names), "scenarios") as meter:
        bench = bench._replace(progress=meter.note)
        for item in run_tests(names, arguments.set, bench, arguments.out, arguments.jobs):
            tested.append(item)
            verdicts.write()
            meter.at(len(tested))
            if not arguments.json:
                _print(tested[-1], f"{len(tested)} of {len(names)}")
        about = provenance_of(tested, shlex.join(["apa", *arguments.words]))
        verdicts.finish(about)
    passed = sum(item.passed for item in tested)
    if arguments.json:
        rows = [_row(item) for item in tested]
        print(json.dumps({"passed": passed == len(names), "about": about, "scenarios": rows}, indent=2))
    else:
        could_not = sum(item.could_not_run for item in tested)
        more = f", {could_not} could not take place" if could_not else ""
        text = f"{passed} of {len(names)} scenarios passed{more}; results in {arguments.out}"
        console().print(text, markup=False, soft_wrap=True)
    if interrupt.requested:
        return INTERRUPTED
    worst = max(item.code for item in tested)
    return worst or (PASSED if passed == len(names) else FAILED)


class Verdicts:
    """JUnit and page of a test: an older page is removed at once, and JUnit says from the start what is not yet run."""

    PERIOD = 1.0
    """Between two times that JUnit is written [s]."""

    def __init__(self, junit: Path, index: Path, names: list[str]) -> None:
        self.tested: list[SuiteResult] = []
        self._junit, self._index, self._names = junit, index, names
        self._next = 0.0
        self.write()
        index.unlink(missing_ok=True)

    def write(self, about: Mapping[str, str] = MappingProxyType({})) -> None:
        """Write JUnit with an error for each scenario that has not run, now and then."""
        if time.monotonic() >= self._next or about:
            waiting = [Suite(Path(name).stem, [], 0.0, NOT_RUN) for name in self._names[len(self.tested) :]]
            write_junit(self._junit, [*(item.suite() for item in self.tested), *waiting], about)
            self._next = time.monotonic() + self.PERIOD

    def finish(self, about: Mapping[str, str]) -> None:
        """Write JUnit and the page."""
        self.write(about)
        write_collection(self._index, self.tested, about)


def _bench(arguments: argparse.Namespace, interrupt: Interrupt) -> SuiteConfig:
    foreign = foreign_of(arguments)
    files = {} if arguments.fmus == "none" else fmu_files(arguments.fmus, say)
    found = [find_file(name, "requirements", "set of requirements", Path.cwd()) for name in arguments.requirements]
    requirements = [(str(file), read_requirements(file)) for file in found]
    return SuiteConfig(files, arguments.fmus, foreign, requirements, interrupt, Warnings(), started=start_record())


def _print(tested: SuiteResult, place: str) -> None:
    out = console()
    verdict = "[green]pass[/]" if tested.passed else "[red]FAIL[/]"
    verdict = "[yellow]not run[/]" if tested.could_not_run else verdict
    out.print(f"{verdict}  {tested.scenario.name}  ({place})")
    for case in tested.cases:
        if not case.passed and not case.skipped:
            out.print(f"        {case.name}: {case.text}", markup=False, soft_wrap=True)
    if tested.error:
        out.print(f"        {tested.error}", markup=False, soft_wrap=True)
    if tested.ignored:
        out.print(f"        left out: {shortly(tested.ignored)}", markup=False, soft_wrap=True)


def _row(tested: SuiteResult) -> dict[str, Any]:
    return {
        "scenario": tested.scenario.name,
        "passed": tested.passed,
        "outcome": tested.summary.outcome if tested.summary else None,
        "expected": tested.scenario.expected_outcome,
        "error": tested.error,
        "could_not_run": tested.could_not_run,
        "left_out": tested.ignored,
        "warnings": list(tested.remarks),
        "cases": [case._asdict() for case in tested.cases],
    }
