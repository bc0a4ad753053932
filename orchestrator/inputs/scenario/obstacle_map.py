"""Static obstacles of a scenario as the map of a controller: polygons, boxes, kerbs."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

from modelkit.variables import variables
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput

NEVER_TIME = 1e9
Points = list[tuple[float, float]]


def map_of(scenario: Scenario) -> dict[str, float | int | bool]:
    """Return the parameters ``map`` of a controller that has one. Raises ``BadInput`` if it holds fewer corners."""
    room = map_capacity(scenario.models["controller"].params)
    if not room:
        return {}
    polygons = enumerate(obstacles_of_map(scenario), start=1)
    corners = [(x, y, number) for number, polygon in polygons for x, y in polygon]
    if room < len(corners):
        raise BadInput(f"{len(corners)} corners, the map holds {room}", file=scenario.file, key="obstacles")
    parameters: dict[str, float | int | bool] = {}
    for place, (x, y, number) in enumerate(corners, start=1):
        parameters |= {f"map[{place}].x": x, f"map[{place}].y": y, f"map[{place}].polygon": number}
    return parameters


def map_capacity(params: type[Any]) -> int:
    """Return how many corners the map among the parameters of a controller holds, 0 without a map."""
    return sum(item.name.startswith("map[") for item in variables(params)) // 3


def obstacles_of_map(scenario: Scenario) -> list[Points]:
    """Return the corners [m] of the polygons of a map: static obstacles, and kerbs as walls."""
    return [*static_obstacles(scenario), *_kerbs(scenario.vehicle)]


def static_obstacles(scenario: Scenario) -> list[Points]:
    """Return the corners [m] of all polygons, and of the boxes that are there all the time and do not move."""
    return [*scenario.obstacles, *_boxes(scenario.vehicle)]


def _boxes(vehicle: Mapping[str, float]) -> Iterator[Points]:
    """Yield the corners of the boxes that neither come nor go nor move."""
    for box in items_of(vehicle, "scene.boxes").values():
        stays = not box.get("appear_at", 0.0) and box.get("disappear_at", NEVER_TIME) >= NEVER_TIME
        stays = stays and not box.get("speed_x", 0.0) and not box.get("speed_y", 0.0)
        if stays and box.get("length", 0.0) > 0.0:
            yield box_corners(box)


def box_corners(box: Mapping[str, float]) -> Points:
    """Return the corners [m] of a box given by x, y, heading, length, width."""
    c, s = math.cos(box.get("heading", 0.0)), math.sin(box.get("heading", 0.0))
    a, b = 0.5 * box.get("length", 0.0), 0.5 * box.get("width", 0.0)
    x, y = box.get("x", 0.0), box.get("y", 0.0)
    return [(x + u * c - v * s, y + u * s + v * c) for u, v in ((a, b), (-a, b), (-a, -b), (a, -b))]


def _kerbs(vehicle: Mapping[str, float]) -> Iterator[Points]:
    for kerb in items_of(vehicle, "scene.kerbs").values():
        if kerb.get("height", 0.0) > 0.0:
            yield [(kerb.get("x1", 0.0), kerb.get("y1", 0.0)), (kerb.get("x2", 0.0), kerb.get("y2", 0.0))]


def items_of(parameters: Mapping[str, float], array: str) -> dict[int, dict[str, float]]:
    """Return number -> fields of each element of an array of parameters that is given, in order."""
    found: dict[int, dict[str, float]] = {}
    for name, value in parameters.items():
        if name.startswith(f"{array}["):
            number, _, field = name[len(array) + 1 :].partition("].")
            found.setdefault(int(number), {})[field] = value
    return dict(sorted(found.items()))
