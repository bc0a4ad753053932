"""Correction of a slot while the vehicle enters it: by the neighbours' flanks, and by the obstacle at its end."""

import math

from controller_fmu.parking.geometry.frames import point_to_frame
from controller_fmu.parking.geometry.outline import VehicleOutline
from controller_fmu.parking.map.landmark import Landmark, LandmarkType, length_of, offset_variance, segment_point
from controller_fmu.parking.map.local_map import is_confirmed
from controller_fmu.parking.map.params import CAR_WIDTH, MappingParams
from controller_fmu.parking.slots.candidate import SlotCandidate, SlotType, gap_depth
from controller_fmu.parking.slots.row import is_too_short_for_car
from modelkit.geometry import Point
from modelkit.maths import wrap_angle

MIN_CORRECTION_GATE = 0.2
CORRECTION_GATE_SIGMA = 3.0
"""Flank and corner of one car differ by at most three standard deviations of both, and 0.2 m where they claim to be
known better: corners err by 7 cm rms after entering."""
MIN_FLANK = 0.5
"""A shorter side [m] is no flank of a car; in the gap it may be a pillar's."""
MIN_FACE = 0.2
"""And this [m] of a neighbour's end: the distance of two sensors."""
MAX_FACE_ANGLE = 0.35
"""Such an end is known less exactly, and cars stand misaligned [rad]."""
MAX_ANGLE = 0.2
"""A flank is turned by less than this [rad] against the direction into the slot: cars stand within 10 deg."""


def _with_edge(
    corrected: SlotCandidate, candidate: SlotCandidate, x: float, sigma: float, is_of_car: bool
) -> SlotCandidate:
    """Return a slot with the edge that a flank at ``x`` [m] along its row is; ``is_of_car``: of no pillar.

    Where it is the edge known so far, within what that is uncertain, both count by how well they are known, and are
    known no better than the better one: they come from the same echoes. Else it bounds the gap wherever it stands in
    it: the corner seen from the road may have been moving. The first flank of a car may be as far out as half of it,
    since the car may have moved away; any other one out there stands behind a pillar.
    """
    is_behind = x < 0.5 * (candidate.behind.end + candidate.ahead.start)
    initial = candidate.behind.end if is_behind else candidate.ahead.start
    before = corrected.behind.end if is_behind else corrected.ahead.start
    is_first = before == initial
    known = corrected.behind.end_sigma if is_behind else corrected.ahead.start_sigma
    known = correction_gate(known) / CORRECTION_GATE_SIGMA if is_first else known
    gate = correction_gate(math.sqrt(known * known + sigma * sigma))
    inside = x - before if is_behind else before - x
    if abs(inside) < gate:
        x = before + known * known / (known * known + sigma * sigma) * (x - before)
        sigma = min(known, sigma)
    elif inside < 0.0 and not (is_first and is_of_car and inside > -0.5 * CAR_WIDTH):
        return corrected
    if is_behind:
        return corrected._replace(behind=corrected.behind._replace(end=x, end_sigma=sigma))
    return corrected._replace(ahead=corrected.ahead._replace(start=x, start_sigma=sigma))


def correction_gate(sigma: float) -> float:
    """Return by how much [m] two measurements of one edge may differ, ``sigma`` [m] being their standard deviation."""
    return max(MIN_CORRECTION_GATE, CORRECTION_GATE_SIGMA * sigma)


def correct_slot(
    candidate: SlotCandidate, landmarks: tuple[Landmark, ...], outline: VehicleOutline, params: MappingParams
) -> SlotCandidate:
    """Return the slot between what has been measured of its neighbours' sides that face it, as deep as is known now."""
    corrected = candidate
    for landmark in landmarks:
        if is_confirmed(landmark, params):
            middle = segment_point(landmark, 0.5 * (landmark.start + landmark.end))
            point = point_to_frame(middle.x, middle.y, candidate.row.frame)
            if candidate.type != SlotType.PARALLEL:
                corrected = _beside_flank(corrected, candidate, landmark, point, outline)
            elif _is_end_of_neighbour(landmark, candidate, point):
                sigma = math.sqrt(offset_variance(landmark, 0.5 * (landmark.start + landmark.end)))
                corrected = _with_edge(corrected, candidate, point.x, sigma, False)
    return corrected._replace(depth=min(candidate.depth, gap_depth(corrected, landmarks, outline, params)))


def _is_end_of_neighbour(side: Landmark, candidate: SlotCandidate, middle: Point) -> bool:
    """Return whether a side is a neighbour's end beside a parallel slot; its middle [m] is in the row's frame."""
    deep = candidate.row.side * middle.y - candidate.front
    is_long = side.type == LandmarkType.SEGMENT and length_of(side) > MIN_FACE
    return is_long and _angle_to_row(side, candidate) < MAX_FACE_ANGLE and 0.0 < deep < CAR_WIDTH


def _angle_to_row(side: Landmark, candidate: SlotCandidate) -> float:
    """Return by how much a side is turned against the direction into the slot [rad], without sign."""
    angle = wrap_angle(side.heading - candidate.row.frame.heading - 0.5 * math.pi)
    return min(abs(angle), math.pi - abs(angle))


def _beside_flank(
    corrected: SlotCandidate, candidate: SlotCandidate, landmark: Landmark, middle: Point, outline: VehicleOutline
) -> SlotCandidate:
    """Return a perpendicular slot beside a landmark, if that is a neighbour's flank, or a post or pillar in the gap.

    ``middle`` [m] is the landmark's in the row's frame.
    """
    deep = candidate.row.side * middle.y - candidate.front
    length = length_of(landmark)
    is_behind = 2.0 * middle.x < candidate.behind.end + candidate.ahead.start
    inside = middle.x - candidate.behind.end if is_behind else candidate.ahead.start - middle.x
    if landmark.type == LandmarkType.POINT or length <= MIN_FLANK:
        sigma = candidate.behind.end_sigma if is_behind else candidate.ahead.start_sigma
        room = candidate.ahead.start - candidate.behind.end - 2.0 * outline.half_width
        is_post = correction_gate(sigma) < inside < room and 0.0 < deep < 2.0 * outline.half_length
        sigma = math.sqrt(landmark.xx + landmark.yy)
        return _with_edge(corrected, candidate, middle.x, sigma, False) if is_post else corrected
    side_length = candidate.behind.end_length if is_behind else candidate.ahead.start_length
    is_of_car = not is_too_short_for_car(side_length)
    if deep > 0.0 and _angle_to_row(landmark, candidate) < MAX_ANGLE:
        turn = landmark.heading - candidate.row.frame.heading
        further = candidate.row.side * (outline.half_length - deep) / math.sin(turn)
        sigma = math.sqrt(offset_variance(landmark, 0.5 * (landmark.start + landmark.end) + further))
        return _with_edge(corrected, candidate, middle.x + further * math.cos(turn), sigma, is_of_car)
    return corrected
