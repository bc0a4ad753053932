"""One key for slot, neighbours, kerb and target: geometry, limits, and the warning where slot and scene differ."""

import math
from pathlib import Path
from typing import Any

import pytest
from shapely.geometry import Polygon
from shapely.ops import unary_union

from orchestrator.inputs.scenario.load_scenario import load_scenario, scenario_names
from orchestrator.inputs.scenario.obstacle_map import box_corners, static_obstacles
from orchestrator.inputs.scenario.plausible import implausible
from orchestrator.inputs.scenario.slot_layout import SlotLayout, scene_of
from orchestrator.inputs.text.errors import BadInput


def layout(**given: Any) -> dict[str, Any]:
    return scene_of(SlotLayout.model_validate({"kind": "parallel", "length": 6.0, "depth": 2.0, **given}))


def rectangle(box: dict[str, float]) -> Polygon:
    return Polygon(box_corners(box))


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize(
    "kind",
    [
        {"kind": "parallel"},
        {"kind": "perpendicular"},
        *({"kind": "angled", "angle": f"{a} deg"} for a in (30, 60, 120)),
    ],
)
@pytest.mark.parametrize("origin", [{}, {"x": 3.0, "y": -2.0, "heading": "40 deg"}])
def test_no_car_of_the_row_touches_another_or_the_slot(side: str, kind: dict[str, str], origin: dict[str, Any]) -> None:
    found = layout(
        side=side, **kind, length=3.0 if kind["kind"] != "parallel" else 6.0, depth=4.6, row=2, origin=origin
    )
    cars = [rectangle(box) for box in found["scene"]["boxes"]]
    assert len(cars) == 6
    assert unary_union(cars).area == pytest.approx(6 * 4.4 * 1.8)
    slot = rectangle(found["slot"])
    assert unary_union([*cars, slot]).area == pytest.approx(6 * 4.4 * 1.8 + slot.area)


@pytest.mark.parametrize("angle", [30, 45, 90, 135, 150])
def test_an_angled_slot_touches_the_road_edge_and_lies_on_its_side(angle: int) -> None:
    found = layout(kind="angled", angle=math.radians(angle), length=3.0, depth=5.0)
    corners = box_corners(found["slot"])
    assert max(y for _, y in corners) == pytest.approx(0.0, abs=1e-9)
    assert found["slot"]["width"] == pytest.approx(3.0 * math.sin(math.radians(angle)))


def test_an_angle_of_90_deg_is_perpendicular() -> None:
    given = {"length": 3.0, "depth": 5.0, "row": 1}
    angled, straight = (
        layout(**given, **kind) for kind in ({"kind": "angled", "angle": "90 deg"}, {"kind": "perpendicular"})
    )
    assert angled["slot"] == pytest.approx(straight["slot"])
    for one, other in zip(angled["scene"]["boxes"], straight["scene"]["boxes"], strict=True):
        assert rectangle(one).symmetric_difference(rectangle(other)).area < 1e-9


def test_left_is_the_mirror_image_of_right() -> None:
    right, left = (layout(kind="angled", angle="60 deg", side=side, kerb={}, row=1) for side in ("right", "left"))
    for part in ("slot", "target"):
        assert left[part]["x"] == right[part]["x"]
        assert left[part]["y"] == -right[part]["y"]
        assert left[part]["heading"] == -right[part]["heading"]
    assert left["scene"]["kerbs"][0]["y1"] == -right["scene"]["kerbs"][0]["y1"] == 2.0


def test_one_setting_moves_slot_target_neighbours_and_kerb() -> None:
    scenario = load_scenario("apa-parallel", ["slot_layout.length=5", "slot_layout.depth=2.2"])
    assert scenario.slot is not None
    assert scenario.target is not None
    assert (scenario.slot.length, scenario.slot.width, scenario.slot.x, scenario.slot.y) == (5.0, 2.2, 2.5, -1.1)
    assert scenario.vehicle["scene.boxes[2].x"] == 7.2
    assert scenario.vehicle["scene.kerbs[1].y1"] == -2.2
    before = load_scenario("apa-parallel").target
    assert before is not None
    assert scenario.target.x == pytest.approx(before.x - 0.6)
    assert implausible(scenario) == []


def test_further_boxes_stand_behind_the_generated_ones(tmp_path: Path) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text(
        "extends: apa-perpendicular\nslot_layout: {row: 1}\nscene: {boxes: [{x: 1.6, y: -6, length: 1, width: 1}]}\n"
    )
    scenario = load_scenario(str(file))
    assert len(static_obstacles(scenario)) == 5
    assert scenario.vehicle["scene.boxes[5].y"] == -6.0


@pytest.mark.parametrize(
    ("sets", "message"),
    [
        (["slot_layout.lenght=5"], r"slot_layout\.lenght: unknown; did you mean length\?"),
        (["slot_layout.row=9"], "slot_layout: 20 boxes with those of the row, the scene holds 16"),
        (["slot_layout.kind=angled"], "slot_layout: angle: is given for kind: angled, and only there"),
        (["slot_layout.kind=angled", "slot_layout.angle=10 deg"], "10 deg is out of range, expected 30 to 150 deg"),
        (["slot_layout.length=-1"], "slot_layout.length: -1"),
        (["slot_layout=5"], "slot_layout: expected a mapping"),
    ],
)
def test_a_mistake_is_named(sets: list[str], message: str) -> None:
    with pytest.raises(BadInput, match=message):
        load_scenario("apa-parallel", sets)


def test_a_part_of_a_layout_that_the_scenario_has_not_is_refused() -> None:
    with pytest.raises(BadInput, match=r"slot_layout: the scenario has none.*kind, length, depth"):
        load_scenario("guo2015-case4", ["slot_layout.length=5"])


def test_slot_and_layout_in_one_file_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text("slot_layout: {kind: parallel, length: 6, depth: 2}\nslot: {x: 0, y: 0, length: 6, width: 2}\n")
    with pytest.raises(BadInput, match=r"mine\.yaml:2: slot: is generated by slot_layout; give one of them"):
        load_scenario(str(file))


@pytest.mark.parametrize("sets", [["slot.length=5"], ["slot.length=7"], ["slot.x=4"]])
def test_a_slot_that_contradicts_the_scene_is_reported(sets: list[str]) -> None:
    (text,) = implausible(load_scenario("apa-parallel", sets)) or [""]
    assert ("slot_layout moves slot, target, neighbours and kerb together" in text) == (sets != ["slot.x=4"])


def test_no_shipped_scenario_contradicts_itself() -> None:
    assert [text for name in scenario_names() for text in implausible(load_scenario(name))] == []


def test_a_part_of_the_layout_is_set_by_its_name_from_file_and_command(tmp_path: Path) -> None:
    path = tmp_path / "moved.yaml"
    path.write_text("extends: apa-parallel\nslot_layout: {origin.y: 1, neighbours.setback: 10 cm}\n")
    scenario = load_scenario(str(path), ["slot_layout.origin.x=2"])
    usual = load_scenario("apa-parallel")
    assert scenario.slot is not None
    assert usual.slot is not None
    assert (scenario.slot.x, scenario.slot.y) == pytest.approx((usual.slot.x + 2.0, usual.slot.y + 1.0))
    assert scenario.vehicle["scene.boxes[1].y"] == pytest.approx(float(usual.vehicle["scene.boxes[1].y"]) + 0.9)
    with pytest.raises(BadInput, match=r"origin\.z"):
        load_scenario("apa-parallel", ["slot_layout.origin.z=2"])
