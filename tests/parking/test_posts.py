"""Posts and hitches that two sensors of a bumper measure together before they come between their cones."""

import pytest

from controller_fmu.parking.chart import ParkingState
from controller_fmu.parking.map.landmark import Landmark, LandmarkType
from controller_fmu.parking.params import ParkingParams
from controller_fmu.parking.perception import perceive
from controller_fmu.parking.signals import ParkingSystemInput
from controller_fmu.parking.state import ParkingMemory
from modelkit.geometry import Box
from modelkit.vocabulary import Pose
from tests.parking.simulated_pass import CAR, exact_ranges

SENSORS = CAR.ultrasonic
PARAMS = ParkingParams(car=CAR)


def posts_after(boxes: list[Box], poses: list[Pose]) -> tuple[list[Landmark], list[float]]:
    """Return the confirmed points of the map, and the last readings, of a vehicle that reverses through ``poses``."""
    memory = ParkingMemory(state=ParkingState.DRIVING)
    readings: list[float] = []
    for pose in poses:
        readings = exact_ranges(pose, boxes, SENSORS)
        inputs = ParkingSystemInput(ultrasonic=tuple(readings), odometry=pose, measured_speed=-0.5)
        memory = perceive(memory, inputs, PARAMS, round(SENSORS.cycle * 1e9))
    points = [item for item in memory.perception.local_map.landmarks if item.type == LandmarkType.POINT]
    return [item for item in points if item.confirmations >= PARAMS.mapping.confirmations], readings


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_hitch_that_came_between_the_cones_of_two_sensors_is_kept(side: float) -> None:
    hitch = Box(-1.94, side * 0.72, 0.0, 0.08, 0.08)
    poses = [Pose(-0.02 * n, side * 0.004 * n, 0.0) for n in range(50)]
    posts, readings = posts_after([hitch], poses)
    assert all(reading >= SENSORS.max_range for reading in readings[4:8]), "no sensor sees it any more"
    assert [(post.x, post.y) for post in posts] == [pytest.approx((-1.9, side * 0.68), abs=0.02)]


def test_echoes_of_two_posts_are_no_third_one() -> None:
    """Both are seen by one sensor each, 1.3 m away: their ranges meet between them, at another place each time."""
    posts = [Box(-1.95, 0.0, 0.0, 0.06, 0.06), Box(-1.2, -1.8, 0.0, 0.06, 0.06)]
    found, _ = posts_after(posts, [Pose(-0.02 * n, 0.0, 0.0) for n in range(25)])
    assert not found
