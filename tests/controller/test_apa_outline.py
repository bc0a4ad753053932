"""The outline's clearance against an independent geometry library."""

import math

import numpy as np
import shapely

from controller_fmu.apa.outline import Box, Obstacles, Shape, box_clearance, clearance, free_way, grown
from modelkit.vocabulary import Pose

POSES = 100_000
CAR = Shape(3.5, 0.85, 0.91, 0.2, 0.8)


def test_agrees_with_shapely_on_100000_random_poses() -> None:
    random = np.random.default_rng(5)
    x, y, h = random.uniform(-6, 6, POSES), random.uniform(-6, 6, POSES), random.uniform(-math.pi, math.pi, POSES)
    low = random.uniform(-3, 0, (POSES, 2))
    high = low + random.uniform(0.2, 4, (POSES, 2))
    corners = np.array([[3.5, 0.91], [3.5, -0.91], [-0.85, -0.91], [-0.85, 0.91]])
    c, s = np.cos(h)[:, None], np.sin(h)[:, None]
    outline = np.stack(
        [x[:, None] + corners[:, 0] * c - corners[:, 1] * s, y[:, None] + corners[:, 0] * s + corners[:, 1] * c], -1
    )
    cars = shapely.polygons(outline)
    boxes = shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
    expected = shapely.distance(cars, boxes)
    ours = np.array(
        [
            box_clearance(Pose(*pose), CAR, Box(a[0], b[0], a[1], b[1]))
            for pose, a, b in zip(np.stack([x, y, h], -1).tolist(), low.tolist(), high.tolist(), strict=True)
        ]
    )
    touching = expected == 0.0
    assert 0.2 < touching.mean() < 0.8
    np.testing.assert_array_equal(ours <= 1e-12, touching)
    np.testing.assert_allclose(ours[~touching], expected[~touching], rtol=0.0, atol=1e-9)


def test_nothing_stands_in_an_empty_box_however_grown() -> None:
    assert clearance(Pose(0.0, 0.0, 0.3), CAR, Obstacles()) > 50.0
    assert grown(Box(), 5.0) == Box()


def test_free_way_ends_before_the_wall() -> None:
    walls = Obstacles(ahead=Box(10.0, 20.0, -5.0, 5.0))
    way = free_way(Pose(0.0, 0.0, 0.0), 1.0, 0.0, 20.0, CAR, walls)
    assert 10.0 - 3.5 - 0.041 < way < 10.0 - 3.5
    assert free_way(Pose(0.0, 0.0, 0.0), 1.0, 0.0, 3.0, CAR, walls) == 3.0
