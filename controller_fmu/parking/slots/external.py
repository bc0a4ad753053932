"""An external slot: as a candidate that the map must not contradict, or as the pose to park at in it."""

import math

from controller_fmu.common.external_slot import (
    AT_THE_ROAD,
    UNKNOWN_DEPTH,
    WELL_IN,
    ExternalSlot,
    SlotKind,
    depth_of,
    is_usable_slot,
)
from controller_fmu.interface import Reason
from controller_fmu.parking.geometry.frames import point_to_frame
from controller_fmu.parking.geometry.outline import VehicleOutline
from controller_fmu.parking.map.landmark import Landmark
from controller_fmu.parking.map.params import CAR_LENGTH, CAR_WIDTH, MappingParams
from controller_fmu.parking.slots.candidate import SlotCandidate, SlotType, gap_depth, middle_of
from controller_fmu.parking.slots.goal import least_depth
from controller_fmu.parking.slots.params import SlotParams
from controller_fmu.parking.slots.row import RowMember, SlotRow
from modelkit.maths import PI
from modelkit.vocabulary import Pose


def external_candidate(
    given: ExternalSlot,
    vehicle: Pose,
    landmarks: tuple[Landmark, ...],
    outline: VehicleOutline,
    slot: SlotParams,
    params: MappingParams,
) -> SlotCandidate:
    """Return an external slot beside the road that ``vehicle`` drives along, rejected if it cannot be one.

    The frame of its row is square to the direction into the slot; the road has a slope in it where the slot is angled.
    """
    if not is_usable_slot(given):
        return SlotCandidate(reason=Reason.BAD_INPUT)
    candidate = _between_corners(given, vehicle)
    parallel = candidate.type == SlotType.PARALLEL
    half = outline.half_length if parallel else outline.half_width
    needed = 2.0 * half + (slot.room_along if parallel else slot.room_across)
    seen = gap_depth(candidate, middle_of(candidate), half, landmarks, params)
    least = least_depth(candidate, outline, slot)
    reason = Reason.NONE
    if candidate.ahead.start < needed:
        reason = Reason.SLOT_TOO_SHORT
    elif candidate.depth < least:
        reason = Reason.SLOT_TOO_SHALLOW
    elif seen < least - WELL_IN:
        reason = Reason.SLOT_CONTRADICTED
    return candidate._replace(reason=reason, depth=min(candidate.depth, max(seen, least)))


def _between_corners(given: ExternalSlot, vehicle: Pose) -> SlotCandidate:
    """Return the candidate that the corners describe; the corner that the vehicle passes first is corner A."""
    dx = given.bx - given.ax
    dy = given.by - given.ay
    is_turned = dx * math.cos(vehicle.heading) + dy * math.sin(vehicle.heading) < 0.0
    along = math.atan2(-dy, -dx) if is_turned else math.atan2(dy, dx)
    parallel = given.kind == SlotKind.PARALLEL
    side = 1.0 if math.sin(given.heading - along) > 0.0 else -1.0
    heading = along if parallel else given.heading - side * 0.5 * PI
    x = given.bx if is_turned else given.ax
    y = given.by if is_turned else given.ay
    frame = Pose(x, y, heading)
    b = point_to_frame(given.ax if is_turned else given.bx, given.ay if is_turned else given.by, frame)
    front = 0.5 * side * b.y
    length = CAR_LENGTH if parallel else CAR_WIDTH
    depth = min(depth_of(given), UNKNOWN_DEPTH)
    kind = int(SlotType.PARALLEL if parallel else SlotType.PERPENDICULAR)
    row = SlotRow(frame, side, slope=0.0 if parallel else math.tan(vehicle.heading - heading))
    behind = RowMember(-length, 0.0, 0.0, True, True, front, front)
    ahead = RowMember(b.x, b.x + length, side * b.y, True, True, front, front)
    candidate = SlotCandidate(kind, Reason.NONE, row, behind, ahead, front, depth)
    return candidate._replace(is_nose_in=given.kind == SlotKind.NOSE_IN, is_external=True)


def has_passed_external(candidate: SlotCandidate, sensor_x: float, vehicle: Pose) -> bool:
    """Return whether the side sensor, ``sensor_x`` [m] ahead of the rear axle, has passed both corners of a slot."""
    at = point_to_frame(vehicle.x, vehicle.y, candidate.row.frame)
    sensor = at.x + sensor_x * math.cos(vehicle.heading - candidate.row.frame.heading)
    return sensor > candidate.ahead.start + AT_THE_ROAD


def external_pose(given: ExternalSlot, outline: VehicleOutline, vehicle: Pose) -> Pose:
    """Return the pose in the middle of an external slot; flush with corners A and B where its depth is unknown."""
    depth = depth_of(given)
    parallel = given.kind == SlotKind.PARALLEL
    if depth >= UNKNOWN_DEPTH:
        depth = 2.0 * (outline.half_width if parallel else outline.half_length)
    x = 0.5 * (given.ax + given.bx + depth * math.cos(given.heading))
    y = 0.5 * (given.ay + given.by + depth * math.sin(given.heading))
    heading = given.heading + (PI if given.kind == SlotKind.TAIL_IN else 0.0)
    if parallel:
        heading = math.atan2(given.by - given.ay, given.bx - given.ax)
        if math.cos(heading - vehicle.heading) < 0.0:
            heading = heading + PI
    ahead = outline.centre_ahead
    return Pose(x - ahead * math.cos(heading), y - ahead * math.sin(heading), heading)
