"""Scenes for the planner, and a judge that knows nothing of it: shapely."""

import math
import os
from array import array
from pathlib import Path
from typing import Any

import shapely
from shapely.geometry import Polygon

from controller_fmu.parking.geometry.outline import VehicleOutline, pose_along_arc
from controller_fmu.parking.geometry.polygons import MAP_VERTICES, ObstacleMap, Vertex
from controller_fmu.parking.planning.planner import PlanningStatus, restart, search_until, store_request
from controller_fmu.parking.planning.problem import PlanningRequest
from controller_fmu.parking.planning.work import PlanCount, PlanningWork
from modelkit.store import new_store
from modelkit.vocabulary import Pose
from tests.planning.plan_model import Scene

CAR = VehicleOutline(1.4155, 2.3445, 0.971, math.tan(0.75) / 2.8)
"""The competition's car."""


def tpcap_folder() -> Any:
    """Return the folder of TPCAP's cases, which are no part of the project, or None."""
    places = [Path(os.environ["TPCAP"])] if "TPCAP" in os.environ else []
    places += [parent / "shared" / "tpcap" for parent in Path(__file__).resolve().parents]
    return next((place for place in places if (place / "Case1.csv").exists()), None)


def read_case(number: Any) -> Any:
    """Return (start, goal, polygons) of a TPCAP case, seen from the goal."""
    text = (tpcap_folder() / f"Case{number}.csv").read_text()
    values = [float(word) for word in text.replace("\n", ",").split(",") if word.strip()]
    start, goal, count = values[:3], values[3:6], int(values[6])
    sizes = [int(size) for size in values[7 : 7 + count]]
    at = 7 + count
    polygons = []
    for size in sizes:
        ends = zip(values[at : at + 2 * size : 2], values[at + 1 : at + 2 * size : 2], strict=True)
        polygons.append([(x - goal[0], y - goal[1]) for x, y in ends])
        at += 2 * size
    return Pose(start[0] - goal[0], start[1] - goal[1], start[2]), Pose(0.0, 0.0, goal[2]), polygons


def scene_of(polygons: Any) -> Any:
    """Return polygons as the planner's scene."""
    corners = [Vertex(x, y, number + 1) for number, polygon in enumerate(polygons) for x, y in polygon]
    return Scene(tuple(corners + [Vertex()] * (MAP_VERTICES - len(corners))))


MAX_CUSPS = 25


def request_of(start: Pose, goal: Pose, margin: float) -> PlanningRequest:
    """Return a request of the competition's car in a known map."""
    return PlanningRequest(start, goal, CAR, margin, MAX_CUSPS, True)


def search(store: Any, scene: Any, request: PlanningRequest, count: int) -> None:
    """Bring the search among a scene's polygons to ``count`` steps."""
    search_until(store, ObstacleMap(), scene.corners, request, count)


def plan(request: PlanningRequest, scene: Any, store: Any = None, at_a_time: Any = 200, max_steps: Any = 4000) -> Any:
    """Return the store after the search for ``request`` has ended."""
    store = new_store(PlanningWork) if store is None else store
    store_request(store, ObstacleMap(), scene.corners, request)
    restart(store)
    for count in range(at_a_time, max_steps, at_a_time):
        search(store, scene, request, count)
        if store.counts[PlanCount.STATUS] != PlanningStatus.PLANNING:
            break
    return store


def kept(store: Any) -> Any:
    """Return the path as (way, curvature) pairs."""
    return [
        (store.best_length[at], store.best_curvature[at]) for at in range(store.counts[PlanCount.BEST_SEGMENT_COUNT])
    ]


def poses_along(start: Any, pieces: Any, step: Any = 0.01) -> Any:
    """Return poses along a path at most ``step`` [m] apart, its end last."""
    found = []
    for way, k in pieces:
        count = max(1, math.ceil(abs(way) / step))
        found += [pose_along_arc(start, way * number / count, k) for number in range(count)]
        start = pose_along_arc(start, way, k)
    return [*found, start]


def outline_of(pose: Any, car: Any) -> Any:
    """Return the car's outline as a polygon of shapely."""
    cos, sin = math.cos(pose.heading), math.sin(pose.heading)
    sides = [
        (car.centre_ahead + a * car.half_length, b * car.half_width) for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))
    ]
    return Polygon([(pose.x + x * cos - y * sin, pose.y + x * sin + y * cos) for x, y in sides])


def least_clearance(poses: Any, polygons: Any, car: Any) -> Any:
    """Return the least distance [m] of the outline to any polygon."""
    things = shapely.union_all([Polygon(polygon).buffer(0) for polygon in polygons])
    return float(shapely.distance([outline_of(pose, car) for pose in poses], things).min())


def bits_of(store: Any) -> Any:
    """Return all that a store holds, as bytes, but for the scratch space of words."""
    names = [name for name in store._fields if not name.startswith("word")]
    return {name: bytes(array(getattr(store, name).typecode, getattr(store, name))) for name in names}
