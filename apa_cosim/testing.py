"""What the pytest plugin drives: runs that assert with signal, time, value and limit."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import pytest

from apa_cosim.runs import Run, record_scenario, with_foreign
from apa_cosim.verdicts import judge
from orchestrator.evaluation.verdict.judge import Check
from orchestrator.evaluation.verdict.limit_text import sentence
from orchestrator.inputs.scenario.requirements import Requirement
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.renamed_names import API
from orchestrator.session.foreign import ImportedFmus
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.kinds import default_kind
from orchestrator.simulation.cosim.recording import Recording
from orchestrator.testing.steptest.drive import drive
from orchestrator.testing.steptest.run import run_step_test
from orchestrator.testing.steptest.step_test import StepTest, load_step_test
from orchestrator.testing.steptest.verdict import judge_step_test

Same = TypeVar("Same", bound="ClosedLoopRun")


def old_method(owner: str, name: str) -> AttributeError:
    """Return the error of a method that ``owner`` does not have, with its new name where it had one before."""
    now = API.get(name)
    return AttributeError(f"{owner} has no attribute {name!r}" + (f"; it is called {now} now" if now else ""))


class ClosedLoopRun(Run):
    """A run of a scenario with assertions on its outcome and on requirements."""

    def __getattr__(self, name: str) -> Any:
        raise old_method("ClosedLoopRun", name)

    def assert_outcome(self: Same, outcome: str) -> Same:
        """Return the run; fails if it came out otherwise, with why."""
        __tracebackhide__ = True
        assert self.outcome == outcome, (
            f"{self.scenario.name}: {self.outcome}, {self.summary.headline}; expected {outcome}"
        )
        return self

    def assert_requirements(self: Same, *requirements: str | Path | Requirement | Mapping[str, Any]) -> Same:
        """Return the run; fails if it misses a requirement, with signal, time, value, limit and margin."""
        __tracebackhide__ = True
        assert_met(judge(self, *requirements))
        return self


class OpenLoopRun:
    """Open-loop run of one model: ``run["steering_wheel_angle"]`` over ``run.t``; names without owner."""

    def __init__(self, test: StepTest, recording: Recording) -> None:
        self._test = test
        self._owner = next(iter(recording.signals)).split(".", 1)[0]
        self.recording = recording

    @property
    def t(self) -> Array:
        """Time of each exchange [s]."""
        return self.recording.t

    def __getitem__(self, name: str) -> Array:
        return self.recording.signals[f"{self._owner}.{name}"]

    def __getattr__(self, name: str) -> Any:
        raise old_method("OpenLoopRun", name)

    def assert_requirements(self, *expectations: Mapping[str, Any]) -> "OpenLoopRun":
        """Return the run; fails if it misses one of ``expectations``, written as in a step test's ``expect``."""
        __tracebackhide__ = True
        test = StepTest.model_validate({**self._test.model_dump(), "expect": [dict(item) for item in expectations]})
        assert_met(judge_step_test(test, self.recording))
        return self


def assert_met(checks: list[Check]) -> None:
    """Fail with one line for each check that is missed."""
    __tracebackhide__ = True
    missed = [f"{check.id}: {sentence(check)}" for check in checks if check.required and not check.passed]
    assert not missed, "\n".join(missed)


def closed_loop_of(config: pytest.Config) -> Callable[..., ClosedLoopRun]:
    """Return the function behind the fixture ``closed_loop``."""
    kind, given = _kind(config), _foreign(config)

    def closed_loop(scenario: str | Path | Scenario, changes: Mapping[str, object] | None = None) -> ClosedLoopRun:
        chosen, foreign = with_foreign(scenario, changes, given)
        return ClosedLoopRun(chosen, *record_scenario(chosen, kind, foreign))

    return closed_loop


def open_loop_of(model: str, config: pytest.Config) -> Callable[..., OpenLoopRun]:
    """Return the function behind the fixtures ``controller`` and ``vehicle``."""
    kind, foreign = _kind(config), _foreign(config)

    def open_loop(
        inputs: Mapping[str, object],
        *,
        stop_time: float,
        parameters: Mapping[str, object] | None = None,
        step: float = 0.01,
        contact_allowed: bool = False,
    ) -> OpenLoopRun:
        test = StepTest(
            name=model,
            model=model,
            stop_time=stop_time,
            step=step,
            contact_allowed=contact_allowed,
            inputs=dict(inputs),
            parameters=dict(parameters or {}),
            file=Path("test"),
        )
        return OpenLoopRun(test, drive(test, kind, foreign))

    return open_loop


def step_test_checks(path: Path, config: pytest.Config) -> list[Check]:
    """Return the checks of a step test in a file."""
    return run_step_test(load_step_test(path), _kind(config), _foreign(config))[1]


def _kind(config: pytest.Config) -> str:
    return str(config.getoption("--apa-fmus") or default_kind())


def _foreign(config: pytest.Config) -> ImportedFmus:
    given = {name: config.getoption(f"--apa-{name}") for name in ("controller", "vehicle")}
    return ImportedFmus({name: Path(str(path)) for name, path in given.items() if path})
