"""Correction of a slot while the vehicle enters it: by flanks and posts beside it, and by the obstacle at its end."""

import math

from controller_fmu.parking.geometry.frames import point_to_frame
from controller_fmu.parking.geometry.outline import VehicleOutline
from controller_fmu.parking.map.landmark import Landmark, LandmarkType, length_of, offset_variance, segment_point
from controller_fmu.parking.map.local_map import is_confirmed
from controller_fmu.parking.map.params import CAR_WIDTH, MappingParams
from controller_fmu.parking.slots.candidate import SlotCandidate, SlotType, gap_depth, middle_of
from controller_fmu.parking.slots.goal import slot_middle
from controller_fmu.parking.slots.row import is_too_short_for_car

MIN_CORRECTION_GATE = 0.2
CORRECTION_GATE_SIGMA = 3.0
"""Flank and corner of one car differ by at most three standard deviations of both, and 0.2 m where they claim to be
known better: corners err by 7 cm rms after entering."""
MIN_FLANK = 0.5
"""A shorter side [m] is no flank of a car; in the gap it may be a pillar's."""
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
    is_behind = x < middle_of(candidate)
    initial = candidate.behind.end if is_behind else candidate.ahead.start
    before = corrected.behind.end if is_behind else corrected.ahead.start
    is_first = before == initial
    known = corrected.behind.end_sigma if is_behind else corrected.ahead.start_sigma
    known = correction_gate(known) / CORRECTION_GATE_SIGMA if is_first else known
    inside = x - before if is_behind else before - x
    if abs(inside) < correction_gate(math.sqrt(known * known + sigma * sigma)):
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
    slot: SlotCandidate, landmarks: tuple[Landmark, ...], outline: VehicleOutline, least: float, params: MappingParams
) -> SlotCandidate:
    """Return the slot between flanks and posts measured across the road, as deep as known; ``least`` [m] is needed."""
    corrected = slot
    for landmark in landmarks:
        if slot.type != SlotType.PARALLEL and is_confirmed(landmark, params):
            corrected = _beside_flank(corrected, slot, landmark, outline, least)
    # the line of an angled row's fronts comes nearer to the road, or goes from it, as the middle moves along the row
    rise = slot.row.side * slot.row.slope * (middle_of(corrected) - middle_of(slot))
    corrected = corrected._replace(front=slot.front + rise)
    half = outline.half_length if slot.type == SlotType.PARALLEL else outline.half_width
    depth = gap_depth(corrected, slot_middle(corrected), half, landmarks, params)
    return corrected._replace(depth=min(slot.depth - rise, depth))


def _beside_flank(
    corrected: SlotCandidate, candidate: SlotCandidate, landmark: Landmark, outline: VehicleOutline, least: float
) -> SlotCandidate:
    """Return a perpendicular slot beside a landmark, if that is a neighbour's flank, or a post or pillar in the gap."""
    along = 0.5 * (landmark.start + landmark.end)
    at = segment_point(landmark, along)
    middle = point_to_frame(at.x, at.y, candidate.row.frame)
    deep = candidate.row.side * middle.y - candidate.front
    is_behind = middle.x < middle_of(candidate)
    inside = middle.x - candidate.behind.end if is_behind else candidate.ahead.start - middle.x
    if landmark.type == LandmarkType.POINT or length_of(landmark) <= MIN_FLANK:
        sigma = candidate.behind.end_sigma if is_behind else candidate.ahead.start_sigma
        room = candidate.ahead.start - candidate.behind.end - 2.0 * outline.half_width
        # a vehicle may stand before a post that is as deep as a slot must be: it is of the slot's end
        is_post = correction_gate(sigma) < inside < room and 0.0 < deep < least
        sigma = math.sqrt(landmark.xx + landmark.yy)
        return _with_edge(corrected, candidate, middle.x, sigma, False) if is_post else corrected
    is_of_car = not is_too_short_for_car(candidate.behind.end_length if is_behind else candidate.ahead.start_length)
    turn = landmark.heading - candidate.row.frame.heading
    if deep > 0.0 and abs(math.cos(turn)) < math.sin(MAX_ANGLE):
        further = candidate.row.side * (outline.half_length - deep) / math.sin(turn)
        sigma = math.sqrt(offset_variance(landmark, along + further))
        return _with_edge(corrected, candidate, middle.x + further * math.cos(turn), sigma, is_of_car)
    return corrected
