"""What is asked of a mutant, each by what users and CI run: scenarios, step tests, records, tests, reproductions.

Run in a process of its own whose checkout has the mistake in it. A check returns who found it, "" for nobody.
"""

import contextlib
import fnmatch
import io
import json
from collections.abc import Callable
from functools import partial
from pathlib import Path

NATIVE = ("preview",)
"""Systems whose scenarios take minutes in plain Python: they are compiled."""
TESTS = {
    "guo2015": ("limits_of_time", "guo", "tracking_laws", "two_arc", "smooth_paths", "steering_monitor"),
    "zhang2022": ("zhang",),
    "hsic": ("hsic",),
    "preview": ("preview",),
}
"""Names of the test files of each system."""
SCENARIOS = {"guo2015": ("guo2015-*", "fault-*")}
QUICK: dict[str, tuple[str, ...]] = {}
"""Driven in plain Python before anything is compiled: nearly every mistake shows there."""


def scenarios_of(system: str) -> list[str]:
    """Return the shipped scenarios of a system, the short ones of no picture first."""
    from orchestrator.inputs.scenario.load_scenario import scenario_names

    patterns = SCENARIOS.get(system, (f"{system}*",))
    return [name for name in scenario_names() if any(fnmatch.fnmatch(name, pattern) for pattern in patterns)]


def scenarios(system: str) -> str:
    """Return the first scenario of ``apa test "SYSTEM*"`` that does not pass."""
    from orchestrator.cli import main

    for name in scenarios_of(system):
        if not name.startswith(system):
            continue
        if _quietly(partial(main, ["test", name, "--fmus", _kind(system), "--out", "runs/mutant"])):
            return f"apa test {name}"
    return ""


def steps(system: str) -> str:
    """Return the first step test of the system that does not pass."""
    from orchestrator.cli import main

    for file in sorted(Path("tests/steptest").glob(f"test_{system}*.yaml")):
        if _quietly(partial(main, ["test", str(file), "--fmus", "none", "--out", "runs/mutant"])):
            return f"apa test {file.name}"
    return ""


def record(system: str) -> str:
    """Return the first scenario that does not end as ``tests/golden`` has it."""
    import yaml

    from orchestrator.simulation.cosim.fmu_files import fmu_files
    from orchestrator.studies.papers.drive import drive
    from tests.golden.test_golden import alike, reported

    kept = yaml.safe_load(Path("tests/golden/scenarios.yaml").read_text(encoding="utf-8"))

    def differs(name: str, kind: str) -> bool:
        files = fmu_files("native") if kind == "native" else None
        return not alike(reported(drive(name, files, kind).summary), kept[name])

    asked = [(name, "none") for name in QUICK.get(system, ())]
    asked += [(name, _kind(system)) for name in scenarios_of(system)]
    found = next((f"record of {name}" for name, kind in asked[: len(QUICK.get(system, ()))] if differs(name, kind)), "")
    rest = asked[len(QUICK.get(system, ())) :]
    return found or next((f"record of {name}" for name, kind in rest if differs(name, kind)), "")


def numbers(system: str) -> str:
    """Return the first number of the laws that is not what ``tests/golden`` has."""
    from tests.golden.test_numbers import FILE, changes

    return next((f"number {name}" for name in changes(json.loads(FILE.read_text(encoding="utf-8")))), "")


def tests(system: str) -> str:
    """Return the first of the system's own tests that fails."""
    return _first_failure(
        [str(file) for name in TESTS[system] for file in sorted(Path("tests/controller").glob(f"test_{name}*.py"))]
    )


def printed(system: str) -> str:
    """Return the first test of the numbers, tables and equations printed in the system's paper that fails."""
    name = {"guo2015": "guo", "zhang2022": "zhang"}.get(system, system)
    return _first_failure([f"tests/controller/test_{name}_printed.py"])


def _first_failure(files: list[str]) -> str:
    """Return the name of the first test in ``files`` that fails, "" if none does."""
    import pytest

    class Failure:
        name = ""

        def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
            if report.failed and not self.name:
                self.name = report.nodeid.removeprefix("tests/")

        def pytest_collectreport(self, report: pytest.CollectReport) -> None:
            if report.failed and not self.name:
                self.name = report.nodeid.removeprefix("tests/")

    failure = Failure()
    words = ["-x", "-q", "-n0", "-p", "no:cacheprovider", "--hypothesis-profile=ci", *files]
    return failure.name if _quietly(lambda: int(pytest.main(words, plugins=[failure]))) else ""


def reproduction(system: str) -> str:
    """Return the paper if ``apa reproduce`` says that one of its checks does not hold."""
    from orchestrator.cli import main

    return f"apa reproduce {system}" if _quietly(lambda: main(["reproduce", system, "--out", "runs/mutant"])) else ""


CHECKS: dict[str, Callable[[str], str]] = {
    "scenarios": scenarios,
    "step tests": steps,
    "numbers": numbers,
    "record": record,
    "tests": tests,
    "printed": printed,
    "reproduction": reproduction,
}


def _kind(system: str) -> str:
    return "native" if system in NATIVE else "none"


def _quietly(run: Callable[[], int]) -> int:
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        return run()
