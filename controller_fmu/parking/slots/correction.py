"""What is measured on the way into a slot corrects it: the neighbours' flanks, and what the slot ends at."""

import math

from controller_fmu.parking.geometry.frames import point_to_frame
from controller_fmu.parking.map.landmark import LANDMARKS, Landmark, LandmarkType, length_of, segment_point
from controller_fmu.parking.map.local_map import is_confirmed
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.slots.candidate import SlotCandidate, SlotType, gap_depth
from modelkit.maths import wrap_angle

MAX_CORRECTION = 0.6
"""A flank corrects a neighbour's corner by at most this [m]: the end of a side is known to 0.2 m, one sigma."""
MIN_FLANK = 0.5
"""A shorter side [m] in the slot is no flank."""
MAX_ANGLE = 0.2
"""A flank is turned by less than this [rad] against the direction into the slot: cars stand within 10 deg."""


def correct_slot(candidate: SlotCandidate, landmarks: tuple[Landmark, ...], params: MappingParams) -> SlotCandidate:
    """Return the slot between the flanks that have been measured, with the depth that is known now."""
    corrected = candidate
    if candidate.type == SlotType.PERPENDICULAR:
        behind = candidate.behind.end
        ahead = candidate.ahead.start
        across = candidate.row.frame.heading + 0.5 * math.pi
        for number in range(LANDMARKS):
            landmark = landmarks[number]
            is_side = landmark.type == LandmarkType.SEGMENT and is_confirmed(landmark, params)
            angle = wrap_angle(landmark.heading - across)
            off = min(abs(angle), math.pi - abs(angle))
            if is_side and length_of(landmark) > MIN_FLANK and off < MAX_ANGLE:
                middle = segment_point(landmark, 0.5 * (landmark.start + landmark.end))
                point = point_to_frame(middle.x, middle.y, candidate.row.frame)
                is_deep = candidate.row.side * point.y > candidate.front
                if is_deep and abs(point.x - candidate.behind.end) < MAX_CORRECTION:
                    behind = point.x
                if is_deep and abs(point.x - candidate.ahead.start) < MAX_CORRECTION:
                    ahead = point.x
        corrected = candidate._replace(
            behind=candidate.behind._replace(end=behind), ahead=candidate.ahead._replace(start=ahead)
        )
    return corrected._replace(depth=min(candidate.depth, gap_depth(corrected, landmarks, params)))
