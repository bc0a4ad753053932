"""What the page draws of the controller's intentions, against the controller's own geometry."""

import math
from typing import Any

import numpy as np
import pytest

from controller_fmu.common.curve import advance
from controller_fmu.parking.params import FinalPoseParams
from modelkit.vocabulary import Pose
from orchestrator.evaluation.verdict.geometry import sample_path
from orchestrator.presentation.report.payload import Arrays
from orchestrator.presentation.report.plans import MOST_PLANS, plans_of, slot_corners, target_pose
from orchestrator.presentation.report.run_data import ribbons_of
from tests.native_runs import native_recording


@pytest.fixture(scope="module")
def recording() -> Any:
    return native_recording("apa-parallel")


@pytest.mark.parametrize("direction", [1, -1])
def test_a_sampled_move_ends_where_the_controller_says(direction: int) -> None:
    pieces = ((1.5, 0.0, 0.15), (2.0, 0.15, 0.15), (1.0, 0.15, -0.1), (0.5, 0.0, 0.0))
    start = Pose(3.0, -2.0, 0.7)
    values = {"apa.move.direction": float(direction)}
    values |= {f"apa.move.start.{axis}": value for axis, value in start._asdict().items()}
    for number, piece in enumerate(pieces, start=1):
        for name, value in zip(("length", "start_curvature", "end_curvature"), piece, strict=True):
            values[f"apa.move.pieces[{number}].{name}"] = value
    points = sample_path(values, 0.02)
    end = start
    for length, k0, k1 in pieces:
        end = advance(end, direction, length, k0, k1)
    assert points[0] == pytest.approx([start.x, start.y])
    assert points[-1] == pytest.approx([end.x, end.y], abs=1e-4)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_found_slot_lies_on_its_side_of_the_road(side: float) -> None:
    heading = 0.3
    along = np.array([math.cos(heading), math.sin(heading)])
    into = side * np.array([-math.sin(heading), math.cos(heading)])
    a = np.array([4.0, 5.0])
    b = a + 6.0 * along
    values = {"apa.slot.type": 1.0, "apa.slot.side": side, "apa.slot.depth": 2.2}
    values |= {"apa.slot.ax": a[0], "apa.slot.ay": a[1], "apa.slot.bx": b[0], "apa.slot.by": b[1]}
    found = slot_corners(values)
    assert found is not None
    np.testing.assert_allclose(found, [a, b, b + 2.2 * into, a + 2.2 * into], atol=1e-12)


def test_no_slot_no_pose_no_path() -> None:
    assert slot_corners({"apa.slot.type": 0.0}) is None
    assert target_pose({}) is None
    assert len(sample_path({})) == 0


def test_plans_follow_the_run(recording: Any) -> None:
    arrays = Arrays()
    plans = plans_of(recording, arrays, (0.0, 0.0))
    assert "slot" not in plans[0]
    last = plans[-1]
    assert last["target"][1] == pytest.approx(recording.signals["vehicle.pose.y"][-1], abs=0.05)
    heading = recording.signals["vehicle.pose.heading"][-1]
    assert last["target"][2] == pytest.approx(heading, abs=FinalPoseParams().heading)
    assert len(last["slot"]) == 4
    assert [plan["t"] for plan in plans] == sorted(plan["t"] for plan in plans)
    assert max(arrays.lengths) > 20
    assert len(plans) <= MOST_PLANS + 1


def test_every_changing_mode_is_a_ribbon_once(recording: Any) -> None:
    ribbons = ribbons_of([recording])
    assert ribbons[0] == "controller.phase"
    assert "controller.apa.state" in ribbons
    shorts = [name.partition(".")[2] for name in ribbons]
    assert len(shorts) == len(set(shorts))
    assert "controller.hsic.stage" not in ribbons
