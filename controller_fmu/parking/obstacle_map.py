"""The obstacle map of one slot: landmarks, the neighbours' hidden parts, and what was never observed.

What has not been observed counts as occupied: the row goes on beyond its members, neighbours are as deep as a car, the
gap ends where a car's length ends unless something was detected before, and across the road and ahead no more is free
than the sensors reach. But where the vehicle stands is free, whatever was taken for occupied or measured there.
"""

import math
from typing import NamedTuple

from controller_fmu.parking.geometry.frames import point_from_frame
from controller_fmu.parking.geometry.outline import VehicleOutline, outline_frame
from controller_fmu.parking.geometry.polygons import (
    LOCAL_VERTICES,
    ObstacleMap,
    Vertex,
    next_index,
    segment_distance_squared,
)
from controller_fmu.parking.map.landmark import MAX_LANDMARKS, Landmark, LandmarkType, end_point, offset_of, start_point
from controller_fmu.parking.map.local_map import is_confirmed
from controller_fmu.parking.map.params import CAR_LENGTH, CAR_WIDTH, MappingParams
from controller_fmu.parking.measurement.sensor import MAX_SENSORS
from controller_fmu.parking.monitor.collision_monitor import (
    EchoObstacle,
    landmark_distance,
    line_distance,
    side_end,
    side_start,
)
from controller_fmu.parking.slots.candidate import SlotCandidate, SlotType
from modelkit.geometry import Point
from modelkit.vocabulary import Pose

LANDMARK_VERTICES = 2 * MAX_LANDMARKS
ROW_EXTENSION = 10.0
"""The row and the road go on for this far [m], and what ends them is so thick."""
BEHIND_VEHICLE = 0.6
"""A gap of unknown depth is taken to end this far [m] behind the vehicle in it."""
SLOT_QUADS = 7
"""Rectangles about a slot: neighbours, what is behind it, row and road."""
QUAD_VERTICES = 4 * SLOT_QUADS
ECHO_VERTICES = 4 * MAX_SENSORS
ECHO_SIZE = 0.1
"""Side [m] of the square that an unexplained echo becomes."""
START_CLEARANCE = 0.05
"""What stands nearer [m] than this to a standing vehicle is taken to stand so far: else no path could begin there."""


class Quad(NamedTuple):
    """A rectangle along a row, from (x0, y0) to (x1, y1) in its frame [m], y away from the road; x0 = x1: none."""

    x0: float = 0.0
    y0: float = 0.0
    x1: float = 0.0
    y1: float = 0.0
    slope: float = 0.0
    """A line beside an angled row: y at x0 and x1 is moved by this times the distance from ``pivot``."""
    pivot: float = 0.0


def obstacle_map(
    landmarks: tuple[Landmark, ...],
    slot: SlotCandidate,
    outline: VehicleOutline,
    vehicle: Pose,
    road: Point,
    mapping: MappingParams,
) -> ObstacleMap:
    """Return the polygons around a slot that keep ``START_CLEARANCE`` from the outline of the vehicle.

    The road is free up to x ahead, and y to its other side, in the row's frame.
    """
    quads = _slot_quads(slot, outline, road)
    quads = tuple(Quad() if _touches(quad, slot, outline, vehicle) else quad for quad in quads)
    return ObstacleMap(
        tuple(_landmark_vertex(landmarks[number // 2], number, mapping) for number in range(LANDMARK_VERTICES))
        + tuple(_quad_vertex(quads[number // 4], number, slot) for number in range(QUAD_VERTICES))
        + (Vertex(),) * (LOCAL_VERTICES - LANDMARK_VERTICES - QUAD_VERTICES)
    )


def with_echoes(obstacles: ObstacleMap, echoes: tuple[EchoObstacle, ...]) -> ObstacleMap:
    """Return the polygons around a slot with those of the echoes, for which ``obstacle_map`` leaves room."""
    before = LANDMARK_VERTICES + QUAD_VERTICES
    return ObstacleMap(
        obstacles.vertices[:before]
        + tuple(_echo_vertex(echoes[number // 4], number) for number in range(ECHO_VERTICES))
        + obstacles.vertices[before + ECHO_VERTICES :]
    )


def is_on_map(landmark: Landmark, known: tuple[Vertex, ...], tolerance: float) -> bool:
    """Return whether both ends of a landmark lie within ``tolerance`` [m] of an edge of a map that is given."""
    for point in (start_point(landmark), end_point(landmark)):
        is_near = False
        for number in range(len(known)):
            a = known[number]
            if a.polygon > 0:
                b = known[next_index(known, number)]
                square = segment_distance_squared(point.x - a.x, point.y - a.y, b.x - a.x, b.y - a.y)
                is_near = is_near or square < tolerance * tolerance
        if not is_near:
            return False
    return True


def _touches(quad: Quad, slot: SlotCandidate, outline: VehicleOutline, vehicle: Pose) -> bool:
    """Return whether an edge of a rectangle about the slot is nearer to the vehicle than ``START_CLEARANCE``."""
    frame = outline_frame(vehicle)
    for number in range(4):
        a = _quad_vertex(quad, number, slot)
        b = _quad_vertex(quad, (number + 1) % 4, slot)
        if line_distance(Point(a.x, a.y), Point(b.x, b.y), frame, outline) < START_CLEARANCE:
            return True
    return False


def away_from_vehicle(landmark: Landmark, outline: VehicleOutline, vehicle: Pose) -> Landmark:
    """Return a landmark at least ``START_CLEARANCE`` from the vehicle that stands beside it, moved along its normal."""
    distance = landmark_distance(landmark, vehicle, outline)
    if distance >= START_CLEARANCE:
        return landmark
    centre = point_from_frame(outline.centre_ahead, 0.0, vehicle)
    nx = landmark.x - centre.x
    ny = landmark.y - centre.y
    if landmark.type == LandmarkType.SEGMENT:
        away = -1.0 if offset_of(landmark, centre.x, centre.y) > 0.0 else 1.0
        nx = -away * math.sin(landmark.heading)
        ny = away * math.cos(landmark.heading)
    length = max(math.sqrt(nx * nx + ny * ny), START_CLEARANCE)
    shift = (START_CLEARANCE - distance) / length
    return landmark._replace(x=landmark.x + shift * nx, y=landmark.y + shift * ny)


def echo_away_from_vehicle(echo: EchoObstacle, outline: VehicleOutline, vehicle: Pose) -> EchoObstacle:
    """Return an echo whose side lies ``START_CLEARANCE`` or more from a standing vehicle, moved from its sensor."""
    distance = line_distance(side_start(echo), side_end(echo), outline_frame(vehicle), outline)
    shift = max(START_CLEARANCE - distance, 0.0)
    return echo._replace(x=echo.x + shift * echo.ux, y=echo.y + shift * echo.uy)


def _landmark_vertex(landmark: Landmark, number: int, mapping: MappingParams) -> Vertex:
    is_start = number % 2 == 0
    if not is_confirmed(landmark, mapping) or (landmark.type == LandmarkType.POINT and not is_start):
        return Vertex()
    point = start_point(landmark) if is_start else end_point(landmark)
    return Vertex(point.x, point.y, 1 + number // 2)


def _quad_vertex(quad: Quad, number: int, slot: SlotCandidate) -> Vertex:
    """Return a vertex of a rectangle about the slot, by its ``number`` among those of all of them."""
    if slot.type == SlotType.NONE or quad.x0 >= quad.x1:
        return Vertex()
    corner = number % 4
    x = quad.x0 if corner == 0 or corner == 3 else quad.x1
    y = (quad.y0 if corner < 2 else quad.y1) + slot.row.side * quad.slope * (x - quad.pivot)
    point = point_from_frame(x, slot.row.side * y, slot.row.frame)
    return Vertex(point.x, point.y, MAX_LANDMARKS + 1 + number // 4)


def _echo_vertex(echo: EchoObstacle, number: int) -> Vertex:
    """Return a vertex of the square about an unexplained echo, or of the side that another one is of."""
    if not echo.is_present:
        return Vertex()
    corner = number % 4
    polygon = MAX_LANDMARKS + 1 + SLOT_QUADS + number // 4
    if not echo.is_unexplained:
        end = side_start(echo) if corner == 0 else side_end(echo)
        return Vertex(end.x, end.y, polygon if corner < 2 else 0)
    half = 0.5 * ECHO_SIZE
    dx = -half if corner == 0 or corner == 3 else half
    dy = -half if corner < 2 else half
    return Vertex(echo.x + dx, echo.y + dy, polygon)


def _slot_quads(slot: SlotCandidate, outline: VehicleOutline, road: Point) -> tuple[Quad, ...]:
    """Return neighbours, end, row beyond both, the road's other side and its end ahead."""
    parallel = slot.type == SlotType.PARALLEL
    length = CAR_LENGTH if parallel else CAR_WIDTH
    body = CAR_WIDTH if parallel else CAR_LENGTH
    needed = 2.0 * (outline.half_width if parallel else outline.half_length) + BEHIND_VEHICLE
    end = slot.front + min(slot.depth, needed)
    a = slot.behind
    b = slot.ahead
    first = min(a.start, a.end - length)
    last = max(b.end, b.start + length)
    behind = max(end, a.front + body)
    ahead = max(end, b.front + body)
    far = road.y - ROW_EXTENSION
    return (
        Quad(first, a.front, a.end, behind),
        Quad(b.start, b.front, last, ahead),
        Quad(a.end, end, b.start, end + ROW_EXTENSION),
        Quad(first - ROW_EXTENSION, a.front, first, behind, slot.row.slope, a.end),
        Quad(last, b.front, last + ROW_EXTENSION, ahead, slot.row.slope, b.start),
        Quad(first - ROW_EXTENSION, far, last + ROW_EXTENSION, road.y, slot.row.slope, road.x),
        Quad(road.x, road.y, road.x + ROW_EXTENSION, min(a.front, b.front)),
    )
