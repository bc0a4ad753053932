"""The outline's clearance against an independent geometry library."""

import math

import numpy as np
import pytest
import shapely

from controller_fmu.apa import outline
from controller_fmu.apa.out import moves
from controller_fmu.apa.out.moves import free_out
from controller_fmu.apa.outline import Box, Obstacles, Shape, box_clearance, clearance, free_way, grown, turned_box
from controller_fmu.apa.ways import move
from controller_fmu.apa.ways.move import NO_PIECE, Move, Piece, is_move_free
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
    assert free_way(Pose(6.6, 0.0, 0.0), 1.0, 0.0, 3.0, CAR, walls) == 0.0, "within a margin, and further into it"
    assert free_way(Pose(6.6, 0.0, 0.0), -1.0, 0.0, 3.0, CAR, walls) == 3.0, "out of it"


def test_a_way_is_as_free_as_if_every_place_were_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    random = np.random.default_rng(7)
    scenes = []
    for _ in range(300):
        things = [
            turned_box(Box(-2.2, 2.2, -1.0, 1.0), x + random.uniform(-1, 1), y + random.uniform(-1, 1), turn)
            for x, y, turn in zip((-6.5, 8.0, 0.5), (0.0, 0.0, -3.5), random.uniform(-0.4, 0.4, 3), strict=True)
        ]
        k = random.uniform(-0.2, 0.2, 4).tolist()
        pieces = (Piece(1.0, k[0], k[0]), Piece(0.8, k[0], k[1]), NO_PIECE, Piece(1.5, k[2], k[3]), *(NO_PIECE,) * 3)
        start = Pose(*random.uniform(-1, 1, 3).tolist())
        scenes.append((start, Obstacles(*things), k[0], Move(start, random.choice((-1, 1)), pieces)))

    def found() -> list[tuple[float, bool, float]]:
        return [
            (
                free_way(start, float(way.direction), k, 4.0, CAR, around),
                is_move_free(way, CAR, around),
                free_out(start, way.direction, k, 4.0, CAR, around),
            )
            for start, around, k, way in scenes
        ]

    skipping = found()
    for module in (outline, move, moves):
        monkeypatch.setattr(module, "sure_steps", lambda gap, moved: 0)
    assert skipping == found()
    assert len({way for way, _, _ in skipping}) > 40
    assert 50 < sum(free for _, free, _ in skipping) < 250
    assert len({way for _, _, way in skipping}) > 40
