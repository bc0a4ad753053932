"""What counts as parked: the controller reports it, the car stands in the slot within the limits; one judge for all."""

import json
import math
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from controller_fmu.guo2015.phases import GuoPhase
from controller_fmu.registry import ControllerOutput
from modelkit.signal import Signal
from modelkit.variables import Variable, variables
from orchestrator.evaluation.verdict.geometry import CarOutline, place, slot_box
from orchestrator.evaluation.verdict.logged_scenario import read_logged_scenario
from orchestrator.evaluation.verdict.numbers import NUMBERS
from orchestrator.evaluation.verdict.outcome import state_name
from orchestrator.evaluation.verdict.standing import outline_margin
from orchestrator.evaluation.verdict.summary import Final, Summary, summarize
from orchestrator.evaluation.verdict.truth import join_truths, truth_of
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.recording import Recording
from orchestrator.studies.sweep.rows import measures_for, row_of
from orchestrator.studies.sweep.verdict import OUTCOMES, judge_rows

CASE_4 = load_scenario("guo2015-case4")
SLOT_ONLY = load_scenario("guo2015-case4", ["requirements=[]"])
Q3 = (-7.608, -3.056, 0.0)
PLANT = {item.name: float(item.start) for item in variables(MODELS["vehicle"].params)}
KNOWN = {f"controller.{item.name}": item for item in variables(ControllerOutput)} | {
    f"vehicle.{item.name}": item for item in variables(MODELS["vehicle"].outputs)
}


def standing(
    pose: tuple[float, float, float] = Q3,
    phase: float = GuoPhase.PARKED,
    speed: float = 0.0,
    scenario: Scenario = CASE_4,
    **more: float,
) -> Recording:
    """Return a recording of one instant: what every verdict on the end looks at."""
    x, y, heading = pose
    end = {"vehicle.pose.x": x, "vehicle.pose.y": y, "vehicle.pose.heading": heading, "vehicle.speed": speed}
    end |= {
        "controller.phase": float(phase),
        "controller.reason": 0.0,
        "controller.manoeuvres": 1.0,
        "vehicle.clearance": 1.0,
    }
    end |= more
    signals = {name: np.array([end.get(name, 0.0)]) for name in KNOWN}
    parameters = {f"vehicle.{name}": float(value) for name, value in {**PLANT, **scenario.vehicle}.items()}
    info: dict[str, Any] = {
        "scenario": scenario.model_dump(mode="json", exclude={"file"}),
        "end": {"reason": "standstill"},
    }
    info |= {"fmus": [{"name": "vehicle", "kind": "none", "guid": "of a test"}]}
    return Recording(np.zeros(1, dtype=np.int64), signals, parameters, dict(KNOWN), info)


def verdict(scenario: Scenario = CASE_4, **given: Any) -> Summary:
    return summarize(standing(scenario=scenario, **given), scenario, 1.0)


def why(found: Summary) -> tuple[str, str]:
    return found.outcome, found.reason


def test_a_car_at_its_target_is_parked() -> None:
    assert why(verdict()) == ("parked", "all checks passed")


def test_half_out_of_the_slot_is_not_parked_whatever_the_controller_says() -> None:
    """The nose of guo2015-case3 stood out of the slot, and the summary said: all checks passed."""
    outcome, reason = why(verdict(SLOT_ONLY, pose=(Q3[0] + 4.5, Q3[1], 0.0)))
    assert (outcome, reason) == ("not_parked", "beyond its limit: outline in the slot")
    assert verdict(SLOT_ONLY).outcome == "parked"


def test_far_along_in_a_long_slot_is_not_parked_where_the_controller_was_told_a_target() -> None:
    long = load_scenario("guo2015-case4", ["slot.length=30"])
    assert verdict(long, pose=(Q3[0] + 0.45, Q3[1], 0.0)).outcome == "parked"
    outcome, reason = why(verdict(long, pose=(Q3[0] + 1.5, Q3[1], 0.0)))
    assert (outcome, reason) == ("not_parked", "beyond its limit: final longitudinal position")


def test_a_car_that_still_moves_is_not_parked() -> None:
    assert why(verdict(speed=-0.25)) == ("not_parked", "the car still moves: -0.25 m/s")


def test_what_was_not_measured_is_not_met() -> None:
    blind = standing()
    for name in ("vehicle.speed", "vehicle.pose.x", "vehicle.pose.heading"):
        del cast("dict[str, Any]", blind.signals)[name]
    limits = [limit for limit in CASE_4.requirements if limit.signal != "vehicle.speed"]
    found = summarize(blind, CASE_4.model_copy(update={"requirements": limits}), 1.0)
    assert found.outcome == "not_parked"
    assert found.reason.startswith("not measured: the car's speed, final heading, final lateral position")
    assert {check.note for check in found.checks if check.signal.endswith("_error")} == {"not measured"}


def test_a_controller_that_says_nothing_has_not_parked() -> None:
    silent = standing()
    del cast("dict[str, Any]", silent.signals)["controller.phase"]
    found = summarize(silent, CASE_4, 1.0)
    assert why(found) == ("not_parked", "the controller has no output phase, of which PARKED (9) says that it is done")


def test_a_phase_without_names_means_ours() -> None:
    plain = standing()
    plain.variables["controller.phase"] = Variable("phase", int, Signal("1", "how far it is"), 0)
    assert summarize(plain, CASE_4, 1.0).outcome == "parked"


def test_the_scenario_says_what_ends_a_run_and_what_done_means() -> None:
    ending = {"signal": "vehicle.gear", "succeeded": ["PARK"], "failed": [], "ended": ["NEUTRAL"], "standstill": "1 s"}
    scenario = load_scenario("guo2015-case4", [f"stop_condition={json.dumps(ending)}"])
    assert verdict(scenario, phase=GuoPhase.TO_Q2, **{"vehicle.gear": 0.0}).outcome == "parked"
    assert why(verdict(scenario, phase=GuoPhase.TO_Q2, **{"vehicle.gear": 2.0})) == ("not_parked", "neutral")
    assert why(verdict(scenario, **{"vehicle.gear": 1.0})) == ("not_parked", "stop time reached in reverse")


def test_an_ending_of_its_own_ends_the_run() -> None:
    early = load_scenario(
        "guo2015-case4", ["stop_condition={succeeded: [PARKED], ended: [PRE_STEER], standstill: 0.1 s}"]
    )
    ran = run_scenario(early)
    assert ran.end.reason == "standstill"
    assert (
        state_name(ran.recording.states("controller.phase"), ran.recording.signals["controller.phase"][-1])
        == "PRE_STEER"
    )
    with pytest.raises(
        BadInput, match=r"stop_condition: 'PARKD' is no state of controller\.phase; did you mean PARKED"
    ):
        run_scenario(load_scenario("guo2015-case4", ["stop_condition={succeeded: [PARKD]}"]))


def test_a_road_is_finished_not_parked() -> None:
    road = load_scenario("preview", ["requirements=[]"])
    assert (road.task, road.expected_outcome, road.target) == ("drive", "finished", None)
    assert why(verdict(road)) == ("finished", "all checks passed")
    assert why(verdict(road, phase=GuoPhase.PATH_TRACKING)) == ("not_finished", "stop time reached in path_tracking")
    assert math.isnan(verdict(road).final.lateral_error)
    with pytest.raises(BadInput, match="expected_outcome: 'parked' is no outcome of task drive, expected finished"):
        load_scenario("preview", ["expected_outcome=parked"])


def test_a_controller_told_another_target_is_judged_by_the_true_one() -> None:
    scenario = load_scenario("guo2015-case4", ["controller.target.y=-3.2"])
    assert (scenario.controller["target.x"], scenario.controller["target.y"]) == (-7.608, -3.2)
    found = standing((Q3[0], -3.2, 0.0), scenario=scenario)
    found.parameters |= {"controller.target.x": -7.608, "controller.target.y": -3.2, "controller.target.heading": 0.0}
    summary = summarize(found, scenario, 1.0)
    assert why(summary) == ("not_parked", "beyond its limit: final lateral position")
    assert "another target, +0.000 m along and -0.144 m across" in summary.notes[0]
    assert verdict().notes == []


def test_a_log_of_another_tool_has_no_target(capsys: pytest.CaptureFixture[str]) -> None:
    old = standing((1.0, 2.0, 0.5))
    del old.info["scenario"]["target"]
    for recording in (old, Recording(old.t_ns, old.signals, {}, old.variables, {})):
        scenario = read_logged_scenario(recording, "theirs.mcap")
        assert capsys.readouterr().err.startswith("apa: warning: theirs.mcap: no target is in this log")
        assert scenario.target is None
        assert math.isnan(summarize(recording, scenario, 1.0).final.lateral_error)
        read_logged_scenario(recording)
        assert capsys.readouterr().err == "", "a page says nothing of it"


KERB = ["slot={x: 0, y: 0, length: 7, width: 2.4}", "target={x: -1.2, y: 0}", "requirements=[gbt41630]"]


@pytest.mark.parametrize(
    ("kerb", "turn", "missed"),
    [
        (-0.825 - 0.2, 0.0, ""),
        (-0.825 - 0.04, 0.0, "nearest tyre to the kerb"),
        (-0.825 - 0.36, 0.0, "farthest tyre to the kerb"),
        (-0.825 - 0.3, 0.03, "farthest tyre to the kerb"),
        (-4.0, 0.0, ""),
    ],
)
def test_tyres_stand_5_to_35_cm_from_the_slots_kerb(kerb: float, turn: float, missed: str) -> None:
    scenario = load_scenario("guo2015-case4", [*KERB, f"scene.kerbs=[[-9, {kerb}, 9, {kerb}, 0.1]]"])
    found = verdict(scenario, pose=(-1.2, 0.0, turn))
    assert why(found) == (("not_parked", f"beyond its limit: {missed}") if missed else ("parked", "all checks passed"))
    if kerb > -2.0:
        assert found.final.kerb_nearest == pytest.approx(-0.825 * math.cos(turn) - kerb)
        assert found.final.kerb_farthest - found.final.kerb_nearest == pytest.approx(2.405 * math.sin(turn))


def test_no_kerb_no_kerb_rule_and_one_across_the_slot_is_none() -> None:
    across = load_scenario("guo2015-case4", [*KERB, "scene.kerbs=[[-3, -5, -3, 5, 0.1]]"])
    for scenario in (load_scenario("guo2015-case4", KERB), across):
        found = verdict(scenario, pose=(-1.2, 0.0, 0.0))
        assert [check.id for check in found.checks if "kerb" in check.id] == []
        assert math.isnan(found.final.kerb_nearest)


@given(
    pose=st.tuples(st.floats(-9, 9), st.floats(-9, 9), st.floats(-7, 7)),
    slot=st.tuples(st.floats(-9, 9), st.floats(-9, 9), st.floats(-7, 7), st.floats(0.5, 30), st.floats(0.5, 30)),
)
def test_the_margin_is_the_outlines_distance_to_the_slots_edges(
    pose: tuple[float, ...], slot: tuple[float, ...]
) -> None:
    car = CarOutline(3.2, 0.6, 0.85, 2.4)
    found = float(outline_margin(np.array([pose]), np.array([slot]), np.array([car]))[0])
    sides: Any = dict(zip(("x", "y", "heading", "length", "width"), slot, strict=True))
    scenario = Scenario(name="a", slot=sides)
    assert scenario.slot is not None
    box = shapely.Polygon(slot_box(scenario.slot).outline())
    outline = shapely.Polygon(place(car.outline(), *pose))
    assert (found >= 0.0) == box.buffer(1e-9).contains(outline) or abs(found) < 1e-6
    if found > 1e-6:
        assert found == pytest.approx(box.exterior.distance(outline), abs=1e-6)


@pytest.mark.parametrize("odd", [math.nan, math.inf, -math.inf, 1e300])
def test_a_car_that_is_nowhere_is_not_parked(odd: float) -> None:
    for pose in ((odd, 0.0, 0.0), (0.0, odd, 0.0), (0.0, 0.0, odd)):
        assert verdict(pose=pose).outcome == "not_parked"


def test_one_run_and_a_table_are_judged_alike_to_the_last_bit() -> None:
    rng = np.random.default_rng(4)
    scenarios, recordings = [], []
    for _ in range(200):
        sets = [f"slot.heading={rng.normal(0, 0.1)}", f"target.y={rng.normal(-3.056, 0.1)}"]
        kerb = rng.normal(-4.2, 0.1)
        sets += [f"scene.kerbs=[[-19, {kerb}, 9, {kerb}, 0.1]]"] if rng.random() < 0.5 else []
        scenario = load_scenario("guo2015-case4", sets)
        pose = tuple(np.array(Q3) + rng.normal(0.0, (0.4, 0.06, 0.02)))
        phase = rng.choice([*[GuoPhase.PARKED] * 3, GuoPhase.FAILED, GuoPhase.TAKEOVER, GuoPhase.STOP])
        scenarios.append(scenario)
        recordings.append(standing(pose, phase, float(rng.choice([0.0, 0.0, 0.0, 0.1])), scenario))
    kept = measures_for(scenarios[0])
    rows = np.array([row_of(run, scenario, kept) for run, scenario in zip(recordings, scenarios, strict=True)])
    truth = join_truths([truth_of(scenario, {**PLANT, **scenario.vehicle}) for scenario in scenarios])
    table = judge_rows(scenarios[0], truth, kept, rows)
    for number, (run, scenario) in enumerate(zip(recordings, scenarios, strict=True)):
        alone = summarize(run, scenario, 1.0)
        assert (OUTCOMES[table.outcome[number]], table.reason[number]) == why(alone)
        for name, value in alone.final.model_dump().items():
            assert table.numbers[f"final.{name}"][number].tobytes() == np.float64(value).tobytes(), name
    assert len(set(table.reason)) > 12
    assert {OUTCOMES[code] for code in table.outcome} == {"parked", "not_parked", "failed"}


def test_the_summary_tells_every_number_there_is() -> None:
    assert {f"final.{name}" for name in Final.model_fields} == {name for name in NUMBERS if name.startswith("final.")}


def test_a_scenario_without_a_target_asks_for_one_before_it_tells_it(tmp_path: Path) -> None:
    file = tmp_path / "old.yaml"
    file.write_text("controller: {target: {x: -7.6, y: -3}}\n", encoding="utf-8")
    with pytest.raises(BadInput, match=r"controller\.target: the scenario has no target; write target: \{x: \.\., y"):
        load_scenario(str(file))
    file.write_text("target: {x: -7.6, y: -300 cm, heading: 1 deg}\n", encoding="utf-8")
    scenario = load_scenario(str(file))
    assert scenario.controller["target.heading"] == pytest.approx(math.radians(1.0))
    file.write_text("target: {x: -7.6, z: 1}\n", encoding="utf-8")
    with pytest.raises(BadInput, match=r"old\.yaml(:\d+)?: target\.z: unknown; expected one of: x, y, heading"):
        load_scenario(str(file))


def test_the_scene_is_the_scenarios_and_the_vehicle_has_a_copy(tmp_path: Path) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text("scene: {boxes: [{x: 1, y: 2, length: 4 m, width: 180 cm}], kerbs: [[0, 1, 2, 3, 10 cm]]}\n")
    scenario = load_scenario(str(file), ["scene.boxes[2].length=3"])
    assert scenario.vehicle["scene.boxes[1].width"] == pytest.approx(1.8)
    assert scenario.vehicle["scene.kerbs[1].height"] == pytest.approx(0.1)
    assert scenario.vehicle["scene.boxes[2].length"] == 3.0
    file.write_text("scene: {boxes: [{x: 1, colour: red}]}\n")
    with pytest.raises(BadInput, match=r"scene\.boxes\[1\]\.colour: unknown"):
        load_scenario(str(file))
