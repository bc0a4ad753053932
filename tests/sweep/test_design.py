import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestrator.inputs.text.errors import BadInput
from orchestrator.studies.sweep.study.read_study import read_study
from orchestrator.studies.sweep.study.study_file import StudyFile

SPEED = "vehicle.driver.profile[1].speed"


def design(bind: Any, **runs: Any) -> Any:
    return bind(runs=runs)[1]


def column(made: Any, key: Any) -> Any:
    return made.values[:, [field.key for field in made.fields].index(key)]


def test_a_grid_is_every_combination_once(bind: Any) -> None:
    made = design(bind, grid={"controller.system": ["ntbpt", "ntbptcwpt"], SPEED: {"from": 1, "to": 2, "steps": 3}})
    assert sorted(map(tuple, made.values.tolist())) == [(s, v) for s in (0.0, 1.0) for v in (1.0, 1.5, 2.0)]


def test_units_and_states_are_read_as_in_a_scenario(bind: Any) -> None:
    made = design(
        bind, grid={SPEED: ["3.6 km/h"], "vehicle.start.heading": ["180 deg"], "controller.system": ["ntbpt"]}
    )
    assert made.values.tolist() == [[1.0, math.pi, 1.0]]


def test_keys_with_a_comma_share_their_values(bind: Any) -> None:
    made = design(bind, grid={"car.steering.rate_limit": [1.0, 2.0]})
    assert made.values.tolist() == [[1.0, 1.0], [2.0, 2.0]]


def test_every_grid_point_has_the_same_samples(bind: Any) -> None:
    sampled = {"n": 7, "vehicle.start.x": {"uniform": [-1, 1]}}
    made = design(bind, grid={SPEED: [1.0, 2.0]}, monte_carlo=sampled)
    x = column(made, "vehicle.start.x").reshape(2, 7)
    assert (x[0] == x[1]).all()
    assert len(set(x[0])) == 7
    assert len(set(made.seeds.tolist())) == 14


def test_latin_hypercube_has_one_sample_in_each_stratum(bind: Any) -> None:
    made = design(bind, latin_hypercube={"n": 50, "vehicle.start.x": {"uniform": [-1, 1]}})
    strata = np.floor((column(made, "vehicle.start.x") + 1.0) / 2.0 * 50)
    assert sorted(strata) == list(range(50))


def test_normal_samples_have_their_mean_and_deviation(bind: Any) -> None:
    made = design(bind, latin_hypercube={"n": 2000, "vehicle.start.x": {"normal": [3.0, 0.5]}})
    x = column(made, "vehicle.start.x")
    assert abs(x.mean() - 3.0) < 0.01
    assert abs(x.std() - 0.5) < 0.01


def test_normal_samples_stay_in_the_range_of_the_parameter(bind: Any) -> None:
    made = design(bind, monte_carlo={"n": 2000, "vehicle.driver.reaction_delay": {"normal": [0.1, 0.3]}})
    delay = column(made, "vehicle.driver.reaction_delay")
    assert delay.min() >= 0.0
    assert (delay < 0.05).any()


def test_choices_are_about_equally_frequent(bind: Any) -> None:
    made = design(
        bind, latin_hypercube={"n": 300, "vehicle.driver.complies_with_stop": {"choice": [True, False, True]}}
    )
    assert column(made, "vehicle.driver.complies_with_stop").sum() == 200


def test_both_kinds_of_samples_are_joined_side_by_side(bind: Any) -> None:
    made = design(
        bind,
        monte_carlo={"n": 5, "vehicle.start.x": {"uniform": [0, 1]}},
        latin_hypercube={"n": 5, "vehicle.start.y": {"uniform": [0, 1]}},
    )
    assert made.values.shape == (5, 2)


def test_the_same_study_gives_the_same_design_and_another_seed_another(bind: Any) -> None:
    assert bind()[1].digest() == bind()[1].digest()
    assert bind(seed=2)[1].digest() != bind()[1].digest()


def test_scenario_fields_and_faults_can_be_varied(bind: Any) -> None:
    fault = {"signal": "vehicle.odometry", "kind": "stuck_at_last", "start": 1.0}
    scenario, made, job, chunk = bind(
        scenario="fault-pose-frozen",
        runs={"grid": {"faults[1].start": [2.0], "stop_time": ["12 s"], "decimation.vehicle": [2]}},
    )
    assert fault["kind"] == scenario.faults[0].kind
    from orchestrator.studies.sweep.job import chunk_scenario

    one = chunk_scenario(job, chunk, 0)
    assert (one.faults[0].start, one.stop_time, one.decimation) == (2.0, 12.0, {"vehicle": 2})
    assert made.values.tolist() == [[2.0, 12.0, 2.0]]


@pytest.mark.parametrize(
    ("runs", "says"),
    [
        ({"grid": {"vehicle.car.weelbase": [2.0]}}, "wheelbase"),
        ({"grid": {"vehicle.car.wheelbase": [-1.0]}}, "out of range"),
        ({"grid": {"vehicle.car.wheelbase": ["3 s"]}}, "'3 s' is in 's'"),
        ({"grid": {"vehicle.car.wheelbase": []}}, "empty list"),
        ({"grid": {"vehicle.start.x": [1]}, "monte_carlo": {"n": 1, "vehicle.start.x": {"uniform": [0, 1]}}}, "twice"),
        ({"monte_carlo": {"n": 3, "vehicle.car.wheelbase": {"uniform": [-3, 3]}}}, "out of range"),
        ({"monte_carlo": {"n": 3, "vehicle.start.x": {"uniform": [3, -3]}}}, "lower end first"),
        ({"monte_carlo": {"n": 3, "vehicle.start.x": {"normal": [3, 0]}}}, "more than 0"),
        ({"monte_carlo": {"n": 3, "vehicle.driver.complies_with_stop": {"uniform": [0, 1]}}}, "expected choice"),
        ({"grid": {"faults[1].start": [1.0]}}, "has 0 faults"),
        ({"grid": {"speed": [1.0]}}, "unknown"),
    ],
)
def test_a_mistake_is_one_clear_sentence(bind: Any, runs: Any, says: str) -> None:
    with pytest.raises(BadInput, match=says.replace("[", r"\[")):
        bind(runs=runs)


GRID, SAMPLES = "runs: {grid: {", "runs: {monte_carlo: {n: 3, "


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (f"{GRID}stop_time: {{from: 1, to: 2, steps: 0}}}}}}", r":3: runs\.grid\.stop_time\.steps: 0: input"),
        (
            f"{GRID}stop_time: {{from: 1, to: 2, steps: 1}}}}}}",
            r":3: runs\.grid\.stop_time: steps: 1 value is not both",
        ),
        (f"{GRID}stop_time: {{from: 1, to: 2, stpes: 9}}}}}}", r"runs\.grid\.stop_time\.stpes: unknown; .* steps\?"),
        (f"{GRID}stop_time: 3}}}}", r":3: runs\.grid\.stop_time: 3: input should be a valid list"),
        (f"{GRID}stop_time: [3 kg]}}}}", r":3: stop_time: '3 kg' is in 'kg'"),
        (
            f"{SAMPLES}vehicle.start.x: {{unifrom: [0, 1]}}}}}}",
            r":3: .*vehicle\.start\.x\.unifrom: unknown; .* uniform\?",
        ),
        (f"{SAMPLES}vehicle.start.x: {{uniform: [1, 0]}}}}}}", r":3: vehicle\.start\.x: uniform from 1 to 0"),
        (f"{SAMPLES}vehicle.start.x: {{choice: []}}}}}}", r":3: .*choice: \[\]: list should have at least 1 item, not"),
        ("runs: {}\nset: {seed: -1}", r"s\.yaml:4: seed: -1: input"),
        ("runs: {}\nwithin: {own: [projekt]}", r"s\.yaml:4: within\.own: projekt: no set of requirements"),
    ],
)
def test_a_mistake_in_a_file_is_told_with_its_file_line_and_key(tmp_path: Path, text: str, says: str) -> None:
    file = tmp_path / "s.yaml"
    file.write_text(f"name: s\nscenario: guo2015-case4\n{text}\n")
    with pytest.raises(BadInput, match=says):
        read_study(str(file), {})


def test_the_study_that_names_no_scenario_is_named(tmp_path: Path) -> None:
    file = tmp_path / "s.yaml"
    for name, why in {"nowhere.yaml": "no such file", "guo2015-case44": "no scenario of this name"}.items():
        file.write_text(f"scenario: {name}\nruns: {{}}\n")
        with pytest.raises(BadInput, match=f"s.yaml:1: scenario: {name}: {why}"):
            read_study(str(file), {})


def test_different_numbers_of_samples_are_refused() -> None:
    samples = [{"n": count, "vehicle.start.x": {"uniform": [0, 1]}} for count in (2, 3)]
    runs: Any = {"monte_carlo": samples[0], "latin_hypercube": samples[1]}
    with pytest.raises(ValueError, match="same n"):
        StudyFile(name="a", scenario="b", runs=runs)


def test_a_spread_has_exactly_one_distribution() -> None:
    runs: Any = {"monte_carlo": {"n": 1, "x": {"uniform": [0, 1], "choice": [1]}}}
    with pytest.raises(ValueError, match="exactly one of uniform, normal, choice"):
        StudyFile(name="a", scenario="b", runs=runs)


def test_samples_without_their_number_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "study.yaml"
    file.write_text("name: s\nscenario: guo2015-case4\nruns: {latin_hypercube: {stop_time: {uniform: [8, 9]}}}\n")
    with pytest.raises(BadInput, match=r"latin_hypercube\.n: is missing"):
        read_study(str(file), {})
