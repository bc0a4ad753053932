"""The distance of the outline to edges, and which edges the planner lays out."""

import math

import numpy as np

from controller_fmu.parking.geometry.outline import VehicleOutline
from controller_fmu.parking.geometry.outline_distance import edge_distance_squared
from controller_fmu.parking.geometry.polygons import LOCAL_VERTICES, ObstacleMap, Vertex
from controller_fmu.parking.planning.planner import search_until
from controller_fmu.parking.planning.problem import PlanningRequest
from controller_fmu.parking.planning.work import PlanCount, PlanningWork
from modelkit.store import new_store
from modelkit.vocabulary import Pose

CAR = VehicleOutline(1.3, 2.3, 0.95, 0.2)
FAR = 100.0
"""No distance is limited [m2]."""


def sampled_distance(a: tuple[float, float], b: tuple[float, float]) -> float:
    """Return the distance [m] of the outline to the edge a-b at 2,001 of its points."""
    share = np.linspace(0.0, 1.0, 2001)
    x = np.abs(a[0] + share * (b[0] - a[0])) - CAR.half_length
    y = np.abs(a[1] + share * (b[1] - a[1])) - CAR.half_width
    return float(np.hypot(np.maximum(x, 0.0), np.maximum(y, 0.0)).min())


def test_the_distance_to_an_edge_is_exact() -> None:
    drawn = np.random.default_rng(5)
    for number in range(500):
        a, b = drawn.uniform(-5.0, 5.0, (2, 2))
        if number % 4 == 1:
            b[number % 8 // 4] = a[number % 8 // 4]
        found = math.sqrt(edge_distance_squared(a[0], a[1], b[0], b[1], CAR, FAR))
        assert abs(found - sampled_distance((a[0], a[1]), (b[0], b[1]))) < 3e-3, (a, b)


def test_an_edge_of_no_length_is_a_point() -> None:
    assert math.isclose(edge_distance_squared(3.3, 0.95, 3.3, 0.95, CAR, FAR), 1.0)
    assert edge_distance_squared(0.5, 0.5, 0.5, 0.5, CAR, FAR) == 0.0


def edges_of(*polygons: list[tuple[float, float]]) -> int:
    """Return how many edges the planner lays out for polygons of these vertices."""
    corners = [Vertex(x, y, number + 1) for number, polygon in enumerate(polygons) for x, y in polygon]
    rest = (Vertex(),) * (LOCAL_VERTICES - len(corners))
    work = new_store(PlanningWork)
    request = PlanningRequest(Pose(), Pose(5.0, 0.0, 0.0), CAR, 0.1, 10)
    search_until(work, ObstacleMap((*corners, *rest)), (), request, 1)
    return work.counts[PlanCount.EDGE_COUNT]


def test_an_edge_is_laid_out_once() -> None:
    assert edges_of([(0.0, 4.0), (3.0, 4.0), (3.0, 5.0), (0.0, 5.0)]) == 4
    assert edges_of([(0.0, 4.0), (3.0, 4.0)]) == 1
    assert edges_of([(1.0, 4.0)]) == 1
    assert edges_of([(1.0, 4.0)], [(1.0, 4.0)]) == 2
