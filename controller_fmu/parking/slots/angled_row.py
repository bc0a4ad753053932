"""An angled row: cars whose sides run obliquely to the road, as a row in a frame that is square to the way into a slot.

In that frame the cars stand as in a perpendicular row, but the road has a slope. Of a car the sensors show the corner
nearest to the road, and parts of the end and of the flank that meet there. The sides give the direction modulo a right
angle; which of the two is the flank's follows from the log-likelihood of how long both are, of how far apart the cars
stand, and of what was observed free where the car's body would be. The corners that stand out most are on one line,
the row's: what lies deeper is no car of the row.
"""

import math
from typing import NamedTuple

from controller_fmu.parking.geometry.frames import point_to_frame
from controller_fmu.parking.map.free_space import Ray, is_free
from controller_fmu.parking.map.landmark import MAX_LANDMARKS, Landmark, LandmarkType, end_point, length_of, start_point
from controller_fmu.parking.map.local_map import is_confirmed
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.slots.candidate import (
    BAY_SIGMA,
    BAY_WIDTH,
    CAR_LENGTH,
    CAR_LENGTH_SIGMA,
    CAR_WIDTH,
    CAR_WIDTH_SIGMA,
    LOG_TEN,
    MAX_POST,
    length_log_likelihood,
    row_point,
)
from controller_fmu.parking.slots.row import (
    ASKEW_VARIANCE,
    MAX_MEMBERS,
    MAX_TILT,
    MEMBER_GAP,
    MIN_SIDE,
    NO_MEMBER,
    RowMember,
    SlotRow,
    side_as_member,
)
from modelkit.geometry import Point
from modelkit.maths import PI, wrap_angle
from modelkit.vocabulary import Pose

MAX_CORNERS = 16
"""Corners at the road that are kept, the last ones passed."""
LINE_DEPTH = 0.7
"""Cars stand up to this far [m] off the row's line, staggered or misaligned; the next corner of a front lies deeper."""
LINE_LENGTH = 2.0
"""Corners that tell the line's direction lie at least so far apart [m]: they are of two cars."""
POST_WEIGHT = 0.2
"""A corner without a side speaks for the line as so much [m] of a side does."""
BODY_DEPTHS = (0.1, 0.25, 0.4, 0.55, 0.7)
BODY_FRACTIONS = (0.3, 0.7)
"""Points of a car's body at these fractions of its length and width."""
FREE_BODY = 1.0
MAX_FREE_BODY = 5
"""Log of the likelihood of a point of a body that was observed free, of so many at most."""
POST_WIDTH = 0.4
"""Of a pillar [m]."""
POST_GAP = 0.2
"""What stands farther [m] beside a car's flank is none of its corners: twice what the ends of sides are off."""


class ObliqueSides(NamedTuple):
    """What speaks for an angled row on one side of the road."""

    heading: float = 0.0
    """Direction [rad] of the sides against the road, modulo a right angle."""
    length: float = 0.0
    """Of all oblique sides [m]."""
    along: float = 0.0
    """Of all sides along the road [m]."""


class RoadCorner(NamedTuple):
    """The end of a side that is nearest to the road, in the frame of a row [m]: along the row, and deep."""

    along: float = 0.0
    deep: float = 0.0
    length: float = 0.0
    """Of the side [m]; 0 of a point."""
    is_flank: bool = False
    is_complete: bool = False
    """The side's other end has been observed, too."""
    tilt: float = 0.0
    """How far the side is turned against the frame [rad]."""
    sigma: float = 0.0
    weight: float = 0.0
    """How much it speaks for the row's line; 0: none."""


class CornerLine(NamedTuple):
    """The line that a row's corners are on, in its frame: deep = at + slope along."""

    slope: float
    at: float


class AngledRow(NamedTuple):
    """A row whose slots lead in one direction, and its log-likelihood."""

    row: SlotRow
    log_likelihood: float


def find_angled_row(
    landmarks: tuple[Landmark, ...], rays: tuple[Ray, ...], vehicle: Pose, side: float, params: MappingParams
) -> SlotRow:
    """Return the angled row on one side (1 left, -1 right) of a vehicle that drives along it; empty: there is none."""
    sides = oblique_sides(landmarks, vehicle, side, params)
    if sides.length <= sides.along:
        return SlotRow(vehicle, side)
    into = sides.heading - 0.5 * PI if side < 0.0 else sides.heading
    forward = _row_into(vehicle, side, into)
    backward = _row_into(vehicle, side, into + side * 0.5 * PI)
    forwards = _row_of(_corners(landmarks, forward, vehicle, params), rays, forward, 1.0)
    backwards = _row_of(_corners(landmarks, backward, vehicle, params), rays, backward, -1.0)
    ratio = forwards.log_likelihood - backwards.log_likelihood
    if abs(ratio) < LOG_TEN:
        return SlotRow(vehicle, side)
    return forwards.row if ratio > 0.0 else backwards.row


def _row_into(vehicle: Pose, side: float, into: float) -> SlotRow:
    """Return an empty row whose slots lead ``into`` [rad] against the vehicle's path."""
    turn = into - side * 0.5 * PI
    return SlotRow(vehicle._replace(heading=vehicle.heading + turn), side, slope=-math.tan(turn))


def oblique_sides(landmarks: tuple[Landmark, ...], vehicle: Pose, side: float, params: MappingParams) -> ObliqueSides:
    """Return the mean direction [rad] of the sides oblique to the road on one ``side`` (1, -1) of ``vehicle``."""
    sine = 0.0
    cosine = 0.0
    oblique = 0.0
    along = 0.0
    for number in range(MAX_LANDMARKS):
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
    return off > MAX_TILT and side * _nearest_end(landmark, vehicle, side).y > 0.0


def _nearest_end(landmark: Landmark, vehicle: Pose, side: float) -> Point:
    """Return the end of a landmark that is nearest to the road, in the frame of the vehicle."""
    a = start_point(landmark)
    b = end_point(landmark)
    p = point_to_frame(a.x, a.y, vehicle)
    q = point_to_frame(b.x, b.y, vehicle)
    return p if side * p.y < side * q.y else q


def _row_of(corners: tuple[RoadCorner, ...], rays: tuple[Ray, ...], row: SlotRow, lean: float) -> AngledRow:
    """Return a row whose slots lead forward (``lean`` 1) or backward (-1), from ahead to behind."""
    line = _line_of(corners, row.side * row.slope)
    total = 0.0
    bay = NO_MEMBER
    before = NO_MEMBER
    last_car = NO_MEMBER
    first = _next_corner(corners, line, NO_MEMBER)
    for _ in range(MAX_MEMBERS):
        if first > -NO_MEMBER:
            behind = _next_corner(corners, line, first - 0.5 * CAR_WIDTH)
            car = _car_of(corners, line, first, lean, row.side)
            free = _free_body(row, car, rays)
            pitch = before - first if lean > 0.0 else first - behind
            if _longest_side(corners, line, first) > MAX_POST:
                total += _side_log_likelihood(corners, line, first) - FREE_BODY * min(free, MAX_FREE_BODY)
                bay = min(bay, last_car - car.start)
                last_car = car.start
            elif free > 1 or pitch < CAR_WIDTH + MEMBER_GAP:
                car = _as_post(car, lean)
            before = first
            first = behind
            row = row._replace(
                members=tuple(car if number == row.used else row.members[number] for number in range(MAX_MEMBERS)),
                used=row.used + 1,
            )
    line = _line_through(row, line, lean)
    row = row._replace(slope=row.side * line.slope, front_at=line.at)
    total += length_log_likelihood(bay, True, BAY_WIDTH, BAY_SIGMA) if bay < 0.5 * NO_MEMBER else 0.0
    return AngledRow(row, total)


def _line_through(row: SlotRow, line: CornerLine, lean: float) -> CornerLine:
    """Return the line through the corners at the road of a row's cars, by least squares; of one car along ``line``."""
    n = 0.0
    sx = 0.0
    sy = 0.0
    sxx = 0.0
    sxy = 0.0
    for number in range(MAX_MEMBERS):
        car = row.members[number]
        if number < row.used and car.start_length == 0.0 and car.end_length == 0.0:
            x = car.end if lean > 0.0 else car.start
            n += 1.0
            sx += x
            sy += car.front
            sxx += x * x
            sxy += x * car.front
    if n == 0.0:
        return line
    spread = sxx - sx * sx / n
    is_known = spread > 0.5 * LINE_LENGTH * LINE_LENGTH
    slope = (sxy - sx * sy / n) / spread if is_known else line.slope
    return CornerLine(slope, (sy - slope * sx) / n)


def _next_corner(corners: tuple[RoadCorner, ...], line: CornerLine, last: float) -> float:
    """Return where [m] the next corner on the row's line behind ``last`` is; -``NO_MEMBER``: there is none."""
    first = -NO_MEMBER
    for number in range(MAX_CORNERS):
        if _is_on_line(corners[number], line) and first < corners[number].along < last:
            first = corners[number].along
    return first


def _corners(
    landmarks: tuple[Landmark, ...], row: SlotRow, vehicle: Pose, params: MappingParams
) -> tuple[RoadCorner, ...]:
    """Return the corners at the road of oblique sides and points beside the vehicle."""
    corners: tuple[RoadCorner, ...] = (RoadCorner(),) * MAX_CORNERS
    for number in range(MAX_LANDMARKS):
        landmark = landmarks[number]
        off = landmark.heading - row.frame.heading
        turned = 0.25 * wrap_angle(4.0 * off)
        is_side = _is_oblique(landmark, vehicle, row.side, params)
        is_side = is_side and turned * turned < params.gate * (ASKEW_VARIANCE + landmark.hh)
        is_point = landmark.type == LandmarkType.POINT and is_confirmed(landmark, params)
        end = _nearest_end(landmark, vehicle, row.side)
        if is_side or (is_point and row.side * end.y > 0.0):
            at = point_to_frame(end.x, end.y, Pose(0.0, 0.0, row.frame.heading - vehicle.heading))
            corner = RoadCorner(
                at.x,
                row.side * at.y,
                length_of(landmark),
                is_side and abs(math.sin(off)) > abs(math.cos(off)),
                landmark.start_known and landmark.end_known,
                turned if is_side else 0.0,
                math.sqrt(landmark.xx + landmark.yy),
                max(length_of(landmark), POST_WEIGHT),
            )
            corners = corners[1:] + (corner,)
    return corners


def _line_of(corners: tuple[RoadCorner, ...], slope: float) -> CornerLine:
    """Return the line through two corners that most others are on; of a single car one of the ``slope`` given."""
    best = CornerLine(slope, NO_MEMBER)
    for number in range(MAX_CORNERS):
        if corners[number].weight > 0.0:
            best = best._replace(at=min(best.at, corners[number].deep - slope * corners[number].along))
    most = 0.0
    for one in range(MAX_CORNERS):
        for other in range(MAX_CORNERS):
            a = corners[one]
            b = corners[other]
            if a.weight > 0.0 and b.weight > 0.0 and a.along - b.along > LINE_LENGTH:
                steep = (a.deep - b.deep) / (a.along - b.along)
                line = CornerLine(steep, a.deep - steep * a.along)
                if abs(math.atan(steep) - math.atan(slope)) < MAX_TILT:
                    score = 0.0
                    for number in range(MAX_CORNERS):
                        score += corners[number].weight * max(1.0 - _off_line(corners[number], line) / LINE_DEPTH, 0.0)
                    if score > most:
                        most = score
                        best = line
    return best


def _off_line(corner: RoadCorner, line: CornerLine) -> float:
    """Return how far [m] a corner is off a row's line."""
    return abs(corner.deep - line.at - line.slope * corner.along) / math.sqrt(1.0 + line.slope * line.slope)


def _is_on_line(corner: RoadCorner, line: CornerLine) -> bool:
    """Return whether a corner is one of a car in the row, or of a post."""
    return corner.weight > 0.0 and _off_line(corner, line) < LINE_DEPTH


def _is_of_car(corner: RoadCorner, line: CornerLine, first: float) -> bool:
    """Return whether a corner is of the car, and what stands beside it, whose foremost corner is at ``first``."""
    return _is_on_line(corner, line) and first - 0.5 * CAR_WIDTH < corner.along <= first


def _longest_side(corners: tuple[RoadCorner, ...], line: CornerLine, first: float) -> float:
    longest = 0.0
    for number in range(MAX_CORNERS):
        if _is_of_car(corners[number], line, first):
            longest = max(longest, corners[number].length)
    return longest


def _side_log_likelihood(corners: tuple[RoadCorner, ...], line: CornerLine, first: float) -> float:
    """Return the log-likelihood of the lengths of a car's sides."""
    total = 0.0
    for number in range(MAX_CORNERS):
        corner = corners[number]
        if _is_of_car(corner, line, first) and corner.length > MAX_POST:
            mean = CAR_LENGTH if corner.is_flank else CAR_WIDTH
            sigma = CAR_LENGTH_SIGMA if corner.is_flank else CAR_WIDTH_SIGMA
            if corner.is_complete:
                total += length_log_likelihood(corner.length, True, mean, sigma)
            else:
                total += visible_log_likelihood((corner.length - mean) / sigma)
    return total


def visible_log_likelihood(deviation: float) -> float:
    """Return the log-probability that a side is no shorter than seen, ``deviation`` [sigma] above the mean.

    Q(z) = exp(-0.717 z - 0.416 z2) / 2 for z >= 0.
    """
    z = abs(deviation)
    tail = 0.5 * math.exp(-0.717 * z - 0.416 * z * z)
    return max(math.log(tail if deviation > 0.0 else 1.0 - tail), -2.0 * LOG_TEN)


def _car_of(corners: tuple[RoadCorner, ...], line: CornerLine, first: float, lean: float, side: float) -> RowMember:
    """Return the car whose foremost corner is at ``first``: flank and front from the longest sides of each.

    What stands beside it narrows the gap there. The far end of a front that is not seen in full is a car's width off.
    """
    edge = first
    beside = first if lean > 0.0 else NO_MEMBER
    deep = NO_MEMBER
    width = CAR_WIDTH
    width_sigma = CAR_WIDTH_SIGMA
    sigma = 0.0
    tilt = 0.0
    longest = -1.0
    longest_flank = -1.0
    longest_front = -1.0
    for number in range(MAX_CORNERS):
        corner = corners[number]
        if _is_of_car(corner, line, first):
            beside = beside if lean > 0.0 else min(beside, corner.along)
            is_front = corner.length > 0.0 and not corner.is_flank
            if corner.length > longest:
                longest = corner.length
                tilt = corner.tilt
                sigma = corner.sigma
            if not is_front and corner.length > longest_flank:
                longest_flank = corner.length
                edge = corner.along
            if not corner.is_flank and corner.length > longest_front:
                longest_front = corner.length
                deep = corner.deep
                width = corner.length if corner.is_complete and corner.length > MAX_POST else width
                width_sigma = corner.sigma if corner.is_complete and corner.length > MAX_POST else width_sigma
            deep = min(deep, corner.deep) if longest_front < 0.0 else deep
    edge = beside if lean * (beside - edge) > POST_GAP or longest_flank < 0.0 else edge
    turned = side * math.tan(tilt) * width
    if lean > 0.0:
        return RowMember(edge - width, edge, deep, True, True, deep - turned, deep, width_sigma, sigma)
    return RowMember(edge, edge + width, deep, True, True, deep, deep + turned, sigma, width_sigma)


def _as_post(car: RowMember, lean: float) -> RowMember:
    """Return what stands at a car's corner where the car's body would be free: a post."""
    if lean > 0.0:
        return car._replace(start=car.end - POST_WIDTH, start_front=car.end_front, start_length=POST_WIDTH)
    return car._replace(end=car.start + POST_WIDTH, end_front=car.start_front, end_length=POST_WIDTH)


def _free_body(row: SlotRow, car: RowMember, rays: tuple[Ray, ...]) -> int:
    """Return how many points of a car's body were observed free."""
    count = 0
    for depth in BODY_DEPTHS:
        for fraction in BODY_FRACTIONS:
            at = car.start + fraction * (car.end - car.start)
            point = row_point(row, at, car.front + depth * CAR_LENGTH)
            if is_free(rays, point.x, point.y):
                count += 1
    return count
