"""An angled row: cars whose sides run obliquely to the road, as a row in a frame that is square to the way into a slot.

In that frame the cars stand as in a perpendicular row, but the road has a slope. Of a car the sensors show the corner
nearest to the road, and parts of the end and of the flank that meet there. The sides give the direction modulo a right
angle; which of the two is the flank's follows from the log-likelihood of how long both are, of how far apart the cars
stand, and of what was observed free where the car's body would be. The corners that stand out most are on one line,
the road's: a row is angled whose sides are oblique to that line. What lies deeper is no car of the row.
"""

import math
from typing import NamedTuple

from controller_fmu.parking.geometry.frames import point_to_frame
from controller_fmu.parking.geometry.line_fit import PointSums, about_mean, add_point
from controller_fmu.parking.map.chain_update import KNOWN_SIGMA
from controller_fmu.parking.map.free_space import Ray, is_free, path_curvature
from controller_fmu.parking.map.landmark import Landmark, LandmarkType, end_point, length_of, start_point
from controller_fmu.parking.map.local_map import is_confirmed
from controller_fmu.parking.map.params import (
    BAY_SIGMA,
    BAY_WIDTH,
    CAR_LENGTH,
    CAR_LENGTH_SIGMA,
    CAR_WIDTH,
    CAR_WIDTH_SIGMA,
    MappingParams,
)
from controller_fmu.parking.slots.candidate import LOG_TEN, MAX_CAR, MAX_POST, length_log_likelihood, row_point
from controller_fmu.parking.slots.row import (
    ASKEW_VARIANCE,
    MAX_MEMBERS,
    MAX_TILT,
    MEMBER_GAP,
    MIN_SIDE,
    NO_MEMBER,
    STAGGER_SIGMA,
    RowMember,
    SlotRow,
    is_too_short_for_car,
    with_member,
)
from modelkit.maths import PI, wrap_angle
from modelkit.vocabulary import Pose

MAX_GATE = 1.0
"""Of the direction of no side at all [rad2]: more than any angle modulo a right angle, squared."""
MAX_CORNERS = 16
"""Corners at the road that are kept, the last ones passed."""
LINE_DEPTH = 0.7
"""Cars stand up to this far [m] off the row's line, staggered or misaligned; the next corner of a front lies deeper."""
LINE_LENGTH = 2.0
"""Corners that tell the line's direction lie at least so far apart [m]: they are of two cars."""
POST_WEIGHT = 0.2
"""A corner without a side, or a side whose end is not known, speaks for the line as so much [m] of a side does."""
BODY_DEPTHS = (0.1, 0.25, 0.4, 0.55, 0.7)
BODY_FRACTIONS = (0.3, 0.7)
"""Points of a car's body at these fractions of its length and width."""
MAX_FREE_BODY = 5
"""Each point of a body that was observed free makes a car e times less likely, so many points at most."""
POST_WIDTH = 0.4
"""Of a pillar [m]."""
POST_GAP = 0.2
"""What stands farther [m] beside a car's flank is none of its corners: twice what the ends of sides are off."""


class RoadCorner(NamedTuple):
    """The end of a side that is nearest to the road, in the frame of a row [m]: along the row, and deep."""

    along: float = 0.0
    deep: float = 0.0
    heading: float = 0.0
    """Of the side against the vehicle's path [rad], and the gate [rad2] of its square error."""
    gate: float = 0.0
    length: float = 0.0
    """Of the side [m]; 0 of a point."""
    length_variance: float = 0.0
    """Variance of that [m2]."""
    is_complete: bool = False
    """The side's other end has been observed, too."""
    sigma: float = 0.0
    weight: float = 0.0
    """How much it speaks for the row's line; 0: none."""
    is_flank: bool = False
    """It leads into the slot rather than across it."""
    tilt: float = 0.0
    """How far the side is turned against the frame [rad]."""


class RoadLine(NamedTuple):
    """The line that a row's corners are on, in its frame: deep = at + slope along."""

    slope: float
    at: float


class CarSides(NamedTuple):
    """The longest sides of a car that meet at its corner at the road, and the last corner beside it [m]."""

    flank: RoadCorner = RoadCorner()
    """Weight 0: none; a point may be of either side."""
    front: RoadCorner = RoadCorner()
    last: float = NO_MEMBER


class AngledRow(NamedTuple):
    """A row whose slots lead in one direction, and its log-likelihood."""

    row: SlotRow
    log_likelihood: float


def find_angled_row(
    landmarks: tuple[Landmark, ...], rays: tuple[Ray, ...], vehicle: Pose, side: float, params: MappingParams
) -> SlotRow:
    """Return the angled row on one side (1 left, -1 right) of a vehicle that drives along it; empty: there is none."""
    corners = _corners(landmarks, vehicle, side, params)
    line = _line_of(corners, side)
    sides = _side_direction(corners, line)
    tilt = _square_angle(sides.heading - side * math.atan(line.slope))
    if abs(tilt) < _largest_tilt(corners, line, sides.gate, path_curvature(rays), params.gate):
        return SlotRow(vehicle, side)
    into = sides.heading - 0.5 * PI if side < 0.0 else sides.heading
    forwards = _row_into(corners, line, rays, SlotRow(vehicle, side), into, 1.0)
    backwards = _row_into(corners, line, rays, SlotRow(vehicle, side), into + side * 0.5 * PI, -1.0)
    ratio = forwards.log_likelihood - backwards.log_likelihood
    if abs(ratio) < LOG_TEN:
        return SlotRow(vehicle, side)
    return forwards.row if ratio > 0.0 else backwards.row


def _square_angle(angle: float) -> float:
    """Return an angle [rad] modulo a right angle, without it at most half of one."""
    return 0.25 * wrap_angle(4.0 * angle)


def _corners(
    landmarks: tuple[Landmark, ...], vehicle: Pose, side: float, params: MappingParams
) -> tuple[RoadCorner, ...]:
    """Return the corners at the road of sides and points beside the vehicle, in its frame.

    A point that is known less well than the known end of a side is a part of a side.
    """
    corners: tuple[RoadCorner, ...] = (RoadCorner(),) * MAX_CORNERS
    for landmark in landmarks:
        length = length_of(landmark)
        is_side = landmark.type == LandmarkType.SEGMENT and MIN_SIDE <= length < MAX_CAR
        is_point = landmark.type == LandmarkType.POINT and landmark.xx + landmark.yy < KNOWN_SIGMA * KNOWN_SIGMA
        if is_confirmed(landmark, params) and (is_side or is_point):
            a = start_point(landmark)
            b = end_point(landmark)
            p = point_to_frame(a.x, a.y, vehicle)
            q = point_to_frame(b.x, b.y, vehicle)
            is_start = side * p.y < side * q.y
            end = p if is_start else q
            is_known = landmark.start_known if is_start else landmark.end_known
            heading = landmark.heading - vehicle.heading
            gate = params.gate * (landmark.hh + ASKEW_VARIANCE)
            is_complete = landmark.start_known and landmark.end_known
            length_variance = landmark.start_variance + landmark.end_variance
            sigma = math.sqrt(landmark.xx + landmark.yy)
            weight = max(length, POST_WEIGHT) if is_known else POST_WEIGHT
            corner = RoadCorner(end.x, side * end.y, heading, gate, length, length_variance, is_complete, sigma, weight)
            if corner.deep > 0.0:
                corners = corners[1:] + (corner,)
    return corners


def _largest_tilt(
    corners: tuple[RoadCorner, ...], line: RoadLine, sides_gate: float, curvature: float, gate: float
) -> float:
    """Return by how much [rad] sides may be turned against the line of a row that is not angled.

    ``sides_gate``: of their own square error. The line is known as well as cars stand evenly in a row; beside a path of
    ``curvature`` [1/m] cars are turned by their distance from the middle of the row, up to half of its length.
    """
    sums = PointSums()
    for corner in corners:
        if _is_on_line(corner, line):
            sums = add_point(sums, corner.along, corner.deep)
    found = about_mean(sums)
    line_variance = STAGGER_SIGMA * STAGGER_SIGMA / max(found.xx, 1.0e-9)
    bend = abs(curvature) * math.sqrt(3.0 * found.xx / max(found.n, 1))
    return math.sqrt(sides_gate + gate * line_variance) + bend


class SideDirection(NamedTuple):
    """The direction of a row's sides [rad] against the path, modulo a right angle."""

    heading: float = 0.0
    gate: float = MAX_GATE
    """Of its square error [rad2], as that of a side."""


def _side_direction(corners: tuple[RoadCorner, ...], line: RoadLine) -> SideDirection:
    """Return the direction that most sides on a line agree with."""
    most = 0.0
    found = SideDirection()
    for one in corners:
        total = 0.0
        known = 0.0
        sine = 0.0
        cosine = 0.0
        for corner in corners:
            off = _square_angle(corner.heading - one.heading)
            agrees = off * off < corner.gate + one.gate
            if corner.length > 0.0 and _is_on_line(corner, line) and agrees:
                total += corner.length
                known += 1.0 / corner.gate
                sine += math.sin(4.0 * corner.heading) / corner.gate
                cosine += math.cos(4.0 * corner.heading) / corner.gate
        if one.length > 0.0 and total > most:
            most = total
            heading = 0.25 * math.atan2(sine, cosine)
            found = SideDirection(heading if heading >= 0.0 else heading + 0.5 * PI, 1.0 / known)
    return found


def _row_into(
    corners: tuple[RoadCorner, ...], line: RoadLine, rays: tuple[Ray, ...], row: SlotRow, into: float, lean: float
) -> AngledRow:
    """Return the row whose slots lead ``into`` [rad] against the path, forward (``lean`` 1) or backward (-1).

    Corners and line are in the frame of the vehicle, as ``row`` is.
    """
    turn = into - row.side * 0.5 * PI
    slope = math.tan(row.side * math.atan(line.slope) - turn)
    rotated: tuple[RoadCorner, ...] = tuple(_rotate(corner, turn, row.side) for corner in corners)
    foot = _rotate(RoadCorner(deep=line.at), turn, row.side)
    line = RoadLine(row.side * slope, foot.deep - row.side * slope * foot.along)
    row = row._replace(frame=row.frame._replace(heading=row.frame.heading + turn), slope=slope)
    return _row_of(rotated, line, rays, row, lean)


def _rotate(corner: RoadCorner, turn: float, side: float) -> RoadCorner:
    """Return a corner in a frame turned by ``turn`` [rad]; a side that is oblique to it does not count."""
    sin = side * math.sin(turn)
    cos = math.cos(turn)
    off = corner.heading - turn
    tilt = _square_angle(off) if corner.length > 0.0 else 0.0
    along = corner.along * cos + corner.deep * sin
    deep = corner.deep * cos - corner.along * sin
    weight = corner.weight if tilt * tilt <= corner.gate else 0.0
    is_flank = corner.length > 0.0 and abs(math.sin(off)) > abs(math.cos(off))
    return corner._replace(along=along, deep=deep, weight=weight, is_flank=is_flank, tilt=tilt)


def _row_of(
    corners: tuple[RoadCorner, ...], line: RoadLine, rays: tuple[Ray, ...], row: SlotRow, lean: float
) -> AngledRow:
    """Return a row whose slots lead forward (``lean`` 1) or backward (-1), from ahead to behind."""
    total = 0.0
    before = NO_MEMBER
    first = _next_corner(corners, line, NO_MEMBER)
    for _ in range(MAX_MEMBERS):
        if first > -NO_MEMBER:
            behind = _next_corner(corners, line, first - 0.5 * CAR_WIDTH)
            sides = _sides_of_car(corners, line, first)
            car = _car_of(sides, first, lean, row.side)
            free = _free_body(row, car, rays)
            pitch = before - first if lean > 0.0 else first - behind
            has_side = max(sides.flank.length, sides.front.length) > MAX_POST
            is_post = not has_side and free > 1
            is_narrow = pitch < CAR_WIDTH + MEMBER_GAP
            if has_side:
                total += _side_log_likelihood(sides.flank, CAR_LENGTH, CAR_LENGTH_SIGMA)
                total += _side_log_likelihood(sides.front, CAR_WIDTH, CAR_WIDTH_SIGMA)
                total -= min(free, MAX_FREE_BODY)
            elif is_post or is_narrow:
                car = _as_post(car, lean)
            apart = length_log_likelihood(min(pitch, BAY_WIDTH), True, BAY_WIDTH, BAY_SIGMA)
            total += -LOG_TEN if is_post else max(apart, -LOG_TEN)
            before = first
            first = behind
            row = with_member(row, row.used, car)._replace(used=row.used + 1)
    line = _line_through(row, line, lean)
    row = row._replace(slope=row.side * line.slope, front_at=line.at)
    return AngledRow(row, total)


def _line_through(row: SlotRow, line: RoadLine, lean: float) -> RoadLine:
    """Return the line through the corners at the road of a row's cars, by least squares; of one car along ``line``."""
    sums = PointSums()
    for number in range(MAX_MEMBERS):
        car = row.members[number]
        if number < row.used and car.start_length == 0.0 and car.end_length == 0.0:
            sums = add_point(sums, car.end if lean > 0.0 else car.start, car.front)
    corners = about_mean(sums)
    if corners.n == 0:
        return line
    slope = corners.xy / corners.xx if corners.xx > 0.5 * LINE_LENGTH * LINE_LENGTH else line.slope
    return RoadLine(slope, corners.y - slope * corners.x)


def _next_corner(corners: tuple[RoadCorner, ...], line: RoadLine, last: float) -> float:
    """Return where [m] the next corner on the row's line behind ``last`` is; -``NO_MEMBER``: there is none."""
    return max(corner.along if _is_on_line(corner, line) and corner.along < last else -NO_MEMBER for corner in corners)


def _line_of(corners: tuple[RoadCorner, ...], side: float) -> RoadLine:
    """Return the line through two corners that most others are on, and few before; of a single car along the path."""
    best = RoadLine(0.0, min(corner.deep if corner.weight > 0.0 else NO_MEMBER for corner in corners))
    most = 0.0
    for a in corners:
        for b in corners:
            if a.weight > 0.0 and b.weight > 0.0 and a.along - b.along > LINE_LENGTH:
                slope = (a.deep - b.deep) / (a.along - b.along)
                line = RoadLine(slope, a.deep - slope * a.along)
                if abs(math.atan(slope)) < MAX_TILT:
                    score = 0.0
                    for corner in corners:
                        score += _line_score(corner, line, side)
                    if score > most:
                        most = score
                        best = line
    return best


def _line_score(corner: RoadCorner, line: RoadLine, side: float) -> float:
    """Return how much a corner speaks for a line, and the other end of its side too; one before the line against it."""
    off = _off_line(corner, line)
    if off < -LINE_DEPTH:
        return -corner.weight
    near = 1.0 - abs(off) / LINE_DEPTH
    far = near - corner.length * abs(math.sin(corner.heading - side * math.atan(line.slope))) / LINE_DEPTH
    return corner.weight * (max(near, 0.0) + max(far, 0.0))


def _off_line(corner: RoadCorner, line: RoadLine) -> float:
    """Return how far [m] a corner is behind a row's line."""
    return (corner.deep - line.at - line.slope * corner.along) / math.sqrt(1.0 + line.slope * line.slope)


def _is_on_line(corner: RoadCorner, line: RoadLine) -> bool:
    """Return whether a corner is one of a car in the row, or of a post."""
    return corner.weight > 0.0 and abs(_off_line(corner, line)) < LINE_DEPTH


def _sides_of_car(corners: tuple[RoadCorner, ...], line: RoadLine, first: float) -> CarSides:
    """Return the sides of the car, and what stands beside it, whose foremost corner is at ``first``."""
    sides = CarSides()
    for corner in corners:
        if _is_on_line(corner, line) and first - 0.5 * CAR_WIDTH < corner.along <= first:
            is_front = corner.length > 0.0 and not corner.is_flank
            if not is_front and (sides.flank.weight == 0.0 or corner.length > sides.flank.length):
                sides = sides._replace(flank=corner)
            if not corner.is_flank and (sides.front.weight == 0.0 or corner.length > sides.front.length):
                sides = sides._replace(front=corner)
            sides = sides._replace(last=min(sides.last, corner.along))
    return sides


def _side_log_likelihood(corner: RoadCorner, mean: float, sigma: float) -> float:
    """Return the log-likelihood of a side where cars have one of ``mean`` length [m]."""
    return length_log_likelihood(corner.length, _is_whole(corner), mean, sigma) if corner.length > MAX_POST else 0.0


def _is_whole(corner: RoadCorner) -> bool:
    """Return whether a side was observed from end to end: none of a car is shorter than that is wide."""
    return corner.is_complete and not is_too_short_for_car(corner.length)


def _car_of(sides: CarSides, first: float, lean: float, side: float) -> RowMember:
    """Return the car whose foremost corner is at ``first``, by its sides.

    What stands beside it narrows the gap there. The far end of a front is as far off as was observed and as
    cars are wide, by the variances of both.
    """
    longer = sides.flank if sides.flank.length > sides.front.length else sides.front
    beside = first if lean > 0.0 else sides.last
    is_flank_known = sides.flank.weight > 0.0 and lean * (beside - sides.flank.along) <= POST_GAP
    edge = sides.flank.along if is_flank_known else beside
    deep = sides.front.deep if sides.front.weight > 0.0 else sides.flank.deep
    usual = CAR_WIDTH_SIGMA * CAR_WIDTH_SIGMA
    share = usual / (usual + sides.front.length_variance) if _is_whole(sides.front) else 0.0
    width = CAR_WIDTH + share * (sides.front.length - CAR_WIDTH)
    width_sigma = CAR_WIDTH_SIGMA * math.sqrt(1.0 - share)
    turned = side * math.tan(longer.tilt) * width
    if lean > 0.0:
        return RowMember(edge - width, edge, deep, True, True, deep - turned, deep, width_sigma, longer.sigma)
    return RowMember(edge, edge + width, deep, True, True, deep, deep + turned, longer.sigma, width_sigma)


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
