"""Scenes for the planner, and a judge that knows nothing of it: shapely."""

import math
import os
from array import array
from pathlib import Path
from typing import Any

import shapely
from shapely.geometry import Polygon

from controller_fmu.planning.plan import PLANNING, begin, search_to, take_corner
from controller_fmu.planning.plan_store import COUNT, KEPT_COUNT, STATUS, PlanStore
from controller_fmu.planning.task import CORNERS, Corner, PlannedCar, Request, drive
from modelkit.store import new_store
from modelkit.vocabulary import Pose
from tests.planning.plan_model import Scene

CAR = PlannedCar(1.4155, 2.3445, 0.971, math.tan(0.75) / 2.8)
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
    corners = [Corner(x, y, number + 1) for number, polygon in enumerate(polygons) for x, y in polygon]
    return Scene(tuple(corners + [Corner()] * (CORNERS - len(corners))))


def take(store: Any, scene: Any) -> None:
    """Let the planner take over a scene."""
    for number, corner in enumerate(scene.corners):
        take_corner(store, number, corner)


def plan(request: Request, scene: Any, store: Any = None, at_a_time: Any = 200, most: Any = 4000) -> Any:
    """Return the store after the search for ``request`` has ended."""
    store = new_store(PlanStore) if store is None else store
    take(store, scene)
    begin(store, request)
    for count in range(at_a_time, most, at_a_time):
        search_to(store, request, count)
        if store.mark[STATUS] != PLANNING:
            break
    return store


def kept(store: Any) -> Any:
    """Return the path as (way, curvature) pairs."""
    return [(store.kept_way[at], store.kept_k[at]) for at in range(store.mark[KEPT_COUNT])]


def poses_along(start: Any, pieces: Any, step: Any = 0.01) -> Any:
    """Return poses along a path at most ``step`` [m] apart, its end last."""
    found = []
    for way, k in pieces:
        count = max(1, math.ceil(abs(way) / step))
        found += [drive(start, way * number / count, k) for number in range(count)]
        start = drive(start, way, k)
    return [*found, start]


def outline_of(pose: Any, car: Any) -> Any:
    """Return the car's outline as a polygon of shapely."""
    cos, sin = math.cos(pose.heading), math.sin(pose.heading)
    sides = [(car.ahead + a * car.half_length, b * car.half_width) for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    return Polygon([(pose.x + x * cos - y * sin, pose.y + x * sin + y * cos) for x, y in sides])


def least_clearance(poses: Any, polygons: Any, car: Any) -> Any:
    """Return the least distance [m] of the outline to any polygon."""
    things = shapely.union_all([Polygon(polygon).buffer(0) for polygon in polygons])
    return float(shapely.distance([outline_of(pose, car) for pose in poses], things).min())


def bits_of(store: Any) -> Any:
    """Return all that a store holds, as bytes, but for the scratch space of words."""
    names = [name for name in store._fields if not name.startswith("word")]
    return {name: bytes(array(getattr(store, name).typecode, getattr(store, name))) for name in names}


__all__ = ["COUNT", "Request"]
