"""A pytest plugin: step tests in ``test_*.yaml`` are tests, and three fixtures drive what is under test.

    def test_parks(closed_loop):
        run = closed_loop("guo2015-case4", {"vehicle.body": "double_track"})
        run.assert_outcome("parked").assert_requirements("gbt41630")

    def test_steering(vehicle):
        step = {"step": {"at": 1.0, "to": 3.14}}
        run = vehicle({"steering_active": True, "steering_wheel_request": step}, stop_time=3.0)
        run.assert_requirements({"id": "rises", "signal": "steering_wheel_angle",
                       "response": {"rise_time": {"max": 0.5}, "to": 3.14, "at": 1.0}})

``--apa-controller their.fmu``, ``--apa-vehicle``: FMUs of others in the place of ours; ``--apa-fmus``: which of ours.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from apa_cosim.testing import ClosedLoopRun, OpenLoopRun

    Changes = Mapping[str, object]


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options that say what is tested."""
    group = parser.getgroup("apa-cosim")
    group.addoption("--apa-controller", metavar="FMU", help="use this controller instead of the shipped one")
    group.addoption("--apa-vehicle", metavar="FMU", help="use this vehicle instead of the shipped one")
    group.addoption("--apa-fmus", choices=("native", "python", "none"), help="kind of the shipped FMUs")


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> "StepTestFile | None":
    """Collect the step tests."""
    if not (file_path.name.startswith("test_") and file_path.suffix in (".yaml", ".yml")):
        return None
    from orchestrator.testing.steptest.step_test import declares_step_test

    return StepTestFile.from_parent(parent, path=file_path) if declares_step_test(file_path) else None


class StepTestFile(pytest.File):
    """A YAML file that is a step test."""

    def collect(self) -> "list[StepTestItem]":
        """Return one test for each expectation; they share one run."""
        from orchestrator.testing.steptest.step_test import load_step_test

        test = load_step_test(self.path)
        names = [item.id for item in test.expect] + (["reference"] if test.reference else [])
        return [StepTestItem.from_parent(self, name=name) for name in names]

    def checks(self) -> list[Any]:
        """Return the checks of the run, which is made once."""
        if not hasattr(self, "_checks"):
            from apa_cosim.testing import step_test_checks

            self._checks = step_test_checks(self.path, self.config)
        return self._checks


class StepTestItem(pytest.Item):
    """One expectation of a step test."""

    def runtest(self) -> None:
        """Fail with signal, time, value, limit and margin."""
        from apa_cosim.testing import assert_met
        from orchestrator.inputs.scenario.scenario import PENETRATION

        assert isinstance(self.parent, StepTestFile)
        names = (self.name, PENETRATION)
        mine = [check for check in self.parent.checks() if {check.id, check.source, check.signal} & {*names}]
        assert_met(mine)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> str:
        """Return what was missed, without a traceback of ours."""
        return str(excinfo.value)

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """Return where the test is written and what it is called."""
        return self.path, None, f"{self.path.name}: {self.name}"


@pytest.fixture
def closed_loop(request: pytest.FixtureRequest) -> "Callable[..., ClosedLoopRun]":
    """A function that runs a scenario, by name, file or as data: ``closed_loop(scenario, changes)``."""
    from apa_cosim.testing import closed_loop_of

    return closed_loop_of(request.config)


@pytest.fixture
def controller(request: pytest.FixtureRequest) -> "Callable[..., OpenLoopRun]":
    """A function that runs the controller in open loop: ``controller(inputs, stop_time=.., parameters=..)``."""
    from apa_cosim.testing import open_loop_of

    return open_loop_of("controller", request.config)


@pytest.fixture
def vehicle(request: pytest.FixtureRequest) -> "Callable[..., OpenLoopRun]":
    """A function that runs the vehicle in open loop: ``vehicle(inputs, stop_time=.., parameters=.., step=..)``."""
    from apa_cosim.testing import open_loop_of

    return open_loop_of("vehicle", request.config)
