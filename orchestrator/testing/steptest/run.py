"""A step test from file to verdict."""

import numpy as np

from orchestrator.evaluation.verdict.judge import Check
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.log.read_log import log_file, read_log
from orchestrator.session.foreign import ImportedFmus
from orchestrator.session.session import NOBODY
from orchestrator.simulation.cosim.algorithm import Interrupt, Observer
from orchestrator.simulation.cosim.recording import Recording
from orchestrator.testing.steptest.drive import drive
from orchestrator.testing.steptest.step_test import StepTest
from orchestrator.testing.steptest.verdict import equivalent, judge_step_test


def run_step_test(
    test: StepTest,
    kind: str,
    foreign: ImportedFmus = NOBODY,
    observers: tuple[Observer, ...] = (),
    interrupt: Interrupt | None = None,
) -> tuple[Recording, list[Check]]:
    """Return the recording of a test and a check for each expectation. Raises ``BadInput``, ``RunError``."""
    recording = drive(test, kind, foreign, observers=observers, interrupt=interrupt)
    checks = judge_step_test(test, recording)
    if test.reference is not None:
        checks += equivalent(test, recording, _reference(test, kind, observers, interrupt))
    return recording, checks


def _reference(test: StepTest, kind: str, observers: tuple[Observer, ...], interrupt: Interrupt | None) -> Recording:
    asked = test.reference
    assert asked is not None
    if bool(asked.log) == bool(asked.model):
        raise BadInput("expected one of log and model", file=test.file, key="reference")
    if not asked.log:
        return drive(test, kind, model=asked.model, observers=observers, interrupt=interrupt)
    return _until(read_log(log_file(str(test.near(asked.log)))), test.stop_ns)


def _until(recording: Recording, stop_ns: int) -> Recording:
    """Return what a longer run had recorded when the test ends."""
    return recording.first(int(np.searchsorted(recording.t_ns, stop_ns, side="right")))
