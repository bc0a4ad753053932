"""What stands around the car is drawn while it is there."""

import pytest

from orchestrator.evaluation.verdict.geometry import Box, CarOutline, boxes, kerbs, slot_box
from orchestrator.inputs.scenario.scenario import Slot
from orchestrator.presentation.drawing.scene import Surroundings, still_life

SECOND = 1_000_000_000
CAR = CarOutline.of({})


def ids(stage: Surroundings, t_ns: int) -> set[str]:
    return {entity.id for entity in still_life(t_ns, CAR, stage).entities}


def test_parameters_become_boxes_and_kerbs_and_empty_ones_are_left_out() -> None:
    parameters = {f"scene.boxes[{n}].{field}": 0.0 for n in (1, 2, 3) for field in ("x", "y", "heading", "length")}
    parameters |= {"scene.boxes[2].length": 4.0, "scene.boxes[2].width": 2.0, "scene.boxes[2].appear_at": 3.0}
    parameters |= {"scene.kerbs[1].x2": 5.0, "scene.kerbs[1].height": 0.1, "scene.kerbs[2].height": 0.0}
    assert boxes(parameters) == [Box(length=4.0, width=2.0, appear_at=3.0)]
    assert [(kerb.x1, kerb.x2) for kerb in kerbs(parameters)] == [(0.0, 5.0)]


def test_an_obstacle_comes_and_goes() -> None:
    box = Box(1.0, 2.0, 0.0, 0.5, 0.5, appear_at=2.0, disappear_at=5.0)
    stage = Surroundings(None, [Box(length=4.0, width=2.0), box], [], None)
    assert stage.changes_ns() == [0, 2 * SECOND, 5 * SECOND]
    for t, there in ((0, False), (2, True), (4, True), (5, False)):
        assert ("obstacle_2" in ids(stage, t * SECOND)) is there
        assert "obstacle_1" in ids(stage, t * SECOND)
    deletions = still_life(5 * SECOND, CAR, stage).deletions
    assert [deletion.id for deletion in deletions] == ["obstacle_2"]


def test_a_thing_that_moves_is_drawn_where_it_is() -> None:
    """Between 2 and 3 s along x: boxes that stand, one at each time, in the place of it."""
    walker = Box(1.0, 2.0, 0.0, 0.5, 0.5, appear_at=1.0, disappear_at=9.0, speed_x=1.5, moves_at=2.0, halts_at=3.0)
    stills = walker.stills()
    assert len(stills) == 12
    for t, x in ((1.5, 1.0), (2.05, 1.0), (2.55, 1.75), (3.0, 2.5), (8.0, 2.5)):
        (there,) = [box for box in stills if box.appear_at <= t < box.disappear_at]
        assert (there.x, there.y) == pytest.approx((x, 2.0))
    assert [box for box in stills if box.appear_at <= 0.9 or box.disappear_at > 9.0] == []
    assert Box(1.0, length=1.0, width=1.0, speed_x=1.0, moves_at=9.0, disappear_at=5.0).stills()[0].x == 1.0


def test_the_slot_is_where_the_scenario_says() -> None:
    stage = Surroundings(slot_box(Slot(x=1.0, y=2.0, heading=0.0, length=6.0, width=2.0)), [], [], None)
    slot = next(entity for entity in still_life(0, CAR, stage).entities if entity.id == "slot")
    assert [(point.x, point.y) for point in slot.lines[0].points] == [(-2, 1), (4, 1), (4, 3), (-2, 3), (-2, 1)]
    assert slot.frame_id == "world"


@pytest.mark.parametrize("name", ["car", "odometry", "front_left_wheel", "front_right_wheel"])
def test_the_car_is_always_there(name: str) -> None:
    assert name in ids(Surroundings(None, [], [], None), 0)
