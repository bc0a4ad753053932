"""CPython, PythonFMU, native FMI 2.0 and 3.0, C library, batch: the same bits in every scenario.

All signals at all exchanges. FMI 3.0 and the C library are played the inputs that a run has recorded, the batch keeps
all measures and the last value of each output.
"""

from typing import Any

import numpy as np
import pytest

from modelkit.variables import variables
from orchestrator.evaluation.verdict.measures import Measure, measure_recording
from orchestrator.evaluation.verdict.numbers import MEASURES
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import can_compile
from orchestrator.studies.sweep.batch import run_batch
from orchestrator.studies.sweep.job import chunks, make_job
from orchestrator.studies.sweep.rows import FIRST_MEASURE
from orchestrator.studies.sweep.study.cases import LabelledScenario, design_of
from orchestrator.studies.sweep.study.study import Study
from tests.native_runs import shipped_scenarios
from tests.twin.replays import CLibrary, Fmi3, played

LIKE_OTHERS = (
    *("apa-pull-out-right", "apa-resume", "apa-switched-on-again", "apa-slot-too-shallow"),
    "apa-external-slot-occupied",
    *("apa-switched-off", "apa-parallel-tight", "apa-parallel-left", "apa-parallel-walls", "apa-parallel-deep"),
    *("apa-perpendicular-tight", "apa-perpendicular-walls", "apa-pedestrian-stays", "apa-not-confirmed"),
    *("apa-parallel", "apa-perpendicular", "apa-driver-drives", "apa-driver-brakes", "apa-over-speed", "cicap-pillar"),
    *("apa-parallel-fast", "apa-perpendicular-left", "apa-external-slot-nose-in", "cicap-child", "cicap-bicycle"),
    *("guo2015-case1-105", "guo2015-case2-105", "guo2015-case3-105", "guo2015-case5-105"),
    *("guo2015-case2", "guo2015-case3", "guo2015-case5", "guo2015-case4-far", "guo2015-case4-left"),
    *("preview-8", "preview-18", "preview-geometry", "preview-printed"),
    *("apa-parallel-real", "apa-no-slot", "apa-search-too-fast", "apa-takeover", "apa-slot-too-short"),
    *("guo2015-case1-cwpt", "guo2015-case4-105", "hsic", "hsic-driven-past", "zhang2022-pid"),
    *("adaptive-ahead", "apa-choose", "apa-external-slot", "apa-pedestrian", "cicap-object-in-slot"),
)
"""Other numbers of a scenario below, through the same branches of the models (all but 4 of 7,080); tests/golden
has their ends, `make release` the bits."""
SCENARIOS = [
    pytest.param(name, marks=pytest.mark.release if name in LIKE_OTHERS else ())
    for name, scenario in shipped_scenarios().items()
    if scenario.models == MODELS
]
"""Those of a controller apart have their own: tests/planning."""
PYTHON_FMU_TOO = ("fault-pose-nan", "fault-driver-takes-over", "guo2015-case4", "guo2015-case4-105")
"""The PythonFMU runs the very functions that run in process, so a few scenarios are enough; on each change two."""
SLOW = 2.0
"""The fuzzy law takes CPython a minute for a drive: there it is compared over this time [s], the others over all."""
WHOLE = "preview-camera"
"""Of the drives with that law the one that all but CPython play to its end: the one of the fewest exchanges, 15,500."""
OUTPUTS = [f"{name}.{item.name}" for name, model in MODELS.items() for item in variables(model.outputs)]
KEPT = [*MEASURES, *(Measure("last", signal) for signal in OUTPUTS)]


def differing(one: Any, other: Any) -> Any:
    """Return the signals whose bits differ, with the first row in which they do."""
    assert one.signals.keys() == other.signals.keys()
    assert np.array_equal(one.t_ns, other.t_ns)
    found = {}
    for name, values in one.signals.items():
        same = np.ascontiguousarray(values).view(np.int64) == np.ascontiguousarray(other.signals[name]).view(np.int64)
        same |= np.isnan(values) & np.isnan(other.signals[name])
        if not same.all():
            found[name] = int(np.argmin(same))
    return found


def unlike(signals: Any, recording: Any) -> Any:
    """Return those of ``signals`` whose bits are not the recorded ones; a NaN is a NaN."""
    return [name for name, values in signals.items() if not same(values, recording.signals[name])]


def same(one: Any, other: Any) -> Any:
    bits = np.ascontiguousarray(one).view(np.int64) == np.ascontiguousarray(other).view(np.int64)
    return bool((bits | (np.isnan(one) & np.isnan(other))).all())


@pytest.fixture(scope="module")
def targets(fmus: Any, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Target -> model -> what plays recorded inputs to it."""
    folder = tmp_path_factory.mktemp("fmi3")
    return {
        "FMI 3.0": {name: Fmi3(MODELS[name], path, folder / name) for name, path in fmus["fmi3"].items()},
        "C library": {name: CLibrary(model) for name, model in MODELS.items()},
    }


@pytest.mark.skipif(not can_compile(), reason="needs a C compiler")
@pytest.mark.parametrize("name", SCENARIOS)
def test_every_target_equals_the_models_in_process(fmus: Any, targets: Any, name: Any) -> None:
    scenario = load_scenario(name, [])
    short = load_scenario(name, [f"stop_time={SLOW}"]) if name.startswith("preview") else scenario
    in_process, found = run_scenario(short), run_scenario(short, fmus["native"], kind="native")
    assert found.end == in_process.end
    assert differing(found.recording, in_process.recording) == {}
    whole = scenario if name == WHOLE else short
    expected = found if whole is short else run_scenario(whole, fmus["native"], kind="native")
    for target, models in targets.items():
        for model, play in models.items():
            assert unlike(played(play, whole, expected.recording, model), expected.recording) == [], target
    if whole.system is not None:  # external inputs: no run of the batch
        return
    fixed, design = design_of([LabelledScenario({}, whole)])
    job = make_job(Study(fixed, design, {"name": name}))._replace(measures=list(KEPT))
    (row,) = run_batch(job, next(chunks(design, 1)))
    assert row[1] == expected.recording.t_ns[-1]
    numbers = np.array([measure_recording(item, expected.recording) for item in KEPT])
    pairs = zip(KEPT, row[FIRST_MEASURE:], numbers, strict=True)
    assert [item for item, one, other in pairs if not same(one, other)] == []


@pytest.mark.parametrize(
    "name", [*PYTHON_FMU_TOO[:2], *(pytest.param(name, marks=pytest.mark.release) for name in PYTHON_FMU_TOO[2:])]
)
def test_native_fmus_equal_python_fmus(fmus: Any, name: Any) -> None:
    scenario = load_scenario(name, [])
    expected = run_scenario(scenario, fmus["python"], kind="python")
    found = run_scenario(scenario, fmus["native"], kind="native")
    assert found.end == expected.end
    assert len(found.recording.t_ns) > 100
    assert differing(found.recording, expected.recording) == {}
