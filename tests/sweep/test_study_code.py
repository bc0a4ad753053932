"""Code made for a study: the same bits as the complete models, of which it says what it omits."""

import importlib
from typing import Any

import numpy as np
import pytest

from orchestrator.cli import main
from orchestrator.commands import STUDIES
from orchestrator.inputs.scenario.files import library_names
from orchestrator.studies.sweep.batch import run_batch
from orchestrator.studies.sweep.engines import choose_task
from orchestrator.studies.sweep.job import Chunk, make_job
from orchestrator.studies.sweep.study.read_study import read_study
from orchestrator.studies.sweep.study_code import STUDY_CODE_FROM, StudyRows

SHIPPED = [*STUDIES, *library_names("studies")]
RUNS = 12


def test_code_of_a_study_has_the_same_bits(bind: Any) -> None:
    fault = {"signal": "vehicle.odometry.x", "kind": "noise", "sigma": 0.01}
    _, _, job, chunk = bind(set={"faults": [fault]})
    assert run_batch(job._replace(runs=STUDY_CODE_FROM), chunk).tobytes() == run_batch(job, chunk).tobytes()


@pytest.mark.release
@pytest.mark.parametrize("name", SHIPPED)
def test_code_of_each_shipped_study_has_the_same_bits(name: str) -> None:
    study = importlib.import_module(STUDIES[name]).study() if name in STUDIES else read_study(name, {})
    if not choose_task(study.scenario, None).is_compiled:
        pytest.skip("nothing is compiled")
    job, design = make_job(study), study.design
    places = np.random.default_rng(7).choice(len(design.seeds), min(RUNS, len(design.seeds)), replace=False)
    chunk = Chunk(0, 0, design.values[places], design.seeds[places])
    own, complete = (run_batch(job._replace(runs=runs), chunk) for runs in (STUDY_CODE_FROM, 0))
    assert own.tobytes() == complete.tobytes()


def test_runs_that_differ_are_made_by_the_complete_models() -> None:
    def rows(value: float) -> Any:
        return lambda parameters, times, faults, out: out.fill(value)

    complete, equal, other = rows(1.0), rows(1.0), rows(2.0)
    for own, chosen in (((equal,), equal), ((other,), complete), ((other, equal), equal), ((equal, other), equal)):
        found = StudyRows(complete, *own)
        out = np.zeros((9, 3))
        found(np.zeros((9, 2)), np.zeros((9, 2), np.int64), np.zeros((9, 0)), out)
        assert found.chosen is chosen
        assert (out == 1.0).all()


def test_explain_says_what_is_omitted(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", "guo2015-speed-rate", "--explain"]) == 0
    text = capsys.readouterr().out
    assert "ultrasonic" in text
    assert "1 of 5 systems: guo2015" in text
    assert "has code of its own" in text
