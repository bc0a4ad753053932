"""A scene of ParkBench (Tao et al. 2026, arXiv 2601.22545) as a scenario.

A file holds poses of the rear axle and polylines, in metres and radians. Start and target are given relative to
``m_origin``, obstacles relative to ``m_nfmOrigin``; here the target is the origin. Each piece of a polyline becomes a
wall, a polygon of two corners. Not taken over, and counted in the description:

- what lies in the outline at the target, grown by the tolerance of the scene's target, since the vehicle stands there;
- a low object (wheel stop) that reaches into it, as a whole;
- points farther than 60 m from start and target (the data have outliers at up to 17 km).
"""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

from controller_fmu import APART
from orchestrator.inputs.scenario.models import APART as SYSTEMS
from orchestrator.inputs.scenario.obstacle_map import map_capacity
from orchestrator.inputs.scenario.tpcap import MIN_PLAN_MARGIN, PLAN_MARGIN, STOP_TIME
from orchestrator.inputs.text.errors import BadInput

MAX_DISTANCE = 60.0
"""What lies farther from start and target [m] is left out: the data have outliers at up to 17 km."""
DEFAULT_TOLERANCE = 0.05
"""[m]"""
STEERING_RATIO = 16.0
"""Steering-wheel angle over front-wheel angle; scenes state the front-wheel angle alone."""
LOW = "LOW"
SOURCE = "ParkBench, https://github.com/dqm5rtfg9b-collab/Constrained_Parking_Scenarios, CC-BY-NC 4.0"
Point = tuple[float, float]
Piece = tuple[Point, Point]
Pose = tuple[float, float, float]


class VehicleSize(NamedTuple):
    """The vehicle of a scene about its rear axle [m], and its largest front-wheel angle [rad]."""

    front: float = 3.925
    rear: float = 1.024
    half_width: float = 0.988
    wheelbase: float = 3.0
    lock: float = math.radians(35.0)


DEFAULT_VEHICLE = VehicleSize()
"""Body of the vehicle that most scenes state (14 of 23; 28 state none)."""


def read_parkbench(path: Path) -> dict[str, Any]:
    """Return the scenario of a scene as plain data for YAML. Raises ``BadInput``."""
    scene = _Scene(path)
    target = scene.target
    vehicle = scene.vehicle()
    walls, left_out = _walls(scene, target, vehicle)
    corners = 2 * len(walls)
    system = next((name for name in ("apa", "apa_large") if corners <= map_corners(name)), "")
    if not system:
        raise BadInput(f"{corners} corners, the largest map holds {map_corners('apa_large')}", file=path)
    start = scene.start
    return {
        "name": path.stem,
        "title": f"ParkBench, {path.stem}",
        "description": f"Not taken over, since it lies in the outline at the target or far away: {left_out} pieces.",
        "source": SOURCE,
        "car": _car(vehicle),
        "stop_time": STOP_TIME,
        "target": {"x": 0.0, "y": 0.0, "heading": target[2]},
        "obstacles": [[list(a), list(b)] for a, b in walls],
        "vehicle": {"start": {"x": start[0] - target[0], "y": start[1] - target[1], "heading": start[2]}},
        "controller": {
            "system": system,
            "search": {"active": False},
            "plan": {"margin": PLAN_MARGIN, "min_margin": MIN_PLAN_MARGIN},
        },
        "requirements": ["valet"],
        "expected_outcome": "parked",
    }


def map_corners(system: str) -> int:
    """Return how many corners the map of a controller of its own holds."""
    return map_capacity(APART[SYSTEMS[system]].params)


class _Scene:
    """What a file says, checked where it is read."""

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            content = json.loads(path.read_text(encoding="utf-8-sig"))
        except (OSError, UnicodeDecodeError, ValueError, RecursionError) as error:
            raise BadInput(f"cannot be read as JSON: {error}", file=path) from error
        frames = self._mapping(self._mapping(content, "").get("Frames"), "Frames")
        self._frame = self._mapping(frames.get("0"), "Frames.0")
        self._request = self._mapping(self._frame.get("PlanningRequest"), "PlanningRequest")
        x, y = self._point(self._request.get("m_origin", (0.0, 0.0)), "m_origin")
        own_x, own_y = self._point(self._frame.get("m_nfmOrigin", (0.0, 0.0)), "m_nfmOrigin")
        self._shift = (x - own_x, y - own_y)
        self.start = self._pose(self._request.get("m_startPosture"), "m_startPosture")
        self._area = self._target_area()
        posture = self._area.get("m_targetPosture")
        posture = posture[0] if isinstance(posture, list) and posture else posture
        self.target = self._pose(posture, "m_targetPosture")

    def tolerance(self) -> float:
        """Return how far [m] from the target the vehicle may stand."""
        names = ("m_lateralTolerance", "m_longitudinalTolerance")
        return max(self._number(self._area.get(name, DEFAULT_TOLERANCE), name) for name in names)

    def vehicle(self) -> VehicleSize:
        """Return the vehicle that the scene states, as the rectangle about its contour; else the default."""
        given = self._request.get("m_pmpParams") or self._request.get("m_params")
        if given is None:
            return DEFAULT_VEHICLE
        given = self._mapping(given, "m_pmpParams")
        contour = self._mapping(given.get("m_vehicleContour", given.get("m_vehicleParams")), "m_vehicleContour")
        xs = [*self._numbers(contour, "m_vehContourFrontX"), *self._numbers(contour, "m_vehContourSideX")]
        front, rear = max(xs), -min(self._numbers(contour, "m_vehContourRearX"))
        half_width = max(map(abs, self._numbers(contour, "m_vehContourSideY")))
        limits = self._mapping(
            given.get("m_vehicleKinematicConstraintParams", {}), "m_vehicleKinematicConstraintParams"
        )
        lock = self._number(limits.get("m_maxFrontSteeringAngle", DEFAULT_VEHICLE.lock), "m_maxFrontSteeringAngle")
        wheelbase = self._number(limits.get("m_wheelBase", self._wheelbase()), "m_wheelBase")
        found = VehicleSize(front, rear, half_width, wheelbase, lock)
        if not (0.0 < found.wheelbase < front and rear > 0.0 and half_width > 0.3 and 0.1 < lock < 1.4):
            raise self._wrong("m_vehicleContour", f"{found}: expected a vehicle about its rear axle, in metres")
        return found

    def objects(self) -> Iterator[tuple[list[Point], bool]]:
        """Yield each polyline and whether it is low."""
        items = self._frame.get("NfmAggregatedPolygonObjects")
        if not isinstance(items, list):
            raise self._wrong("NfmAggregatedPolygonObjects", "expected a list of objects")
        for number, item in enumerate(items, start=1):
            key = f"NfmAggregatedPolygonObjects[{number}]"
            nodes = self._mapping(item, key).get("nfmPolygonObjectNodes")
            if not isinstance(nodes, list) or len(nodes) < 2:
                raise self._wrong(key, "expected two or more nfmPolygonObjectNodes")
            nodes = [self._mapping(node, key) for node in nodes]
            points = [self._point((node.get("m_x"), node.get("m_y")), key) for node in nodes]
            yield points, all(str(node.get("m_height", "")).rpartition("::")[2] == LOW for node in nodes)

    def _target_area(self) -> Mapping[str, Any]:
        area = self._request.get("m_targetArea", self._request.get("m_targetAreas"))
        return self._mapping(area, "m_targetArea")

    def _wheelbase(self) -> float:
        """Return the wheelbase [m] by the stated front-wheel angle and curvature, tan(angle) = curvature wheelbase."""
        state = self._mapping(self._request.get("m_vehicleData", {}), "m_vehicleData")
        angle = self._number(state.get("m_steeringAngleFront", 0.0), "m_steeringAngleFront")
        curvature = self._number(state.get("m_vehicleCurvature", 0.0), "m_vehicleCurvature")
        return math.tan(angle) / curvature if abs(curvature) > 1e-6 else DEFAULT_VEHICLE.wheelbase

    def _pose(self, value: object, key: str) -> Pose:
        found = self._mapping(value, key).get("m_pose")
        if not isinstance(found, list) or len(found) != 3:
            raise self._wrong(f"{key}.m_pose", "expected x, y [m] and heading [rad]")
        x, y, heading = (self._number(item, f"{key}.m_pose") for item in found)
        if abs(heading) > 2.0 * math.pi:
            raise self._wrong(f"{key}.m_pose", f"heading {heading:g}: expected radians, at most one turn")
        return x + self._shift[0], y + self._shift[1], heading

    def _numbers(self, contour: Mapping[str, Any], key: str) -> list[float]:
        found = contour.get(key)
        if not isinstance(found, list) or not found:
            raise self._wrong(key, "expected a list of metres")
        return [self._number(item, key) for item in found]

    def _point(self, value: Any, key: str) -> Point:
        if not isinstance(value, list | tuple) or len(value) != 2:
            raise self._wrong(key, "expected x and y [m]")
        return self._number(value[0], key), self._number(value[1], key)

    def _number(self, value: object, key: str) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e8:
            raise self._wrong(key, f"{value!r}: expected a finite number")
        return float(value)

    def _mapping(self, value: object, key: str) -> Mapping[str, Any]:
        if not isinstance(value, Mapping):
            raise self._wrong(key, "expected an object of a ParkBench scene")
        return value

    def _wrong(self, key: str, text: str) -> BadInput:
        return BadInput(text, file=self.path, key=key or None)


def _walls(scene: _Scene, target: Pose, vehicle: VehicleSize) -> tuple[list[Piece], int]:
    """Return the walls seen from the target, and how many pieces were not taken over, wholly or in part."""
    walls: list[Piece] = []
    left_out, margin = 0, scene.tolerance()
    ends = [(scene.start[0] - target[0], scene.start[1] - target[1]), (0.0, 0.0)]
    for points, is_low in scene.objects():
        seen = [(x - target[0], y - target[1]) for x, y in points]
        pieces = [(a, b) for a, b in pairwise(seen) if a != b]
        parts = [_parts_outside(piece, target[2], vehicle, margin) for piece in pieces]
        if is_low and parts != [[piece] for piece in pieces]:
            left_out += len(pieces)
            continue
        for piece, found in zip(pieces, parts, strict=True):
            kept = found if _is_near(piece, ends) else []
            left_out += kept != [piece]
            walls += kept
    return walls, left_out


def _is_near(piece: Piece, places: Sequence[Point]) -> bool:
    return all(min(math.dist(end, place) for place in places) < MAX_DISTANCE for end in piece)


def _parts_outside(piece: Piece, heading: float, vehicle: VehicleSize, margin: float) -> list[Piece]:
    """Return the parts of a piece outside the outline at the target, grown by ``margin`` [m] (Liang, Barsky 1984)."""
    (ax, ay), (bx, by) = piece
    c, s = math.cos(heading), math.sin(heading)
    sides = (
        (ax * c + ay * s, (bx - ax) * c + (by - ay) * s, -vehicle.rear - margin, vehicle.front + margin),
        (ay * c - ax * s, (by - ay) * c - (bx - ax) * s, -vehicle.half_width - margin, vehicle.half_width + margin),
    )
    enter, leave = 0.0, 1.0
    for at, rate, low, high in sides:
        if rate == 0.0:
            if not low < at < high:
                return [piece]
            continue
        first, last = sorted(((low - at) / rate, (high - at) / rate))
        enter, leave = max(enter, first), min(leave, last)
    if enter >= leave:
        return [piece]
    before, after = ((ax + t * (bx - ax), ay + t * (by - ay)) for t in (enter, leave))
    parts = [((ax, ay), before)] if enter > 0.0 else []
    return parts + ([(after, (bx, by))] if leave < 1.0 else [])


def _car(vehicle: VehicleSize) -> dict[str, Any]:
    """Return the car of a scenario: the vehicle's dimensions, all else as the car of TPCAP."""
    return {
        "extends": "tpcap",
        "wheelbase": round(vehicle.wheelbase, 4),
        "front_overhang": round(vehicle.front - vehicle.wheelbase, 4),
        "rear_overhang": round(vehicle.rear, 4),
        "width": round(2.0 * vehicle.half_width, 4),
        "cg_to_rear": round(0.5 * vehicle.wheelbase, 4),
        "steering": {"ratio": STEERING_RATIO, "angle_limit": round(STEERING_RATIO * vehicle.lock, 4)},
    }
