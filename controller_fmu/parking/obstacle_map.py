"""The obstacle map of one slot: landmarks, the neighbours' hidden parts, and what was never observed.

What has not been observed counts as occupied: the row goes on beyond its members, neighbours are as deep as a car, the
gap ends where a car's length ends unless something was detected before, and across the road and ahead no more is free
than the sensors reach.
"""

from typing import NamedTuple

from controller_fmu.parking.geometry.frames import point_from_frame
from controller_fmu.parking.geometry.outline import VehicleOutline
from controller_fmu.parking.geometry.polygons import VERTICES, ObstacleMap, Vertex
from controller_fmu.parking.map.landmark import LANDMARKS, Landmark, LandmarkType, end_point, start_point
from controller_fmu.parking.map.local_map import is_confirmed
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.monitor.collision_monitor import EchoObstacle
from controller_fmu.parking.slots.candidate import CAR_LENGTH, CAR_WIDTH, SlotCandidate, SlotType
from modelkit.vocabulary import Pose

LANDMARK_VERTICES = 2 * LANDMARKS
REMEMBERED = 8
"""Unexplained echoes that are kept for planning."""
BEYOND = 10.0
"""The row and the road go on for this far [m]."""
BEHIND_VEHICLE = 0.6
"""A gap of unknown depth is taken to end this far [m] behind the vehicle in it."""
SLOT_QUADS = 7
ECHO_SIZE = 0.1
"""Side [m] of the square that an unexplained echo becomes."""


class Quad(NamedTuple):
    """A rectangle along a row, from (x0, y0) to (x1, y1) in the row's frame [m], y away from the road."""

    x0: float = 0.0
    y0: float = 0.0
    x1: float = 0.0
    y1: float = 0.0
    is_used: bool = False


def obstacle_map(
    landmarks: tuple[Landmark, ...],
    slot: SlotCandidate,
    echoes: tuple[EchoObstacle, ...],
    outline: VehicleOutline,
    road: Pose,
    mapping: MappingParams,
) -> ObstacleMap:
    """Return the polygons around a slot; ``road``: x free ahead, y to the road's other side, in the row's frame."""
    quads = _slot_quads(slot, outline, road)
    return ObstacleMap(
        tuple(
            _landmark_vertex(landmarks[number // 2 if number < LANDMARK_VERTICES else 0], number, mapping)
            if number < LANDMARK_VERTICES
            else _quad_vertex(quads, echoes, slot, number - LANDMARK_VERTICES)
            for number in range(VERTICES)
        )
    )


def _landmark_vertex(landmark: Landmark, number: int, mapping: MappingParams) -> Vertex:
    if not is_confirmed(landmark, mapping):
        return Vertex()
    polygon = 1 + number // 2
    if number % 2 == 0:
        point = start_point(landmark)
        return Vertex(point.x, point.y, polygon)
    if landmark.type == LandmarkType.POINT:
        return Vertex()
    point = end_point(landmark)
    return Vertex(point.x, point.y, polygon)


def _quad_vertex(quads: tuple[Quad, ...], echoes: tuple[EchoObstacle, ...], slot: SlotCandidate, number: int) -> Vertex:
    """Return a vertex of the quads about the slot, then of the remembered echoes."""
    index = number // 4
    corner = number % 4
    if index < SLOT_QUADS:
        quad = quads[index if index < SLOT_QUADS else 0]
        if not quad.is_used:
            return Vertex()
        x = quad.x0 if corner == 0 or corner == 3 else quad.x1
        y = quad.y0 if corner < 2 else quad.y1
        point = point_from_frame(x, slot.row.side * y, slot.row.frame)
        return Vertex(point.x, point.y, LANDMARKS + 1 + index)
    at = index - SLOT_QUADS
    if at >= REMEMBERED:
        return Vertex()
    echo = echoes[min(max(at, 0), REMEMBERED - 1)]
    if not echo.is_present:
        return Vertex()
    half = 0.5 * ECHO_SIZE
    dx = -half if corner == 0 or corner == 3 else half
    dy = -half if corner < 2 else half
    return Vertex(echo.x + dx, echo.y + dy, LANDMARKS + 1 + index)


def _slot_quads(slot: SlotCandidate, outline: VehicleOutline, road: Pose) -> tuple[Quad, ...]:
    """Return neighbours, end, row beyond both, the road's other side and its end ahead."""
    if slot.type == SlotType.NONE:
        return (Quad(),) * SLOT_QUADS
    parallel = slot.type == SlotType.PARALLEL
    length = CAR_LENGTH if parallel else CAR_WIDTH
    body = CAR_WIDTH if parallel else CAR_LENGTH
    needed = 2.0 * (outline.half_width if parallel else outline.half_length) + BEHIND_VEHICLE
    end = slot.front + min(slot.depth, needed)
    a = slot.behind
    b = slot.ahead
    first = min(a.start, a.end - length)
    last = max(b.end, b.start + length)
    return (
        Quad(first, a.front, a.end, max(end, a.front + body), True),
        Quad(b.start, b.front, last, max(end, b.front + body), True),
        Quad(a.end, end, b.start, end, True),
        Quad(first - BEYOND, a.front, first, a.front, True),
        Quad(last, b.front, last + BEYOND, b.front, True),
        Quad(first - BEYOND, road.y, last + BEYOND, road.y, True),
        Quad(road.x, road.y, road.x, min(a.front, b.front), True),
    )


def remember_echoes(before: tuple[EchoObstacle, ...], echoes: tuple[EchoObstacle, ...]) -> tuple[EchoObstacle, ...]:
    """Return the remembered echoes with those present now; the oldest are forgotten."""
    after = before
    for echo in echoes:
        if echo.is_present:
            after = after[1:] + (echo,)
    return after
