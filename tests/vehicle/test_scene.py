"""Clearance, ultrasonic readings and odometry against shapely and closed forms."""

import math
import random

import pytest
import shapely
from shapely import affinity

from modelkit.car import SENSOR_MOUNTS, Car, CarUltrasonic
from modelkit.geometry import NO_HIT
from modelkit.vocabulary import Pose
from vehicle_fmu.odometry import OdometryParams, OdometryState, reckon, wheel_speed_reading
from vehicle_fmu.scene import Kerb, Obstacle, SceneParams, clearance
from vehicle_fmu.ultrasonic import (
    UltrasonicParams,
    first_readings,
    is_due,
    measure,
    range_measurements,
)

EXACT = CarUltrasonic(min_range=0.0, resolution=0.0)
CLEAN = UltrasonicParams()


def polygon(obstacle: Obstacle) -> shapely.Geometry:
    half_length, half_width = 0.5 * obstacle.length, 0.5 * obstacle.width
    shape = shapely.box(-half_length, -half_width, half_length, half_width)
    turned = affinity.rotate(shape, obstacle.heading, origin=(0.0, 0.0), use_radians=True)
    return affinity.translate(turned, obstacle.x, obstacle.y)


def random_scene(draw: random.Random) -> SceneParams:
    boxes = [
        Obstacle(
            draw.uniform(-8, 8), draw.uniform(-8, 8), draw.uniform(-4, 4), draw.uniform(0.3, 5), draw.uniform(0.1, 2)
        )
        for _ in range(6)
    ]
    kerbs = [Kerb._make([*(draw.uniform(-8, 8) for _ in range(4)), 0.2]) for _ in range(2)]
    return SceneParams((*boxes, *(Obstacle(),) * 10), (*kerbs, *(Kerb(),) * 2))


def everything(scene: SceneParams) -> shapely.Geometry:
    boxes = [polygon(box) for box in scene.boxes if box.length > 0.0]
    kerbs = [shapely.LineString([(k.x1, k.y1), (k.x2, k.y2)]) for k in scene.kerbs if k.height > 0.0]
    return shapely.GeometryCollection(boxes + kerbs)


def test_clearance_is_the_distance_to_the_nearest_thing() -> None:
    draw = random.Random(5)
    for _ in range(300):
        scene = random_scene(draw)
        pose = Pose(draw.uniform(-6, 6), draw.uniform(-6, 6), draw.uniform(-4, 4))
        car = shapely.box(-0.60, -0.825, 3.205, 0.825)
        car = affinity.rotate(car, pose.heading, origin=(0.0, 0.0), use_radians=True)
        car = affinity.translate(car, pose.x, pose.y)
        found = clearance(pose, Car(), scene, 0.08, 0)
        assert max(found, 0.0) == pytest.approx(car.distance(everything(scene)), abs=1e-9)
        assert (found < 0.0) == car.intersects(everything(scene))


def test_an_empty_scene_is_clear() -> None:
    assert clearance(Pose(), Car(), SceneParams(), 0.08, 0) == NO_HIT
    assert first_readings(Pose(), SceneParams(), EXACT, CLEAN).readings == (5.0,) * 12


def test_a_low_kerb_passes_under_the_bumper_but_not_under_the_wheels() -> None:
    ahead = Kerb(3.0, -2.0, 3.0, 2.0, 0.10)
    assert clearance(Pose(), Car(), SceneParams(kerbs=(ahead, *(Kerb(),) * 3)), 0.08, 0) == pytest.approx(
        3.0 - 2.405 - 0.3
    )
    high = ahead._replace(height=0.3)
    assert clearance(Pose(), Car(), SceneParams(kerbs=(high, *(Kerb(),) * 3)), 0.08, 0) < 0.0


def test_a_low_box_passes_under_the_bumper_but_not_under_the_wheels() -> None:
    """And one that the sensors cannot detect stops a wheel without contact."""
    ahead = Obstacle(3.1, 0.0, 0.0, 0.2, 4.0, height=0.10)
    others = (Obstacle(),) * 15
    assert clearance(Pose(), Car(), SceneParams((ahead, *others)), 0.08, 0) == pytest.approx(3.0 - 2.405 - 0.3)
    assert clearance(Pose(), Car(), SceneParams((ahead._replace(height=0.3), *others)), 0.08, 0) < 0.0
    below = ahead._replace(x=2.5, height=0.07)
    assert clearance(Pose(), Car(), SceneParams((below, *others)), 0.08, 0) == 0.0
    assert clearance(Pose(), Car(), SceneParams((below, *others)), 0.05, 0) < 0.0


def test_things_appear_and_disappear() -> None:
    walker = Obstacle(5.0, 0.0, 0.0, 0.4, 0.4, 2.0, 3.0)
    scene = SceneParams((walker, *(Obstacle(),) * 15))
    seen = [clearance(Pose(), Car(), scene, 0.08, int(t * 1e9)) for t in (1.9, 2.0, 2.9, 3.0)]
    assert seen == [
        NO_HIT,
        pytest.approx(5.0 - 0.2 - 3.205),
        pytest.approx(5.0 - 0.2 - 3.205),
        NO_HIT,
    ]


def test_things_move_and_are_heard_where_they_are() -> None:
    """Towards the front bumper at 0.5 m/s from 2 to 4 s: clearance and the middle front sensors see it there."""
    walker = Obstacle(6.0, 0.0, 0.0, 0.4, 0.8, speed_x=-0.5, moves_at=2.0, halts_at=4.0)
    scene = SceneParams((walker, *(Obstacle(),) * 15))
    first = 6.0 - 0.2 - 3.205
    for t, gap in ((0.0, first), (2.0, first), (3.0, first - 0.5), (4.0, first - 1.0), (9.0, first - 1.0)):
        assert clearance(Pose(), Car(), scene, 0.08, int(t * 1e9)) == pytest.approx(gap, abs=1e-9)
        heard = range_measurements(Pose(), scene, EXACT, 0.08, int(t * 1e9))
        assert heard[1:3] == pytest.approx((gap, gap), abs=1e-9)


def test_readings_are_shapelys_distances_in_the_cone() -> None:
    draw = random.Random(6)
    heard = 0
    for _ in range(250):
        scene = random_scene(draw)
        pose = Pose(draw.uniform(-6, 6), draw.uniform(-6, 6), draw.uniform(-4, 4))
        state = first_readings(pose, scene, EXACT, CLEAN)
        for reading, mount in zip(state.readings, SENSOR_MOUNTS, strict=True):
            cos, sin = math.cos(pose.heading), math.sin(pose.heading)
            x, y = pose.x + mount.x * cos - mount.y * sin, pose.y + mount.x * sin + mount.y * cos
            axis = pose.heading + mount.yaw
            ends = [(x + 50.0 * math.cos(axis + t), y + 50.0 * math.sin(axis + t)) for t in (-math.pi / 6, math.pi / 6)]
            cone = shapely.Polygon([(x, y), *ends])
            part = everything(scene).intersection(cone)
            expected = 5.0 if part.is_empty else min(5.0, part.distance(shapely.Point(x, y)))
            assert reading == pytest.approx(expected, abs=1e-6)
            heard += expected < 5.0
    assert heard > 800


def wall(distance: float) -> SceneParams:
    return SceneParams((Obstacle(3.205 + distance + 0.5, 0.0, 0.0, 1.0, 20.0), *(Obstacle(),) * 15))


def test_resolution_and_range_limits() -> None:
    params = CarUltrasonic(resolution=0.02, min_range=0.2, max_range=3.0)
    assert first_readings(Pose(), wall(1.2345), params, CLEAN).readings[1] == pytest.approx(1.24)
    assert first_readings(Pose(), wall(0.05), params, CLEAN).readings[1] == 0.2
    assert first_readings(Pose(), wall(3.5), params, CLEAN).readings[1] == 3.0


def test_noise_has_its_deviation_dropout_its_rate_and_the_seed_repeats() -> None:
    params = CLEAN._replace(noise=0.03, dropout=0.2, seed=7)
    state = first_readings(Pose(), wall(1.5), EXACT, params)
    again = first_readings(Pose(), wall(1.5), EXACT, params)
    found, lost = [], 0
    for n in range(4000):
        state, again = (
            measure(state, Pose(), wall(1.5), EXACT, params, n),
            measure(again, Pose(), wall(1.5), EXACT, params, n),
        )
        assert state == again
        for reading in state.readings[1:3]:
            lost += reading == 5.0
            found += [reading] if reading < 5.0 else []
    mean = sum(found) / len(found)
    deviation = math.sqrt(sum((reading - mean) ** 2 for reading in found) / len(found))
    assert mean == pytest.approx(1.5, abs=0.002)
    assert deviation == pytest.approx(0.03, rel=0.05)
    assert lost / 8000.0 == pytest.approx(0.2, abs=0.02)
    other = first_readings(Pose(), wall(1.5), EXACT, params._replace(seed=8))
    assert other.readings != first_readings(Pose(), wall(1.5), EXACT, params).readings


def test_low_kerbs_are_not_heard() -> None:
    for height, seen in ((0.05, False), (0.12, True)):
        scene = SceneParams(kerbs=(Kerb(4.0, -3.0, 4.0, 3.0, height), *(Kerb(),) * 3))
        assert (first_readings(Pose(), scene, EXACT, CLEAN).readings[1] < 5.0) is seen
        scene = SceneParams((Obstacle(4.1, 0.0, 0.0, 0.2, 6.0, height=height), *(Obstacle(),) * 15))
        assert (first_readings(Pose(), scene, EXACT, CLEAN).readings[1] < 5.0) is seen


def test_cycle() -> None:
    assert not is_due(0, 39_000_000, 0.04)
    assert is_due(39_000_000, 40_000_000, 0.04)
    assert not is_due(40_000_000, 79_999_999, 0.04)


def drive(params: OdometryParams, steps: int, way: float, angle: float) -> Pose:
    state = OdometryState()
    for _ in range(steps):
        state = reckon(state, way, angle, 2.405, params)
    return state.pose


@pytest.mark.parametrize("way", [0.01, -0.01])
def test_radius_error_grows_with_the_way(way: float) -> None:
    pose = drive(OdometryParams(False, radius_error=0.02), 1000, way, 0.0)
    assert pose.x == pytest.approx(1.02 * 1000 * way, rel=1e-12)
    assert pose.y == pose.heading == 0.0


@pytest.mark.parametrize("way", [0.01, -0.01])
def test_steering_offset_bends_a_straight_line_into_its_circle(way: float) -> None:
    offset, rolled = 0.005, 1000 * way
    pose = drive(OdometryParams(False, steering_offset=offset), 1000, way, 0.0)
    curvature = math.tan(offset) / 2.405
    assert pose.heading == pytest.approx(rolled * curvature, rel=1e-12)
    assert pose.x == pytest.approx(math.sin(rolled * curvature) / curvature, rel=1e-12)
    assert pose.y == pytest.approx((1.0 - math.cos(rolled * curvature)) / curvature, rel=1e-10)


def test_without_errors_it_is_the_arc() -> None:
    pose = drive(OdometryParams(False), 500, -0.01, 0.4)
    curvature = math.tan(0.4) / 2.405
    assert pose.x == pytest.approx(math.sin(-5.0 * curvature) / curvature, rel=1e-12)


def test_ticks_never_lose_way() -> None:
    params = OdometryParams(False, tick=0.02)
    state = OdometryState()
    for n in range(1, 3001):
        state = reckon(state, 0.0037, 0.0, 2.405, params)
        assert abs(state.pose.x - 0.0037 * n) <= 0.01 + 1e-9
    assert wheel_speed_reading(1.0, OdometryParams(True, 0.1)) == 1.0
    assert wheel_speed_reading(1.0, OdometryParams(False, 0.1)) == 1.1


def test_rounded_steering_angle() -> None:
    params = OdometryParams(False, steering_resolution=0.01)
    assert drive(params, 10, 0.1, 0.234).heading == pytest.approx(math.tan(0.23) / 2.405, rel=1e-12)
