"""An angled row: cars whose sides run obliquely to the road, as a row in a frame that is square to the way into a slot.

In that frame the cars stand as in a perpendicular row, but the road has a slope. Of a car the sensors show the corner
nearest to the road, and parts of the end and of the flank that meet there. The sides give the direction modulo a right
angle; which of the two is the flank's follows from the lengths of both and from the distance of the corners, compared
by log-likelihood. The far end of a car's face is hidden; it is as far off as a car is wide.
"""

import math
from typing import NamedTuple

from controller_fmu.parking.geometry.frames import point_to_frame
from controller_fmu.parking.map.landmark import LANDMARKS, Landmark, LandmarkType, end_point, length_of, start_point
from controller_fmu.parking.map.local_map import is_confirmed
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.slots.candidate import (
    BAY_SIGMA,
    BAY_WIDTH,
    CAR_LENGTH,
    CAR_LENGTH_SIGMA,
    CAR_WIDTH,
    CAR_WIDTH_SIGMA,
    DECIDED,
    MERGED_LENGTH,
    length_log_likelihood,
)
from controller_fmu.parking.slots.row import (
    ASKEW_VARIANCE,
    MAX_TILT,
    MEMBERS,
    MIN_SIDE,
    NO_MEMBER,
    ROW_DEPTH,
    RowMember,
    SlotRow,
    side_as_member,
)
from modelkit.geometry import Point
from modelkit.maths import PI, wrap_angle
from modelkit.vocabulary import Pose


class ObliqueSides(NamedTuple):
    """What speaks for an angled row on one side of the road."""

    heading: float = 0.0
    """Direction [rad] of the sides against the road, modulo a right angle."""
    length: float = 0.0
    """Of all oblique sides [m]."""
    along: float = 0.0
    """Of all sides along the road [m]."""


def find_angled_row(landmarks: tuple[Landmark, ...], vehicle: Pose, side: float, params: MappingParams) -> SlotRow:
    """Return the angled row on one side (1 left, -1 right) of a vehicle that drives along it; empty: there is none."""
    sides = oblique_sides(landmarks, vehicle, side, params)
    if sides.length <= sides.along:
        return SlotRow(vehicle, side)
    forward = _row_of(landmarks, vehicle, side, sides.heading, 1.0, params)
    backward = _row_of(landmarks, vehicle, side, sides.heading, -1.0, params)
    ratio = _log_likelihood(landmarks, forward, vehicle, params) - _log_likelihood(landmarks, backward, vehicle, params)
    if abs(ratio) < DECIDED:
        return SlotRow(vehicle, side)
    return forward if ratio > 0.0 else backward


def oblique_sides(landmarks: tuple[Landmark, ...], vehicle: Pose, side: float, params: MappingParams) -> ObliqueSides:
    """Return the mean direction of the sides oblique to the road beside ``vehicle``, by the variances of theirs."""
    sine = 0.0
    cosine = 0.0
    oblique = 0.0
    along = 0.0
    for number in range(LANDMARKS):
        landmark = landmarks[number]
        if _is_oblique(landmark, vehicle, side, params):
            weight = 1.0 / (landmark.hh + ASKEW_VARIANCE)
            angle = 4.0 * (landmark.heading - vehicle.heading)
            sine += weight * math.sin(angle)
            cosine += weight * math.cos(angle)
            oblique += length_of(landmark)
        else:
            member = side_as_member(landmark, vehicle, side, params)
            along += member.end - member.start
    heading = 0.25 * math.atan2(sine, cosine) if oblique > 0.0 else 0.0
    return ObliqueSides(heading if heading >= 0.0 else heading + 0.5 * PI, oblique, along)


def _is_oblique(landmark: Landmark, vehicle: Pose, side: float, params: MappingParams) -> bool:
    """Return whether a landmark is a side beside the road that runs neither along nor across it."""
    if landmark.type != LandmarkType.SEGMENT or not is_confirmed(landmark, params) or length_of(landmark) < MIN_SIDE:
        return False
    off = abs(wrap_angle(4.0 * (landmark.heading - vehicle.heading))) / 4.0
    return off > MAX_TILT and side * _corner(landmark, vehicle, side).y > 0.0


def _corner(landmark: Landmark, vehicle: Pose, side: float) -> Point:
    """Return the end of a landmark that is nearest to the road, in the frame of the vehicle."""
    a = start_point(landmark)
    b = end_point(landmark)
    p = point_to_frame(a.x, a.y, vehicle)
    q = point_to_frame(b.x, b.y, vehicle)
    return p if side * p.y < side * q.y else q


def _row_of(
    landmarks: tuple[Landmark, ...], vehicle: Pose, side: float, heading: float, lean: float, params: MappingParams
) -> SlotRow:
    """Return the row whose slots lead forward (``lean`` 1) or backward (-1), from ahead to behind."""
    into = heading - 0.5 * PI if side < 0.0 else heading
    into = into if lean > 0.0 else into + side * 0.5 * PI
    turn = into - side * 0.5 * PI
    frame = vehicle._replace(heading=vehicle.heading + turn)
    nearest = NO_MEMBER
    for number in range(LANDMARKS):
        if _is_oblique(landmarks[number], vehicle, side, params):
            nearest = min(nearest, side * _corner(landmarks[number], vehicle, side).y)
    row = SlotRow(frame, side, slope=-math.tan(turn))
    last = NO_MEMBER
    for _ in range(LANDMARKS):
        best = -NO_MEMBER
        front = 0.0
        sigma = 0.0
        for number in range(LANDMARKS):
            landmark = landmarks[number]
            corner = _corner(landmark, vehicle, side)
            is_corner = landmark.type == LandmarkType.POINT and is_confirmed(landmark, params)
            if is_corner or _is_oblique(landmark, vehicle, side, params):
                at = point_to_frame(corner.x, corner.y, Pose(0.0, 0.0, turn))
                is_of_row = nearest - ROW_DEPTH < side * corner.y < nearest + ROW_DEPTH
                if is_of_row and best < at.x < last:
                    best = at.x
                    front = side * at.y
                    sigma = math.sqrt(max(landmark.start_variance, landmark.end_variance))
        if best <= -NO_MEMBER:
            return row
        last = best
        row = _with_car(row, _car_at(best, front, lean, sigma), lean)
    return row


def _car_at(corner: float, front: float, lean: float, sigma: float) -> RowMember:
    """Return a car of which the corner at the road is known; the other end of its face is a width off."""
    start = corner - CAR_WIDTH if lean > 0.0 else corner
    start_sigma = CAR_WIDTH_SIGMA if lean > 0.0 else sigma
    end_sigma = sigma if lean > 0.0 else CAR_WIDTH_SIGMA
    return RowMember(start, start + CAR_WIDTH, front, True, True, front, front, start_sigma, end_sigma)


def _with_car(row: SlotRow, car: RowMember, lean: float) -> SlotRow:
    """Return the row with a car farther behind; one whose corner is on the last car's flank or face is that car.

    Of the corners of one car that at the road is kept: of a flank the nearer one, of a face that which leads there.
    """
    at = max(row.used - 1, 0)
    before = row.members[at]
    distance = before.start - car.start
    is_face = distance < CAR_WIDTH + 2.0 * CAR_WIDTH_SIGMA and abs(before.front - car.front) < 0.5 * ROW_DEPTH
    if row.used > 0 and (is_face or distance < 0.5 * CAR_WIDTH):
        is_better = lean < 0.0 if is_face else car.front < before.front
        if not is_better:
            return row
    elif row.used < MEMBERS:
        at = row.used
    else:
        return row
    return row._replace(
        members=tuple(car if number == at else row.members[number] for number in range(MEMBERS)),
        used=at + 1,
    )


def _log_likelihood(landmarks: tuple[Landmark, ...], row: SlotRow, vehicle: Pose, params: MappingParams) -> float:
    """Return the log-likelihood of a row by the lengths of flanks and ends, and by how far apart its cars stand."""
    total = 0.0
    for number in range(LANDMARKS):
        landmark = landmarks[number]
        if _is_oblique(landmark, vehicle, row.side, params):
            is_end = abs(math.sin(landmark.heading - row.frame.heading)) < abs(
                math.cos(landmark.heading - row.frame.heading)
            )
            mean = CAR_WIDTH if is_end else CAR_LENGTH
            sigma = CAR_WIDTH_SIGMA if is_end else CAR_LENGTH_SIGMA
            length = length_of(landmark)
            if not (landmark.start_known and landmark.end_known):
                length -= 0.5 * MERGED_LENGTH
            total += length_log_likelihood(length, False, mean, sigma)
    nearest = NO_MEMBER
    for number in range(MEMBERS - 1):
        if number + 1 < row.used:
            nearest = min(nearest, row.members[number].start - row.members[number + 1].start)
    return total + (length_log_likelihood(nearest, True, BAY_WIDTH, BAY_SIGMA) if nearest < NO_MEMBER else 0.0)
