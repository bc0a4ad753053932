"""The two-arc path against its own definition: tangency, ends, radii, and eq. (9) and Table 2 of Guo 2015."""

import math
from itertools import pairwise

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from controller_fmu.common.slot_frame import SlotFrame, to_slot, to_world
from controller_fmu.guo2015.legs import point_of_leg
from controller_fmu.guo2015.params import GuoParams
from controller_fmu.guo2015.path import distance_to_end, reference_at
from controller_fmu.guo2015.phases import GuoPhase
from controller_fmu.guo2015.planner import TwoArcPath, plan, touching_radius, two_arcs
from modelkit.vocabulary import Pose

SMALLEST = 2.405 / math.tan(math.radians(30.0))
TABLE_2 = {
    GuoPhase.TO_Q1: (-3.798, -1.522, 0.765),
    GuoPhase.TO_Q2: (-3.077, -0.830, 0.765),
    GuoPhase.TO_Q4: (-5.108, -3.056, 0.0),
}

poses = st.builds(
    Pose,
    st.floats(-1e3, 1e3, allow_nan=False),
    st.floats(-1e3, 1e3, allow_nan=False),
    st.floats(-math.pi, math.pi, allow_nan=False),
)


def guo() -> tuple[SlotFrame, TwoArcPath]:
    planned = plan(Pose(0.0, 0.0, 0.0), Pose(-7.608, -3.056, 0.0), 5.5, SMALLEST)
    return planned.frame, planned.path


def test_equation_9_is_one_instance() -> None:
    frame, path = guo()
    assert path.found
    assert path.radius == pytest.approx(5.5, abs=2e-3)  # print's arcs overlap by 2 mm; ours touch
    for x in [-0.5 * k for k in range(1, 15)]:
        printed = -5.5 + math.sqrt(30.25 - x * x) if x > -3.8 else 2.44 - math.sqrt(30.25 - (x + 7.61) ** 2)
        at = to_slot(Pose(x, 0.0, 0.0), frame)
        reference = reference_at(path, at.x, 0)
        world = to_world(Pose(at.x, reference.y, reference.heading), frame)
        assert world.y == pytest.approx(printed, abs=4e-3)


@pytest.mark.parametrize("leg", TABLE_2)
def test_table_2_follows_from_the_geometry(leg: GuoPhase) -> None:
    frame, path = guo()
    point = to_world(point_of_leg(leg, path, GuoParams()), frame)
    x, y, heading = TABLE_2[leg]
    assert (point.x, point.y) == pytest.approx((x, y), abs=0.01)
    assert point.heading == pytest.approx(heading, abs=2e-3)


starts = st.builds(Pose, st.floats(4.0, 14.0), st.floats(0.5, 6.0), st.floats(-0.3, 0.5))


@given(start=starts, radius=st.floats(4.5, 8.0))
def test_pieces_join_with_one_tangent(start: Pose, radius: float) -> None:
    path = two_arcs(start, radius, SMALLEST)
    assume(path.found)
    r, a, b = path.radius, path.tangent1, path.tangent2
    assert SMALLEST <= r <= radius
    centre = (start.x + r * math.sin(start.heading), start.y - r * math.cos(start.heading))
    assert math.dist(centre, (a.x, a.y)) == pytest.approx(r, abs=1e-6)
    assert (a.x - centre[0], a.y - centre[1]) == pytest.approx(
        (-r * math.sin(a.heading), r * math.cos(a.heading)), abs=1e-6
    )
    assert math.dist((0.0, r), (b.x, b.y)) == pytest.approx(r, abs=1e-6)
    assert (a.x - b.x) * math.sin(b.heading) == pytest.approx((a.y - b.y) * math.cos(b.heading), abs=1e-6)
    assert a.heading == b.heading >= start.heading - 1e-9


@given(start=starts)
def test_touching_radius_makes_the_arcs_touch(start: Pose) -> None:
    r = touching_radius(start)
    assume(0.5 < r < 50.0)
    centre = (start.x + r * math.sin(start.heading), start.y - r * math.cos(start.heading))
    assert math.dist(centre, (0.0, r)) == pytest.approx(2.0 * r, rel=1e-9)


@given(start=starts, radius=st.floats(4.5, 8.0), share=st.floats(0.001, 0.999))
def test_reference_has_the_slope_and_curvature_it_says(start: Pose, radius: float, share: float) -> None:
    path = two_arcs(start, radius, SMALLEST)
    assume(path.found)
    x, h = share * start.x, 1e-4
    here, before, after = (reference_at(path, at, 0) for at in (x, x - h, x + h))
    assume(here.piece == before.piece == after.piece)
    slope = (after.y - before.y) / (2.0 * h)
    second = (after.y - 2.0 * here.y + before.y) / (h * h)
    assert math.tan(here.heading) == pytest.approx(slope, rel=1e-4, abs=1e-5)
    assert here.curvature == pytest.approx(second / (1.0 + slope * slope) ** 1.5, rel=1e-2, abs=1e-4)


@given(start=starts, radius=st.floats(4.5, 8.0))
def test_way_to_the_end_is_the_integral_along_the_path(start: Pose, radius: float) -> None:
    path = two_arcs(start, radius, SMALLEST)
    assume(path.found)
    count = 4000
    xs = [start.x * k / count for k in range(count + 1)]
    points = [(x, reference_at(path, x, 0).y) for x in xs]
    length = sum(math.dist(p, q) for p, q in pairwise(points))
    assert distance_to_end(path, reference_at(path, start.x, 0)) == pytest.approx(length, rel=1e-5)


@given(pose=poses, target=poses, mirror=st.sampled_from([1.0, -1.0]))
def test_frames_are_inverse(pose: Pose, target: Pose, mirror: float) -> None:
    frame = SlotFrame(target, mirror)
    back = to_world(to_slot(pose, frame), frame)
    assert (back.x, back.y) == pytest.approx((pose.x, pose.y), abs=1e-9)
    assert math.cos(back.heading - pose.heading) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize(
    "start",
    [
        Pose(2.0, 3.0, 0.0),  # too close: the arcs would need a radius under the smallest
        Pose(-5.0, 1.0, 0.0),  # behind the target
        Pose(8.0, 3.0, 2.0),  # facing away
    ],
)
def test_impossible_starts_have_no_path(start: Pose) -> None:
    assert not plan(start, Pose(0.0, 0.0, 0.0), 5.5, SMALLEST).path.found
