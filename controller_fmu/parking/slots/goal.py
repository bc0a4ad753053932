"""Where the vehicle stands in a slot: in its middle, flush with the neighbours, at GB/T's distance from a kerb."""

import math

from controller_fmu.parking.geometry.outline import VehicleOutline
from controller_fmu.parking.slots.candidate import SlotCandidate, SlotType, into_heading, row_point
from controller_fmu.parking.slots.params import SlotParams
from modelkit.maths import PI
from modelkit.vocabulary import Pose

MAX_KERB_DISTANCE = 1.2
"""What lies farther [m] beside a vehicle that stands flush with its neighbours is not its kerb."""
MAX_KERB_SHIFT = 0.05
"""Towards a kerb the vehicle leaves its neighbours' line by this [m] at most: sensors cannot tell it from a wall."""


def goal_pose(candidate: SlotCandidate, outline: VehicleOutline, params: SlotParams) -> Pose:
    """Return the pose of the rear-axle midpoint to park at."""
    middle = 0.5 * (candidate.behind.end + candidate.ahead.start)
    if candidate.type == SlotType.PARALLEL:
        width = 2.0 * outline.half_width
        left = candidate.depth - width
        shift = 0.0
        if left < params.kerb_min:
            shift = left - params.kerb_min
        elif left > params.kerb_max and candidate.depth < width + MAX_KERB_DISTANCE:
            shift = min(left - params.kerb_max, MAX_KERB_SHIFT)
        deep = candidate.front + outline.half_width + shift
        heading = candidate.row.frame.heading
    else:
        length = 2.0 * outline.half_length
        short = max(0.0, length + params.distance_behind - candidate.depth)
        deep = candidate.front + outline.half_length - short
        heading = into_heading(candidate) + PI
        middle = _bay_middle(candidate, outline, params)
    centre = row_point(candidate.row, middle, deep)
    ahead = outline.centre_ahead
    return Pose(centre.x - ahead * math.cos(heading), centre.y - ahead * math.sin(heading), heading)


def _bay_middle(candidate: SlotCandidate, outline: VehicleOutline, params: SlotParams) -> float:
    """Return the middle [m] along the row of the bay to park in: of several empty ones that passed last."""
    width = candidate.ahead.start - candidate.behind.end
    one_more = candidate.bay + 2.0 * outline.half_width + params.room_across
    if candidate.bay <= 0.0 or width < one_more:
        return 0.5 * (candidate.behind.end + candidate.ahead.start)
    return (
        0.5 * (candidate.ahead.start + candidate.ahead.end) - candidate.bay
        if _is_car(candidate)
        else (candidate.ahead.start - 0.5 * candidate.bay)
    )


def _is_car(candidate: SlotCandidate) -> bool:
    """Return whether the neighbour passed last was seen in full, so that its middle is known."""
    return candidate.ahead.start_known and candidate.ahead.end_known
