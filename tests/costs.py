"""Measured cost of the tests: ``tests/costs.tsv`` says which are slow and in which order files run.

Cost is processor time of the test and of the child processes that it waited for, so that load does not change it. A
fixture shared by several tests is divided among those that use it. ``pytest --costs FILES`` measures these files anew,
``make costs`` all.
"""

import os
from collections import defaultdict
from collections.abc import Generator
from pathlib import Path
from typing import Any

import pytest

FILE = Path(__file__).parent / "costs.tsv"
COST_OF_SLOW = 0.3
"""All cases of a test function together [s]; from here on ``make quick`` leaves the function out."""
LOWEST_RECORDED = 0.2
"""Functions below this [s] are not in the table: 95 of 100 lines would say that a test costs nothing."""
SHARED_SCOPES = ("class", "module", "package", "session")


def processor_time() -> float:
    """Return the processor time of this process and of its children that have ended [s]."""
    spent = os.times()
    return spent.user + spent.system + spent.children_user + spent.children_system


def function_of(nodeid: str) -> str:
    """Return ``file::function`` of a test, relative to the folder of the tests, without its parameters."""
    return nodeid.split("[")[0].removeprefix("tests/")


def read_costs(file: Path = FILE) -> dict[str, float]:
    """Return ``file::function`` -> cost of all its cases [s]."""
    rows = [line.split("\t") for line in file.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return {name: float(cost) for cost, name in rows}


def is_slow(nodeid: str, costs: dict[str, float]) -> bool:
    """Return whether ``make quick`` leaves out a test."""
    return costs.get(function_of(nodeid), 0.0) >= COST_OF_SLOW


def write_costs(costs: dict[str, float], file: Path = FILE) -> None:
    """Write the functions that cost something, sorted by name so that a new measurement shows what has changed."""
    head = "# Processor seconds of all cases of a test function; written by `make costs`.\n"
    rows = [f"{costs[name]:.1f}\t{name}\n" for name in sorted(costs) if costs[name] >= LOWEST_RECORDED]
    file.write_text(head + "".join(rows), encoding="utf-8")


def cost_of_files(costs: dict[str, float]) -> dict[str, float]:
    """Return file -> cost of its functions together [s]."""
    files: dict[str, float] = defaultdict(float)
    for name, cost in costs.items():
        files[name.split("::")[0]] += cost
    return files


class CostMeter:
    """Measures in each process that runs tests; the reports carry the result to the process that began them."""

    def __init__(self) -> None:
        self.fixtures: dict[tuple[str, str], float] = defaultdict(float)
        """(base of the fixture, its name) -> cost, not yet handed over [s]."""
        self.inside = 0.0
        """Cost of shared fixtures since the phase began [s]."""

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: Any) -> Generator[None, Any, Any]:
        """Measure a fixture that tests share."""
        if fixturedef.scope not in SHARED_SCOPES:
            return (yield)
        before, nested = processor_time(), self.inside
        try:
            return (yield)
        finally:
            own = processor_time() - before - (self.inside - nested)
            self.inside += own
            self.fixtures[fixturedef.baseid, fixturedef.argname] += own

    def _phase(self, item: pytest.Item) -> Generator[None, Any, Any]:
        self.inside = 0.0
        before = processor_time()
        try:
            return (yield)
        finally:
            item.stash[PHASE] = processor_time() - before - self.inside

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> Generator[None, Any, Any]:
        """Measure what prepares a test."""
        return (yield from self._phase(item))

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Generator[None, Any, Any]:
        """Measure a test."""
        return (yield from self._phase(item))

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_teardown(self, item: pytest.Item, nextitem: pytest.Item | None) -> Generator[None, Any, Any]:
        """Measure what clears up after a test; after the last one, what all of them used ends, a browser say."""
        result = yield from self._phase(item)
        if nextitem is None:
            item.stash[PHASE] = 0.0
        return result

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, item: pytest.Item) -> Generator[None, Any, Any]:
        """Put the cost of the phase into its report."""
        report = yield
        report.cost = item.stash.get(PHASE, 0.0)
        info = getattr(item, "_fixtureinfo", None)
        used = info.name2fixturedefs.values() if info else ()  # a test of a YAML file has none
        report.shared = [
            [found.baseid, found.argname]
            for definitions in used
            for found in definitions
            if found.scope in SHARED_SCOPES
        ]
        report.made = [[*key, cost] for key, cost in self.fixtures.items()]
        self.fixtures.clear()
        return report


PHASE = pytest.StashKey[float]()


class CostTable:
    """Adds up what the reports say and writes the table at the end."""

    def __init__(self) -> None:
        self.own: dict[str, float] = defaultdict(float)
        self.made: dict[tuple[str, str], float] = defaultdict(float)
        self.users: dict[tuple[str, str], list[str]] = defaultdict(list)

    def pytest_runtest_logreport(self, report: Any) -> None:
        """Add one phase of one test."""
        name = function_of(report.nodeid)
        if not hasattr(report, "cost"):
            return  # of a process that has crashed
        self.own[name] += report.cost
        for base, fixture, cost in report.made:
            self.made[base, fixture] += cost
        if report.when == "call":
            for base, fixture in report.shared:
                self.users[base, fixture].append(name)

    def costs(self) -> dict[str, float]:
        """Return ``file::function`` -> its own cost and its share of fixtures [s]."""
        costs = dict(self.own)
        for fixture, cost in self.made.items():
            for name in self.users[fixture]:
                costs[name] += cost / len(self.users[fixture])
        return costs

    def pytest_sessionfinish(self) -> None:
        """Write the table; functions of files that did not run stay in it."""
        ran = {name.split("::")[0] for name in self.own}
        kept = {name: cost for name, cost in read_costs().items() if name.split("::")[0] not in ran}
        write_costs(kept | self.costs())
