"""Where the vehicle stands in a slot: in its middle, flush with the neighbours, at GB/T's distance from a kerb."""

import math

from controller_fmu.parking.geometry.frames import point_from_frame, point_to_frame
from controller_fmu.parking.geometry.outline import VehicleOutline
from controller_fmu.parking.map.params import BAY_SIGMA, BAY_WIDTH, CAR_WIDTH, CAR_WIDTH_SIGMA
from controller_fmu.parking.slots.candidate import (
    LOG_TEN,
    MAX_MERGED,
    SlotCandidate,
    SlotType,
    into_heading,
    log_likelihood_ratio,
    middle_of,
    row_point,
)
from controller_fmu.parking.slots.params import SlotParams
from controller_fmu.parking.slots.row import NO_MEMBER, RowMember, SlotRow, is_too_short_for_car
from modelkit.maths import PI
from modelkit.vocabulary import Pose


def goal_pose(candidate: SlotCandidate, outline: VehicleOutline, params: SlotParams) -> Pose:
    """Return the pose of the rear-axle midpoint to park at.

    Across the road that is the neighbour that stands further in: the other one may carry a bicycle rack.
    """
    if candidate.type == SlotType.PARALLEL:
        deep = candidate.front + outline.half_width + kerb_shift(candidate, outline, params)
        heading = candidate.row.frame.heading
    else:
        left = candidate.depth - 2.0 * outline.half_length
        most = max(most_overhang(candidate, outline, params), 0.0)
        # in a slot hardly deeper than the vehicle: half way between the least distance and the largest overhang
        room = left - min(params.distance_behind, 0.5 * (params.least_behind + most + left))
        uneven = abs(candidate.ahead.start_front - candidate.behind.end_front) if candidate.row.slope == 0.0 else 0.0
        deep = candidate.front + outline.half_length + min(0.5 * uneven, room)
        heading = into_heading(candidate) + (0.0 if candidate.is_nose_in else PI)
    centre = row_point(candidate.row, slot_middle(candidate), deep)
    ahead = outline.centre_ahead
    return Pose(centre.x - ahead * math.cos(heading), centre.y - ahead * math.sin(heading), heading)


def kerb_shift(candidate: SlotCandidate, outline: VehicleOutline, params: SlotParams) -> float:
    """Return how far [m] into the slot the kerb moves the goal from the neighbours' line; negative: out of it."""
    left = candidate.depth - 2.0 * outline.half_width
    if params.kerb_max < left and left < params.kerb_max + params.stand_out:
        return min(left - params.kerb_max, max(most_overhang(candidate, outline, params), 0.0))
    return min(left - params.kerb_min, 0.0)


def least_depth(candidate: SlotCandidate, outline: VehicleOutline, params: SlotParams) -> float:
    """Return how deep [m] a slot of this type must be for the vehicle to stand in it, as far out as it may."""
    if candidate.type == SlotType.PARALLEL:
        return 2.0 * outline.half_width
    return 2.0 * outline.half_length + params.least_behind - most_overhang(candidate, outline, params)


def most_overhang(candidate: SlotCandidate, outline: VehicleOutline, params: SlotParams) -> float:
    """Return the largest overhang [m] beyond the fronts' line: GB/T's limit less the uncertainty of line and heading.

    Turned by the direction's error a corner stands out by half of the vehicle's side along the row times that.
    """
    half = outline.half_length if candidate.type == SlotType.PARALLEL else outline.half_width
    by_turn = half * candidate.row.heading_sigma
    sigma = math.sqrt(candidate.front_sigma * candidate.front_sigma + by_turn * by_turn)
    return params.stand_out - params.confidence * sigma


def overhang_of(candidate: SlotCandidate, outline: VehicleOutline, pose: Pose) -> float:
    """Return how far [m] a vehicle at ``pose`` stands out of the line of the neighbours' fronts, negative inside."""
    centre = point_from_frame(outline.centre_ahead, 0.0, pose)
    at = point_to_frame(centre.x, centre.y, candidate.row.frame)
    turn = pose.heading - candidate.row.frame.heading
    half = outline.half_length * abs(math.sin(turn)) + outline.half_width * abs(math.cos(turn))
    return candidate.front + half - candidate.row.side * at.y


def slot_middle(candidate: SlotCandidate) -> float:
    """Return where [m] along the row the vehicle is to stand: in the middle of the gap, or of one of several bays.

    There the errors of both neighbours and of the bays' width count least. Where it is not ten times likelier that the
    slot is across the road it is the bay passed last: beside a car its flank shows whether that stands across.

    The middles of the cars beside n empty bays are n + 1 bays apart: 4.6 to 5.8, 6.9 to 8.7 or 9.2 to 11.6 m where bays
    are 2.3 to 2.9 m wide, so n follows from the width of usual bays and of this row's.
    """
    ahead = candidate.ahead.start + 0.5 * _car_width(candidate.ahead)
    distance = ahead - candidate.behind.end + 0.5 * _car_width(candidate.behind)
    bay = bay_width(candidate.row)
    if candidate.type == SlotType.PARALLEL or distance < 3.0 * (bay - CAR_WIDTH_SIGMA):
        return middle_of(candidate)
    count = max(math.floor(distance / bay + 0.5), 3)
    number = count // 2 if log_likelihood_ratio(candidate) < -LOG_TEN else 1
    return ahead - distance * number / count


def _car_width(member: RowMember) -> float:
    """Return the width [m] of the car beside a slot: as usual, or if observed in full half way to that.

    An observed width errs as much as cars differ. What hides both corners of a car, such as a rack with bicycles,
    stands in its middle.
    """
    return 0.5 * (member.end - member.start + CAR_WIDTH) if _is_one_car(member) else CAR_WIDTH


def _is_one_car(member: RowMember) -> bool:
    """Return whether a side is the front of one car, observed in full; a shorter side is a part of one."""
    width = member.end - member.start
    is_one = not is_too_short_for_car(width) and width < CAR_WIDTH + 0.5 * BAY_WIDTH
    return member.start_known and member.end_known and is_one


def bay_width(row: SlotRow) -> float:
    """Return the mean distance [m] from car to car where no place between two is empty; usual bays count as one.

    A side is of one car or some: where it begins is the first one, where it ends the last one, as far as that is known.
    """
    total = BAY_WIDTH
    count = 1
    last = NO_MEMBER
    for number in range(2 * row.used):
        member = row.members[number // 2]
        is_end = number % 2 == 0
        if is_end and row.members[max(number // 2 - 1, 0)].start - member.end > CAR_WIDTH:
            last = NO_MEMBER
        is_by_end = member.end_sigma < member.start_sigma if _is_one_car(member) else is_end
        is_known = member.end_known if is_by_end else member.start_known
        half = 0.5 * _car_width(member)
        at = member.end - half if is_by_end else member.start + half
        if is_known and not is_too_short_for_car(member.end_length if is_by_end else member.start_length):
            bays = math.floor((last - at) / BAY_WIDTH + 0.5)
            if bays <= MAX_MERGED and abs(last - at - bays * BAY_WIDTH) < 2.0 * BAY_SIGMA * bays:
                total += last - at
                count += bays
            last = at
    return total / count
