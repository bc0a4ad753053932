"""The planner with the slot: accepted paths keep clear of both neighbours, refusals say why."""

import math

import numpy as np
import pytest

from controller_fmu.common.slot_clearance import is_pose_clear, outline_of
from controller_fmu.zhang2022.params import ZhangSlot
from controller_fmu.zhang2022.path import EndConditions, PathStatus, at, over_time, plan
from controller_fmu.zhang2022.planner import plan_in_slot
from controller_fmu.zhang2022.refinement import PathLimits, excess
from controller_fmu.zhang2022.slot import is_path_clear, slot_bounds
from controller_fmu.zhang2022.steering_rate import PlannedMotion, largest_wheel_rate
from controller_fmu.zhang2022.time_quintic import motion_at, time_quintic
from modelkit.car import Car
from modelkit.vocabulary import Pose

CAR = Car(wheelbase=2.62, front_overhang=0.966, rear_overhang=0.85, width=1.82)
OUTLINE = outline_of(CAR)
SLOT = slot_bounds(ZhangSlot(length=7.7, width=2.2, rear_gap=0.4), CAR)
LIMIT = 0.95 * math.tan(math.radians(560.0) / 17.0) / 2.62
MOTION = PlannedMotion(2.62, 1.0, 0.5, 0.95 * math.radians(500.0) / 17.0)
LIMITS = PathLimits(LIMIT, MOTION, OUTLINE, SLOT)


@pytest.mark.parametrize(
    ("pose", "clear"),
    [
        (Pose(), True),
        (Pose(-0.3, 0.0, 0.0), False),
        (Pose(3.0, 0.0, 0.0), False),
        (Pose(3.0, 2.2, 0.0), True),
        (Pose(3.0, 2.0, 0.0), False),
        (Pose(4.5, 1.4, 0.2), False),
        (Pose(6.0, 7.5, 0.0), False),
    ],
)
def test_poses_in_and_beside_the_slot(pose: Pose, clear: bool) -> None:
    assert is_pose_clear(pose, OUTLINE, SLOT) == clear


def test_a_start_whose_first_path_hits_a_neighbour_gets_another_path() -> None:
    start = Pose(9.5, 2.65, 0.0)
    assert not is_path_clear(plan(start, 5.0, LIMIT), OUTLINE, SLOT)
    path = plan_in_slot(start, 5.0, LIMITS)
    assert path.status == PathStatus.FOUND
    assert path.largest_curvature <= LIMIT
    for number in range(400):
        x = start.x * number / 399.0
        point = at(path, x)
        assert is_pose_clear(Pose(x, point.y, math.atan(point.slope)), OUTLINE, SLOT._replace(front=6.45, opening=1.1))


def test_a_start_against_a_neighbour_and_a_slot_too_short_are_refused_with_the_reason() -> None:
    assert plan_in_slot(Pose(9.0, 1.9, 0.0), 5.0, LIMITS).status == PathStatus.SLOT_BLOCKED
    short = slot_bounds(ZhangSlot(length=5.2, width=2.2, rear_gap=0.4), CAR)
    assert plan_in_slot(Pose(9.0, 2.8, 0.0), 5.0, LIMITS._replace(slot=short)).status == PathStatus.SLOT_BLOCKED


def test_a_slot_of_no_length_is_not_regarded() -> None:
    unknown = slot_bounds(ZhangSlot(), CAR)
    path = plan_in_slot(Pose(9.5, 2.65, 0.0), 5.0, LIMITS._replace(slot=unknown))
    assert path._replace(length=0.0) == plan(Pose(9.5, 2.65, 0.0), 5.0, LIMIT)


@pytest.mark.parametrize("heading", [0.0, -0.1])
def test_quintics_over_time_keep_start_target_and_curvature(heading: float) -> None:
    start = Pose(8.04, 2.98, heading)
    way = math.hypot(start.x, start.y)
    path = over_time(start, EndConditions(0.45 * way, 6.0 * way, 0.45 * way, 6.0 * way))
    assert path.status == PathStatus.FOUND
    for x, y, slope in ((start.x - 1e-9, start.y, math.tan(heading)), (1e-9, 0.0, 0.0)):
        assert at(path, x) == pytest.approx((y, slope, 0.0), abs=1e-6)
    for x in (path.line.x0, path.first.x0):
        below, above = at(path, x - 1e-9), at(path, x + 1e-9)
        assert below == pytest.approx(above, abs=1e-6)
    times = np.linspace(0.0, 1.0, 200)
    along = [motion_at(time_quintic(start.x, -math.cos(heading) * 0.45 * way, -math.cos(heading) * 6.0 * way,
                                    -0.45 * way, 6.0 * way), t).p for t in times]  # fmt: skip
    aside = [motion_at(time_quintic(start.y, -math.sin(heading) * 0.45 * way, -math.sin(heading) * 6.0 * way,
                                    0.0, 0.0), t).p for t in times]  # fmt: skip
    assert max(abs(at(path, x).y - y) for x, y in zip(along, aside, strict=True)) < 0.02


def test_a_time_quintic_has_the_speeds_and_accelerations_asked_for() -> None:
    quintic = time_quintic(3.0, -0.7, 0.4, -0.2, 1.1)
    assert motion_at(quintic, 0.0) == pytest.approx((3.0, -0.7, 0.4))
    assert motion_at(quintic, 1.0) == pytest.approx((0.0, -0.2, 1.1))


def test_a_start_near_the_slot_s_front_is_parked_by_quintics_over_time() -> None:
    start = Pose(8.0372, 2.9829, 0.0)
    path = plan_in_slot(start, 5.0, LIMITS)
    assert path.status == PathStatus.FOUND
    assert is_path_clear(path, OUTLINE, SLOT)
    assert path.length > math.hypot(start.x, start.y)


def test_a_path_beyond_the_limits_is_refined_until_it_keeps_them() -> None:
    """No quintic over time of the grid keeps the curvature here, a path near the best of them does."""
    path = plan_in_slot(Pose(8.0516, 3.1137, -0.0389), 5.0, LIMITS)
    assert path.status == PathStatus.FOUND
    assert excess(path, LIMITS) <= 1.0
    assert is_path_clear(path, OUTLINE, SLOT)


def test_the_wheel_rate_of_a_path_is_that_of_driving_it_from_rest() -> None:
    """Driven in small steps: the front wheels turn as fast as said, where the speed is the planned one."""
    path = plan(Pose(8.5, 2.8, 0.0), 5.0, LIMIT)
    x, way, wheel, fastest = 8.5, 0.0, 0.0, 0.0
    while x > 1e-3:
        slope = at(path, x).slope
        step = 1e-3 * math.sqrt(1.0 + slope * slope)
        speed = min(1.0, math.sqrt(2.0 * 0.5 * way), math.sqrt(2.0 * 0.35 * x) + 0.03)
        turned = math.atan(2.62 * at(path, x - 1e-3).curvature)
        fastest = max(fastest, abs(turned - wheel) / step * speed)
        x, way, wheel = x - 1e-3, way + step, turned
    assert largest_wheel_rate(path, MOTION) == pytest.approx(fastest, rel=0.05)
