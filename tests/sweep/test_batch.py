"""Rows of the compiled batch against single runs, to the last bit.

Some of them in Python, most as native FMUs, whose runs have the bits of those in Python (tests/twin).
"""

import json
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
import pytest

from fmus.compiled_batch import RecordedSignal, compile_rows
from modelkit.signal import Signal
from orchestrator.evaluation.verdict.measures import Instants, Measure
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import scenario_names
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.text.errors import BadInput
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.studies.sweep.batch import run_batch, run_recorded
from orchestrator.studies.sweep.engine import ChunkTask
from orchestrator.studies.sweep.engines import BATCH_CHUNK, choose_task
from orchestrator.studies.sweep.job import Chunk, arrays, chunk_scenario, job_from, truths
from orchestrator.studies.sweep.rows import row_of, why_not_compiled
from orchestrator.studies.sweep.verdict import OUTCOMES, judge

LIMITS = [
    {"id": "end heading", "signal": "final.heading_error", "max_abs": "3 deg", "source": "test"},
    {"id": "wheel", "signal": "vehicle.steering_wheel_angle", "max": "500 deg", "source": "test"},
    {"id": "backwards", "signal": "vehicle.speed", "min": -1.9, "source": "test"},
    {"id": "at rest", "signal": "vehicle.speed", "max_abs": 1e-6, "window": {"at": "end"}, "source": "test"},
    {"id": "seen", "signal": "controller.measured_speed", "max_abs": 1.8, "source": "test", "required": False},
    {"id": "time", "signal": "duration", "max": 30.0, "source": "test"},
    {"id": "way", "signal": "vehicle.speed", "max_abs": 0.6, "window": {"phase": "TO_Q4"}, "source": "test"},
    {
        "id": "way, if it is gone",
        "signal": "vehicle.speed",
        "max_abs": 0.6,
        "window": {"phase": ["to q4", "TO_Q1"], "if_never": "pass"},
        "source": "test",
    },
]
WINDOWED = [
    {"id": "late", "signal": "vehicle.speed", "max_abs": 1.0, "window": {"from": 4.0, "to": 9.0}, "source": "test"},
    {"id": "ends", "signal": "controller.phase", "equals": "PARKED", "window": {"at": "end"}, "source": "test"},
]


def assert_same(job: Any, chunk: Any, rows: Any, number: Any, kind: str = "native") -> None:
    scenario = chunk_scenario(job, chunk, number)
    ran = run_scenario(scenario, fmu_files(kind) if kind != "none" else None, kind=kind)
    np.testing.assert_array_equal(rows[number], row_of(ran.recording, scenario, job.measures))
    summary = summarize(ran.recording, scenario, 1.0)
    verdict = judge(job, truths(job, chunk), rows)
    assert (OUTCOMES[verdict.outcome[number]], verdict.reason[number]) == (summary.outcome, summary.reason)
    numbers = {name: float(values[number]) for name, values in verdict.numbers.items()}
    for name, value in summary.final.model_dump().items():
        assert np.array([numbers[f"final.{name}"]]).tobytes() == np.array([value]).tobytes(), name
    assert (numbers["duration"], numbers["manoeuvres"]) == (summary.duration, summary.manoeuvres)
    assert numbers["max_speed"] == summary.max_speed


def test_rows_equal_the_python_master(bind: Any, some: Any) -> None:
    _, _, job, chunk = bind()
    rows = run_batch(job, chunk)
    for number in some(len(rows), 2):
        assert_same(job, chunk, rows, number, "none")
    assert len(set(judge(job, truths(job, chunk), rows).reason)) > 3


@pytest.mark.parametrize(("kind", "count"), [("python", 1), ("native", 6)])
def test_rows_equal_fmu_runs(bind: Any, some: Any, kind: str, count: int) -> None:
    _, _, job, chunk = bind()
    rows = run_batch(job, chunk)
    for number in some(len(rows), count, seed=7):
        assert_same(job, chunk, rows, number, kind)


def test_rows_do_not_depend_on_their_neighbours(bind: Any) -> None:
    _, _, job, chunk = bind()
    whole = run_batch(job, chunk)
    back = np.arange(len(whole))[::-1]
    np.testing.assert_array_equal(run_batch(job, Chunk(0, 0, chunk.values[back], chunk.seeds[back]))[back], whole)


@pytest.mark.parametrize("every", [{"controller": 5}, {"vehicle": 3}, {"vehicle": 2, "controller": 4}])
def test_multi_rate_is_the_masters(bind: Any, every: Any) -> None:
    _, _, job, chunk = bind(
        set={f"decimation.{name}": count for name, count in every.items()}, runs={"grid": {"step": [0.005, 0.01]}}
    )
    rows = run_batch(job, chunk)
    for number in range(len(rows)):
        assert_same(job, chunk, rows, number)


@pytest.mark.parametrize("every", [{}, {"controller": 5}, {"vehicle": 3, "controller": 4}])
def test_a_stop_time_between_two_steps_is_the_masters(bind: Any, every: Any) -> None:
    said = {f"decimation.{name}": count for name, count in every.items()}
    _, _, job, chunk = bind(set={**said, "step": 0.007}, runs={"grid": {"stop_time": [1.0, 1.001, 1.0003]}})
    rows = run_batch(job, chunk)
    for number in range(len(rows)):
        assert_same(job, chunk, rows, number)
    assert rows[:, 1].tolist() == [1_000_000_000, 1_001_000_000, 1_000_300_000]


@pytest.mark.parametrize(
    "name", ["guo2015-case1", "guo2015-case5", "guo2015-case4-far", "guo2015-case4-left", "fault-no-path"]
)
def test_shipped_scenarios(bind: Any, name: str) -> None:
    _, _, job, chunk = bind(scenario=name, runs={"grid": {}})
    assert_same(job, chunk, run_batch(job, chunk), 0)


def test_limits_on_signals_and_numbers(bind: Any, tmp_path: Path, some: Any) -> None:
    (tmp_path / "a.yaml").write_text(f"extends: guo2015-case4\nrequirements: {LIMITS}\n")
    scenario, _, job, chunk = bind(scenario=str(tmp_path / "a.yaml"))
    assert why_not_compiled(scenario) == ""
    rows = run_batch(job, chunk)
    for number in some(len(rows), 5):
        assert_same(job, chunk, rows, number)


def test_limits_with_a_window_are_judged_from_recordings(bind: Any, tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text(f"extends: guo2015-case4\nrequirements: {WINDOWED}\n")
    scenario, _, job, chunk = bind(scenario=str(tmp_path / "a.yaml"), runs={"grid": {"controller.system": [0, 1]}})
    assert "'late' needs the whole run" in why_not_compiled(scenario)
    task = choose_task(scenario, None)
    assert task.name == "native FMUs", "in process a run of the parking controller takes some 25 times as long"
    rows = run_recorded(job, chunk, "none")
    assert np.array_equal(task.work(job, chunk), rows, equal_nan=True)
    for number in range(len(rows)):
        assert_same(job, chunk, rows, number)


FAULTS = [
    {"signal": "vehicle.odometry", "kind": "noise", "sigma": 0.01, "start": 1.0, "stop": 9.0},
    {"signal": "vehicle.measured_speed", "kind": "dropout", "probability": 0.4, "stop": 20.0},
    {"signal": "controller.steering_wheel_request", "kind": "delay", "delay": 0.25, "start": 2.0},
    {"signal": "vehicle.odometry", "kind": "stuck_at_last", "start": 6.0, "stop": 6.3},
    {"signal": "controller.prompt", "kind": "override", "value": "STOP", "start": 12.0, "stop": 12.7},
    {"signal": "vehicle.manual.brake", "kind": "override", "value": 0.3, "start": 3.0, "stop": 3.05},
    {"signal": "controller.steering_active", "kind": "dropout", "probability": 0.2},
]
VARIED = {
    "faults[1].sigma": {"uniform": [0.0, 0.03]},
    "faults[2].probability": {"uniform": [0.0, 1.0]},
    "faults[3].delay": {"uniform": [0.0, 0.6]},
    "faults[4].start": {"uniform": [0.0, 10.0]},
    "faults[4].stop": {"uniform": [10.1, 20.0]},
    "faults[5].start": {"uniform": [0.0, 12.0]},
    "decimation.controller": {"choice": [1, 2, 3]},
    "decimation.vehicle": {"choice": [1, 2]},
}


def test_faults_are_the_python_masters(bind: Any, tmp_path: Path, some: Any) -> None:
    """All kinds, of outputs and inputs, of reals, whole numbers and truths, at any time, models due at other times."""
    (tmp_path / "a.yaml").write_text(f"extends: guo2015-case4\nfaults: {json.dumps(FAULTS)}\n")
    scenario, _, job, chunk = bind(scenario=str(tmp_path / "a.yaml"), runs={"monte_carlo": {"n": 200, **VARIED}})
    assert why_not_compiled(scenario) == ""
    rows = run_batch(job, chunk)
    for number in some(len(rows), 6):
        assert_same(job, chunk, rows, number)
    assert len(set(judge(job, truths(job, chunk), rows).reason)) > 2
    back = np.arange(len(rows))[::-1]
    np.testing.assert_array_equal(run_batch(job, Chunk(0, 0, chunk.values[back], chunk.seeds[back]))[back], rows)


@pytest.mark.parametrize("name", [name for name in scenario_names() if name.startswith("fault-")])
def test_shipped_faults(bind: Any, name: Any) -> None:
    _, _, job, chunk = bind(scenario=name, runs={"grid": {}})
    assert_same(job, chunk, run_batch(job, chunk), 0)


def test_an_input_may_be_nan(bind: Any, tmp_path: Path) -> None:
    """One in the search, one while entering the slot: the system parks all the same."""
    nan = {"kind": "override", "value": "nan", "start": 4.0}
    faults = [{"signal": f"vehicle.ultrasonic[{number}]", **nan} for number in (9, 8)]
    (tmp_path / "a.yaml").write_text(f"extends: apa-parallel\nfaults: {json.dumps(faults)}\n")
    runs = {"grid": {"faults[1].start": [4.0, 1e6], "faults[2].start": [18.0, 1e6]}}
    _, _, job, chunk = bind(scenario=str(tmp_path / "a.yaml"), runs=runs)
    rows = run_batch(job, chunk)
    assert_same(job, chunk, rows, 0)
    verdict = judge(job, truths(job, chunk), rows)
    assert list(verdict.reason) == ["all checks passed"] * 4


def test_the_time_of_an_instant(bind: Any) -> None:
    when = Instants("controller.phase", (3,))
    measures = [
        Measure("time", "vehicle.speed", when),
        Measure("time", "vehicle.speed", Instants("controller.phase", (60,))),
    ]
    _, _, job, chunk = bind()
    job = job._replace(measures=[*job.measures, *measures])
    rows = run_batch(job, chunk)
    assert_same(job, chunk, rows, 3)
    assert 0.0 < rows[3, -2] < rows[3, 1] / 1e9
    assert np.isnan(rows[3, -1])


def test_a_signal_that_does_not_exist() -> None:
    with pytest.raises(KeyError, match=r"vehicle\.sped"):
        compile_rows(MODELS, None, [RecordedSignal("last", "vehicle.sped")])


class Wrong(NamedTuple):
    prompt: Annotated[float, Signal("1", "an integer at its receiver")] = 0.0


def test_connected_types_must_agree() -> None:
    models = {**MODELS, "controller": MODELS["controller"]._replace(outputs=Wrong)}
    with pytest.raises(TypeError, match=r"prompt: output of controller is float, input of vehicle is int"):
        compile_rows(models, None, [RecordedSignal("last", "vehicle.speed")])


def test_arrays_of_another_shape_are_refused(bind: Any) -> None:
    _, _, job, chunk = bind()
    rows = compile_rows(MODELS, None, [RecordedSignal("last", "vehicle.speed")])
    parameters, times = arrays(job, chunk)
    none = np.empty((192, 0))
    with pytest.raises(ValueError, match="expected 192 lines of 3 in C order"):
        rows(parameters, times, none, np.empty((192, 4)))
    with pytest.raises(ValueError, match="in C order"):
        rows(np.asfortranarray(parameters), times, none, np.empty((192, 3)))
    with pytest.raises(ValueError, match="expected 192 lines of 0"):
        rows(parameters, times, np.empty((192, 4)), np.empty((192, 3)))


def test_a_study_can_vary_what_is_true_and_what_the_controller_is_told(bind: Any) -> None:
    runs = {"grid": {"target.y": [-3.056, -2.9], "slot.length": [6.0, 8.0], "controller.target.x": [-7.608, -7.4]}}
    _, _, job, chunk = bind(runs=runs)
    rows = run_batch(job, chunk)
    verdict = judge(job, truths(job, chunk), rows)
    for number in range(len(rows)):
        assert_same(job, chunk, rows, number)
        scenario = chunk_scenario(job, chunk, number)
        assert scenario.target is not None
        assert scenario.controller["target.y"] == scenario.target.y
        assert scenario.target.x == -7.608
    along = verdict.numbers["final.longitudinal_error"]
    assert set((along[1::2] - along[::2]).round(1).tolist()) == {0.2}
    assert len(set(verdict.numbers["final.outline_margin"].round(2).tolist())) > 1


def test_the_scene_of_a_study_moves_the_kerb(bind: Any, tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text(
        "extends: guo2015-case4\nscene: {kerbs: [[-20, -4.1, 5, -4.1, 0.1]]}\nrequirements: [gbt41630]\n"
    )
    keys = "scene.kerbs[1].y1, scene.kerbs[1].y2"
    _, _, job, chunk = bind(scenario=str(tmp_path / "a.yaml"), runs={"grid": {keys: [-4.05, -4.1, -4.4, -9.0]}})
    rows = run_batch(job, chunk)
    verdict = judge(job, truths(job, chunk), rows)
    for number in range(len(rows)):
        assert_same(job, chunk, rows, number)
    assert [OUTCOMES[code] for code in verdict.outcome] == ["parked", "parked", "not_parked", "parked"]
    assert verdict.reason[2] == "beyond its limit: farthest tyre to the kerb"


def test_a_key_of_what_the_scenario_does_not_have(bind: Any) -> None:
    with pytest.raises(BadInput, match="the scenario has no target"):
        bind(scenario="preview", runs={"grid": {"target.x": [1.0]}})


def test_a_table_of_a_version_with_other_parameters_sets_those_it_names(bind: Any) -> None:
    """Places are those of the models now: an older version may have had one more before, or one less."""
    keys = {"vehicle.ultrasonic.noise": [0.01], "vehicle.odometry.radius_error": [0.002], "stop_time": [50.0]}
    _, _, job, _ = bind(runs={"grid": keys})
    older = {**job._asdict(), "places": [place + 1 for place in job.places]}
    older["seeded"] = [(owner, name, place + 1) for owner, name, place in job.seeded]
    again = job_from(json.loads(json.dumps(older)))
    ours = [owner in job.scenario for owner in job.owners]
    assert [p for p, is_ours in zip(again.places, ours, strict=True) if is_ours] == [
        p for p, is_ours in zip(job.places, ours, strict=True) if is_ours
    ]
    assert again.seeded == job.seeded
    with pytest.raises(KeyError, match="gone"):
        job_from(json.loads(json.dumps({**job._asdict(), "names": ["gone", *job.names[1:]]})))


def test_what_counts_at_some_instants_only_is_as_in_the_recording(bind: Any, some: Any) -> None:
    _, _, job, chunk = bind()
    parking = Instants("controller.phase", (2, 3))
    hows: tuple[Any, ...] = ("last", "largest", "greatest", "smallest", "travel", "first")
    signals = ("vehicle.speed", "vehicle.clearance", "controller.manoeuvres", "vehicle.prompt")
    measures = [Measure(how, signal, when) for how in hows for signal in signals for when in (parking, None)]
    never = Measure("last", "vehicle.speed", Instants("controller.phase", (63,)))
    job = job._replace(measures=[*job.measures, *measures, never])
    rows = run_batch(job, chunk)
    assert np.isnan(rows[:, -1]).all()
    for number in some(len(rows), 4):
        run = chunk_scenario(job, chunk, number)
        recording = run_scenario(run, fmu_files("native"), kind="native").recording
        np.testing.assert_array_equal(rows[number], row_of(recording, run, job.measures))


def test_each_run_of_a_study_has_the_stop_time_of_its_driver(bind: Any) -> None:
    speeds = {"grid": {"vehicle.driver.profile[1].speed": [0.05, 0.2, 1.5]}}
    _, _, job, chunk = bind(runs=speeds)
    assert (arrays(job, chunk)[1][:, 1] * 1e-9).tolist() == pytest.approx([725.0, 185.0, 125.0])
    assert [chunk_scenario(job, chunk, number).longest for number in range(3)] == pytest.approx([725.0, 185.0, 125.0])
    _, _, job, chunk = bind(runs=speeds, set={"stop_time": 40})
    assert (arrays(job, chunk)[1][:, 1] * 1e-9).tolist() == [40.0] * 3


@pytest.mark.parametrize(("runs", "chunk"), [(1, 8), (400, 32), (1_984, 128), (100_000, 504)])
def test_a_study_has_chunks_for_all_cores_that_fill_the_lanes(runs: int, chunk: int) -> None:
    assert ChunkTask(run_batch, "compiled batch", BATCH_CHUNK, threads=True).chunk_of(runs) == chunk
