"""The other papers' controllers, compiled and in CPython: the same bits at the end of the same drive."""

import pytest

from orchestrator.cosim.fmu_files import can_compile
from orchestrator.scenario.load_scenario import load_scenario
from orchestrator.session.session import run_scenario
from orchestrator.sweep.batch import run_batch
from orchestrator.sweep.job import chunks, make_job
from orchestrator.sweep.rows import FIRST_MEASURE
from orchestrator.sweep.study.cases import LabelledScenario, design_of
from orchestrator.sweep.study.study import Study
from orchestrator.verdict.measures import Measure, measured
from orchestrator.verdict.numbers import MEASURES

pytestmark = pytest.mark.skipif(not can_compile(), reason="needs a C compiler")

TAKEN = (
    *MEASURES,
    Measure("last", "controller.phase"),
    Measure("last", "controller.preview.y_l"),
    Measure("last", "controller.lateral_error"),
)
DRIVES = {
    "zhang2022": 30,
    "zhang2022-double-track": 6,
    "hsic": 60,
    "hsic-shuffle": 60,
    "preview": 16,
    "preview-geometry": 16,
}


@pytest.mark.parametrize("name", DRIVES)
def test_same_bits(name):
    scenario = load_scenario(name, [f"stop_time={DRIVES[name]}"])
    recording = run_scenario(scenario).recording
    fixed, design = design_of([LabelledScenario({}, scenario)])
    job = make_job(Study(fixed, design, {"name": name}))._replace(measures=list(TAKEN))
    (row,) = run_batch(job, next(chunks(design, 1)))
    assert row[1] == recording.t_ns[-1]
    assert row[FIRST_MEASURE:].tolist() == [measured(item, recording) for item in TAKEN]
