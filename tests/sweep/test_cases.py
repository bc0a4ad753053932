"""Studies from functions: designs made of complete scenarios, columns of their own, replays to the same bits."""

from pathlib import Path

import numpy as np
import pytest

from orchestrator.evaluation.verdict.measures import Instants, Measure
from orchestrator.evaluation.verdict.numbers import Metric
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.requirements import Requirement, Window, library_requirements
from orchestrator.inputs.scenario.scenario import Scenario, Target
from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.fmu_files import can_compile
from orchestrator.studies.sweep.columns import WITHIN, columns_of
from orchestrator.studies.sweep.fields import find_field
from orchestrator.studies.sweep.in_memory import columns_in_memory
from orchestrator.studies.sweep.job import chunk_scenario, chunks, make_job
from orchestrator.studies.sweep.repeat import repeat_row
from orchestrator.studies.sweep.study.cases import LabelledScenario, design_of, with_samples
from orchestrator.studies.sweep.study.read_study import read_study
from orchestrator.studies.sweep.study.study import DerivedParameter, Study
from orchestrator.studies.sweep.sweep import Options, sweep
from orchestrator.studies.sweep.table import Table

CONTENT = {"name": "cases", "title": "", "description": "", "map": None}
compiles = pytest.mark.skipif(not can_compile(), reason="needs a C compiler")


def guo(speed: float, stop: float = 4.0, **changes: object) -> Scenario:
    sets = [f"vehicle.driver.profile[1].speed={speed}", f"stop_time={stop}"]
    return load_scenario("guo2015-case4", sets).model_copy(update=changes)


def cases() -> list[LabelledScenario]:
    moved = guo(1.0, target=Target(x=-7.0, y=-3.0, heading=0.1))
    return [
        LabelledScenario({"who": "slow", "number": 1}, guo(0.5)),
        LabelledScenario({"who": "long", "number": 2}, guo(0.5, stop=5.0)),
        LabelledScenario({"who": "moved", "number": 3}, moved),
    ]


def test_slots_of_different_layouts_differ_in_numbers() -> None:
    layouts = ("apa-parallel", "apa-parallel-left")
    scenarios = [load_scenario(name) for name in layouts]
    assert scenarios[0].slot_layout != scenarios[1].slot_layout, "the layouts were to differ"
    shared, design = design_of([LabelledScenario({"scenario": name}, load_scenario(name)) for name in layouts])
    assert shared.slot_layout is None
    assert len(design.seeds) == 2


def test_what_differs_is_a_column_and_nothing_else() -> None:
    shared, design = design_of(cases())
    keys = [field.key for field in design.fields]
    assert keys == ["vehicle.driver.profile[1].speed", "target.x", "target.y", "target.heading", "stop_time"]
    assert design.values[:, 0].tolist() == [0.5, 0.5, 1.0]
    assert design.labels["who"].tolist() == ["slow", "long", "moved"]
    assert design.seeds.tolist() == [1, 1, 1]
    job = make_job(Study(shared, design, CONTENT))
    (chunk,) = chunks(design, 10)
    for number, case in enumerate(cases()):
        again, given = chunk_scenario(job, chunk, number), case.scenario
        assert (again.vehicle, again.target, again.stop_ns) == (
            {**again.vehicle, **given.vehicle},
            given.target,
            given.stop_ns,
        )


def test_scenarios_that_differ_in_more_than_numbers_are_refused() -> None:
    other = guo(0.5, requirements=[Requirement(id="x", signal="duration", max=1.0, source="test")])
    with pytest.raises(ValueError, match="not in requirements"):
        design_of([*cases(), LabelledScenario({"who": "x", "number": 4}, other)])
    with pytest.raises(ValueError, match="not in target"):
        design_of([*cases(), LabelledScenario({"who": "x", "number": 4}, guo(0.5, target=None))])


def test_a_part_of_a_design_and_every_run_with_every_sample() -> None:
    shared, design = design_of(cases())
    part = design.part(1, 2)
    assert part.labels["who"].tolist() == ["long"]
    assert part.values.tolist() == design.values[1:2].tolist()
    assert part.digest() != design.digest()
    error = find_field("vehicle.driver.speed_error", shared)
    crossed = with_samples(design, {error: np.array([0.1, 0.2])})
    assert crossed.labels["who"].tolist() == ["slow", "slow", "long", "long", "moved", "moved"]
    assert crossed.values[:, -1].tolist() == [0.1, 0.2] * 3
    assert crossed.values[2:4, :-1].tolist() == [design.values[1].tolist()] * 2


def study() -> Study:
    shared, design = design_of(cases())
    slow = Requirement(id="slow", signal="vehicle.speed", max_abs=0.7, source="test")
    tracking = Instants("controller.phase", (2,))
    return Study(
        shared,
        design,
        CONTENT,
        measures={"first speed": Measure("first", "vehicle.speed", tracking)},
        within={"slow": [slow], "guo": [*library_requirements("guo2015", "final heading")]},
        derived=DerivedParameter(
            {"twice": Metric("s", "twice the time")}, lambda columns: {"twice": 2.0 * columns["duration"]}
        ),
    )


@compiles
def test_measures_sets_of_limits_and_derived_numbers_are_columns() -> None:
    found = columns_in_memory(study())
    assert list(found) == [column.name for column in columns_of(study(), make_job(study()))]
    assert found[WITHIN.format("slow")].tolist() == [True, True, False]
    assert found["twice"].tolist() == (2.0 * found["duration"]).tolist()
    assert found["number"].tolist() == [1, 2, 3]
    assert np.isfinite(found["first speed"]).all()
    whole = np.abs(found["final.heading_error"]) <= np.radians(1.0)
    assert found[WITHIN.format("guo")].tolist() == whole.tolist()


@compiles
def test_rows_of_such_a_study_come_back(tmp_path: Path) -> None:
    swept = sweep(study(), tmp_path, Options())
    assert swept.table is not None
    table = Table(swept.table)
    assert table.labels == ["who", "number"]
    assert table.column("who").tolist() == ["slow", "long", "moved"]
    for number in range(3):
        again = repeat_row(table, number, tmp_path / "row", "none", pages=False)
        assert again.different == []


def test_a_set_of_limits_that_takes_the_whole_run_is_refused() -> None:
    window = Window.model_validate({"from": 2.0})
    late = Requirement(id="late", signal="vehicle.speed", max=1.0, window=window, source="test")
    with pytest.raises(BadInput, match="within: late: takes the whole run"):
        make_job(study()._replace(within={"late": [late]}))
    with pytest.raises(BadInput, match=r"vehicle\.sped: no signal of this name; did you mean vehicle\.speed"):
        make_job(study()._replace(measures={"x": Measure("last", "vehicle.sped")}))


@compiles
def test_a_file_may_ask_for_further_columns(tmp_path: Path) -> None:
    (tmp_path / "s.yaml").write_text(
        "scenario: guo2015-case4\nset: {stop_time: 3}\nruns: {grid: {vehicle.body: [0, 1]}}\n"
        "measures: {fastest: {largest: vehicle.speed}}\n"
        "within: {project: [project], mine: [{id: a, signal: duration, max: 1, source: me}]}\n"
    )
    found = columns_in_memory(read_study(str(tmp_path / "s.yaml"), {"seed": "7", "vehicle.start.x": "1 cm"}))
    assert np.abs(found["fastest"]).tolist() == found["max_speed"].tolist()
    assert found[WITHIN.format("mine")].tolist() == [False, False]
    both = "scenario: guo2015-case4\nruns: {}\nmeasures: {x: {last: vehicle.speed, first: a}}\n"
    (tmp_path / "s.yaml").write_text(both)
    with pytest.raises(BadInput, match="expected exactly one of last, first, largest"):
        read_study(str(tmp_path / "s.yaml"), {})
