"""Contact with the scene is never parked or finished, whatever the requirements; penetration depth is a metric."""

import json
import math
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
import shapely
from shapely import affinity

from apa_cosim import judge, read_log, run
from modelkit.car import Car
from modelkit.geometry import Box, orient, overlap_depth
from modelkit.vocabulary import Pose
from orchestrator.cli import main
from orchestrator.evaluation.verdict.contact import clearance_parts
from orchestrator.evaluation.verdict.geometry import CarOutline
from orchestrator.evaluation.verdict.polygons import polygon_clearances
from orchestrator.evaluation.verdict.standing import beyond_ends, outline_margin
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.requirements import REQUIREMENT_SETS
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.simulation.cosim.recording import Recording
from orchestrator.testing.steptest.run import run_step_test
from orchestrator.testing.steptest.step_test import load_step_test
from orchestrator.testing.suite.junit import cases_of
from tests.native_runs import drive_natively
from vehicle_fmu.scene import Kerb, Obstacle, SceneParams, clearance

BOX = "{x: -4, y: -1.5, length: 1, width: 1}"
LOW_BOX = "{x: -4, y: -1.5, length: 1, width: 1, height: 0.1}"
STRIP = "{x: -4, y: -1.5, length: 1, width: 1, appear_at: 2, disappear_at: 12}"
MOVING = "{x: -4, y: 20, length: 1, width: 1, speed_y: -2, moves_at: 0, halts_at: 10.75}"
KERB = "{x1: -4, y1: -3, x2: -4, y2: 3, height: 0.1}"
LOW_KERB = "{x1: -4, y1: -3, x2: -4, y2: 3, height: 0.05}"
SQUARE = "[[-4.5, -2], [-3.5, -2], [-3.5, -1], [-4.5, -1]]"
SETS = sorted(path.stem for path in REQUIREMENT_SETS.glob("*.yaml"))


def through(*more: str, things: str = f"scene.boxes=[{BOX}]") -> Scenario:
    return load_scenario("guo2015-case4", [things, *more])


def driven(scenario: Scenario) -> Any:
    ran = drive_natively(scenario)
    return ran.recording, summarize(ran.recording, scenario, ran.wall_time)


@pytest.fixture(scope="module")
def through_box() -> Any:
    return driven(through("requirements=[]"))


@pytest.mark.parametrize("name", SETS)
def test_no_set_of_requirements_calls_a_run_in_contact_parked(through_box: Any, name: str) -> None:
    recording, _ = through_box
    scenario = through(f"requirements=[{name}]")
    summary = summarize(recording, scenario, 0.0)
    assert summary.outcome == "not_parked"
    assert summary.reason.split("; ")[0] == "contact"
    assert any(case.name.startswith("free of contact") and not case.passed for case in cases_of(summary.checks))


@pytest.mark.parametrize(
    "things",
    [
        f"scene.boxes=[{BOX}]",
        f"scene.boxes=[{STRIP}]",
        f"scene.boxes=[{MOVING}]",
        f"scene.kerbs=[{KERB}]",
        f"obstacles=[{SQUARE}]",
    ],
)
def test_anything_of_the_scene_is_contact(things: str) -> None:
    _, summary = driven(through("requirements=[]", things=things))
    assert (summary.outcome, summary.reason) == ("not_parked", "contact")
    assert summary.penetration > 0.01
    assert summary.notes[0].startswith("contact from ")


def test_a_wheel_at_a_low_kerb_is_reported() -> None:
    _, summary = driven(through("requirements=[]", things=f"scene.kerbs=[{LOW_KERB}]"))
    assert (summary.outcome, summary.penetration) == ("parked", 0.0)
    assert "kerb or box lower than" in summary.notes[0]


def test_a_requirement_of_the_same_name_or_metric_does_not_take_its_place() -> None:
    lax = "{id: free of contact, signal: penetration, max: 9 m, source: me}"
    other = "{id: deep, signal: penetration, max: 9 m, source: me}"
    _, summary = driven(through(f"requirements=[{lax}, {other}]"))
    assert summary.reason == "contact"


def test_only_the_key_allows_it_and_the_table_shows_that(tmp_path: Path, capsys: Any) -> None:
    words = ["--fmus", "native", "--no-page", "--set", f"scene.boxes=[{BOX}]"]
    words += ["--set", "requirements=[project]"]
    assert main(["run", "guo2015-case4", *words, "--out", str(tmp_path / "a")]) == 1
    capsys.readouterr()
    assert main(["run", "guo2015-case4", *words, "--out", str(tmp_path / "b"), "--set", "contact_allowed=true"]) == 0
    reported = " ".join(capsys.readouterr().out.split())
    assert "in contact, which the scenario allows (contact_allowed)" in reported
    assert "allowed: contact_allowed of the scenario" in reported


def test_check_test_and_judge_miss_it(tmp_path: Path, capsys: Any) -> None:
    words = ["--fmus", "native", "--set", f"scene.boxes=[{BOX}]"]
    assert main(["test", "guo2015-case4", *words, "--out", str(tmp_path / "t"), "--set", "requirements=[]"]) == 1
    assert (
        main(["test", "guo2015-case4", *words, "--out", str(tmp_path / "u"), "--set", "expected_outcome=not_parked"])
        == 1
    )
    log = tmp_path / "t" / "guo2015-case4" / "run.mcap"
    capsys.readouterr()
    assert main(["check", str(log), "gbt41630", "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert [check["id"] for check in found["checks"] if not check["passed"]] == ["free of contact"]
    assert [check.id for check in judge(read_log(log), "gbt41630") if not check.passed] == ["free of contact"]
    assert "contact" in repr(read_log(log))
    assert run("guo2015-case4", {"requirements": "[]", "scene.boxes": f"[{BOX}]"}, fmus="none").outcome == "not_parked"


def test_a_step_test_of_the_vehicle_misses_it(tmp_path: Path) -> None:
    head = "model: vehicle\nstop_time: 5 s\nparameters: {scene: {boxes: [{x: 6, y: 0, length: 1, width: 1}]}}\n"
    head += "inputs: {speed_control_active: true, speed_request: 2}\n"
    head += "expect: [{id: a, signal: speed, eventually: {min: 0.9}}]\n"
    path = tmp_path / "drives.yaml"
    path.write_text(head)
    for kind in ("none", "native"):
        checks = run_step_test(load_step_test(path), kind)[1]
        assert [check.id for check in checks if check.required and not check.passed] == ["free of contact"]
    path.write_text(f"{head}contact_allowed: true\n")
    checks = run_step_test(load_step_test(path), "none")[1]
    assert not [check.id for check in checks if check.required and not check.passed]


def without(recording: Recording, *names: str) -> Recording:
    signals = {name: values for name, values in recording.signals.items() if name not in names}
    info = {**recording.info, "fmus": [{"name": "vehicle", "kind": "foreign", "guid": "x"}]}
    return Recording(recording.t_ns, signals, recording.parameters, recording.variables, info)


def test_a_vehicle_of_others_is_judged_by_its_poses(through_box: Any) -> None:
    """One that puts out no clearance, or says that it touches nothing; one without poses is not known to be free."""
    recording, summary = through_box
    scenario = through("requirements=[]")
    blind = without(recording, "vehicle.clearance")
    assert summarize(blind, scenario, 0.0).penetration == pytest.approx(summary.penetration, abs=1e-9)
    lying = without(recording)
    cast("dict[str, Any]", lying.signals)["vehicle.clearance"] = np.full(len(recording.t), 1e9)
    assert summarize(lying, scenario, 0.0).reason == "contact"
    unknown = summarize(without(recording, "vehicle.clearance", "vehicle.pose.x"), scenario, 0.0)
    assert (unknown.outcome, unknown.reason) == (
        "not_parked",
        "not measured: outline in the slot, free of contact",
    )


def parted(a: Any, b: Any) -> float:
    """Return the shortest move that parts two convex shapes, from their Minkowski difference."""
    points = [(x - u, y - v) for x, y in a.exterior.coords for u, v in b.exterior.coords]
    return float(shapely.MultiPoint(points).convex_hull.exterior.distance(shapely.Point(0.0, 0.0)))


def box_of(box: Box) -> Any:
    shape = shapely.box(-0.5 * box.length, -0.5 * box.width, 0.5 * box.length, 0.5 * box.width)
    return affinity.translate(affinity.rotate(shape, box.heading, origin=(0, 0), use_radians=True), box.x, box.y)


def test_the_depth_of_boxes_is_that_of_their_minkowski_difference() -> None:
    draw = np.random.default_rng(4)
    deep = 0
    for _ in range(300):
        sizes = [[*draw.uniform(-2, 2, 2), draw.uniform(-4, 4), *draw.uniform(0.2, 4, 2)] for _ in range(2)]
        a, b = map(Box._make, sizes)
        if box_of(a).intersects(box_of(b)):
            deep += 1
            assert overlap_depth(orient(a), orient(b)) == pytest.approx(parted(box_of(a), box_of(b)), abs=1e-9)
        else:
            assert overlap_depth(orient(a), orient(b)) <= 0.0
    assert deep > 100


def test_the_depth_in_polygons_is_that_of_their_minkowski_difference() -> None:
    draw = np.random.default_rng(5)
    car = CarOutline(3.2, 0.6, 0.85, 2.4)
    outline = shapely.Polygon(car.outline()[:4])
    deep = 0
    for number in range(200):
        corners = shapely.MultiPoint(draw.uniform(-4, 5, (8, 2))).convex_hull.exterior.coords[:-1]
        corners = corners[:: -1 if number % 2 else 1]
        (found,) = polygon_clearances(np.zeros((1, 3)), [corners], car)
        polygon = shapely.Polygon(corners)
        if polygon.intersects(outline):
            deep += 1
            assert -found == pytest.approx(parted(outline, polygon), abs=1e-9)
        else:
            assert found == pytest.approx(polygon.distance(outline), abs=1e-9)
    assert deep > 100


def test_a_garage_of_one_polygon_is_touched_by_as_much_as_its_wall_is_entered() -> None:
    """Not convex: the car stands in a U, its rear 1 cm in the wall."""
    walls = [(-2, -3), (6, -3), (6, -2), (-0.59, -2), (-0.59, 2), (6, 2), (6, 3), (-2, 3)]
    car = CarOutline(3.2, 0.6, 0.85, 2.4)
    found = polygon_clearances(np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0]]), [walls], car)
    assert found == pytest.approx([-0.01, 0.09])


def test_what_only_touches_is_in_contact() -> None:
    scene = SceneParams(boxes=(Obstacle(3.205 + 0.5 - 1e-12, 0.0, 0.0, 1.0, 1.0), *(Obstacle(),) * 15))
    assert -1e-6 < clearance(Pose(), Car(), scene, 0.08, 0) < 0.0
    kerb = SceneParams(kerbs=(Kerb(2.5, -3.0, 2.5, 3.0, 0.07), *(Kerb(),) * 3))
    assert clearance(Pose(), Car(), kerb, 0.08, 0) == 0.0
    assert clearance(Pose(), Car(), kerb, 0.05, 0) < 0.0


def test_the_headline_says_that_the_outline_is_beyond_an_end_of_the_slot_or_far_from_the_target(capsys: Any) -> None:
    """All in line with the target, within GB/T 41630's limits, which have none along the slot."""
    scenario = load_scenario("guo2015-case4", ["requirements=[]", "slot.x=-4"])
    recording, summary = driven(scenario)
    assert summary.standing
    assert all(text in summary.headline for text in summary.standing)
    off = scenario.model_copy(update={"target": scenario.target.model_copy(update={"x": -6.5})})  # type: ignore[union-attr]
    text = summarize(recording, off, 0.0).headline
    assert "m from the target" in text
    assert not driven(load_scenario("guo2015-case4"))[1].standing


@pytest.mark.parametrize("turn", [0.0, math.pi])
def test_which_end_of_the_slot_is_passed(turn: float) -> None:
    slot, car = np.array([[0.0, 0.0, turn, 5.0, 2.0]]), np.array([[3.0, 1.0, 0.9, 2.5]])
    front, rear = beyond_ends(np.array([[-0.7, 0.0, 0.0]]), slot, car)
    ends = [float(front[0]), float(rear[0])]
    assert (ends if turn == 0.0 else ends[::-1]) == pytest.approx([-0.2, -0.8])
    front, rear = beyond_ends(np.array([[0.0, 0.0, 0.0]]), slot, car)
    assert max(front[0], rear[0]) == pytest.approx(0.5)
    assert outline_margin(np.array([[0.0, 0.0, 0.0]]), slot, car)[0] == pytest.approx(-0.5)


@pytest.mark.parametrize(
    "things",
    [f"scene.boxes=[{STRIP}, {BOX}]", f"scene.boxes=[{LOW_BOX}]", f"scene.boxes=[{MOVING}]", f"scene.kerbs=[{KERB}]"],
)
def test_clearance_by_poses_is_the_one_that_the_vehicle_puts_out(things: str) -> None:
    recording, _ = driven(through("requirements=[]", things=things))
    own = recording.signals["vehicle.clearance"]
    ((_, distances),) = clearance_parts(without(recording, "vehicle.clearance"), through(things=things))
    found = distances.scene
    assert np.abs(found - own).max() < 0.03
    near = own <= 0.0
    assert np.abs(found - own)[near].max(initial=0.0) < 1e-9
    assert (own < 0.0).any()
