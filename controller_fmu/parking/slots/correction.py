"""Correction of a slot while the vehicle enters it: by the neighbours' flanks, and by the obstacle at its end."""

import math

from controller_fmu.parking.geometry.frames import point_to_frame
from controller_fmu.parking.geometry.outline import VehicleOutline
from controller_fmu.parking.map.landmark import Landmark, LandmarkType, length_of, segment_point
from controller_fmu.parking.map.local_map import is_confirmed
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.slots.candidate import CAR_WIDTH, SlotCandidate, SlotType, gap_depth
from modelkit.geometry import Point
from modelkit.maths import wrap_angle

MIN_CORRECTION_GATE = 0.2
CORRECTION_GATE_SIGMA = 3.0
"""A flank outside the gap corrects a neighbour's corner by at most three standard deviations of that corner, and 0.2 m
where it claims to be known better: corners err by 7 cm rms after entering."""
MIN_FLANK = 0.5
"""A shorter side [m] is no flank of a car; in the gap it may be a pillar's."""
MIN_FACE = 0.2
"""And this [m] of a neighbour's end: the distance of two sensors."""
MAX_FACE_ANGLE = 0.35
"""Such an end is known less exactly, and cars stand misaligned [rad]."""
MAX_ANGLE = 0.2
"""A flank is turned by less than this [rad] against the direction into the slot: cars stand within 10 deg."""


def _with_edge(corrected: SlotCandidate, candidate: SlotCandidate, x: float) -> SlotCandidate:
    """Return a slot with the edge that a flank at ``x`` [m] along its row is.

    It bounds the gap wherever it stands in it: the corner seen from the road may have been moving. Outside the gap it
    corrects a corner by no more than that is uncertain: a flank farther out stands behind a pillar.
    """
    middle = 0.5 * (candidate.behind.end + candidate.ahead.start)
    if x < middle and x > candidate.behind.end - correction_gate(candidate.behind.end_sigma):
        return corrected._replace(behind=corrected.behind._replace(end=x))
    if x >= middle and x < candidate.ahead.start + correction_gate(candidate.ahead.start_sigma):
        return corrected._replace(ahead=corrected.ahead._replace(start=x))
    return corrected


def correction_gate(sigma: float) -> float:
    """Return by how much [m] a flank may correct a corner of standard deviation ``sigma`` [m]."""
    return max(MIN_CORRECTION_GATE, CORRECTION_GATE_SIGMA * sigma)


def correct_slot(
    candidate: SlotCandidate, landmarks: tuple[Landmark, ...], outline: VehicleOutline, params: MappingParams
) -> SlotCandidate:
    """Return the slot between what has been measured of its neighbours' sides that face it, as deep as is known now."""
    corrected = candidate
    for landmark in landmarks:
        if landmark.type == LandmarkType.SEGMENT and is_confirmed(landmark, params):
            middle = segment_point(landmark, 0.5 * (landmark.start + landmark.end))
            point = point_to_frame(middle.x, middle.y, candidate.row.frame)
            if _faces_slot(landmark, candidate, point):
                corrected = _with_edge(corrected, candidate, point.x)
    return corrected._replace(depth=min(candidate.depth, gap_depth(corrected, landmarks, outline, params)))


def _faces_slot(side: Landmark, candidate: SlotCandidate, middle: Point) -> bool:
    """Return whether a side is a neighbour's end beside a parallel slot, a flank beside a perpendicular one.

    ``middle`` [m] is its middle in the row's frame; a short side in a perpendicular gap may be a pillar's.
    """
    angle = wrap_angle(side.heading - candidate.row.frame.heading - 0.5 * math.pi)
    off = min(abs(angle), math.pi - abs(angle))
    length = length_of(side)
    deep = candidate.row.side * middle.y - candidate.front
    if length <= MIN_FACE or deep <= 0.0:
        return False
    if candidate.type == SlotType.PARALLEL:
        return off < MAX_FACE_ANGLE and deep < CAR_WIDTH
    is_within = candidate.behind.end < middle.x < candidate.ahead.start
    return off < MAX_ANGLE and (length > MIN_FLANK or is_within)
