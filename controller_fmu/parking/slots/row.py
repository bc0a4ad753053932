"""The row beside the road: sides along the road on one flank of the vehicle, in order, and the row's direction.

The direction is the mean of two kinds of evidence, weighted by their variances: the headings of the sides (their
covariance plus the misalignment of cars), and the line through the sides' middles (how unevenly cars stand).
"""

import math
from typing import NamedTuple

from controller_fmu.parking.geometry.frames import point_to_frame
from controller_fmu.parking.geometry.line_fit import PointSums, about_mean, add_point
from controller_fmu.parking.map.landmark import MAX_LANDMARKS, Landmark, LandmarkType, end_point, length_of, start_point
from controller_fmu.parking.map.local_map import is_confirmed
from controller_fmu.parking.map.params import CAR_WIDTH, CAR_WIDTH_SIGMA, MappingParams
from modelkit.geometry import Point
from modelkit.maths import PI, clamp, wrap_angle
from modelkit.vocabulary import Pose

MAX_MEMBERS = 8
"""Sides of a row that are kept: the slot's neighbours and the repetition on both sides."""
MAX_TILT = 0.35
"""A side along the road is turned by less than this [rad] against the vehicle's path: 20 deg."""
MIN_SIDE = 0.3
"""Shorter sides [m] are posts or parts of a corner."""
ROW_DEPTH = 1.0
"""Sides whose fronts differ by less than this [m] are of one row; a kerb or wall lies deeper."""
MEMBER_GAP = 0.35
"""Sides nearer than this [m] along the row are of one car (a narrower gap is not observable)."""
ASKEW_VARIANCE = 0.0025
"""Of the misalignment of cars in a row, by up to 5 deg either way [rad2]."""
MIN_HEADING_VARIANCE = 1e-6
"""Of a side that claims to be known better [rad2]: the odometry's drift over half a metre."""
MAX_HIDDEN = 1.2
"""A hitch hides at most so much [m] of a front to either side: half of a cone of 30 deg, 2 m from the sensor."""
UNEVEN_SIGMA = 0.1
"""How unevenly cars stand in a row, standard deviation [m]."""
STAGGER_SIGMA = 0.2
"""And the middles of their sides, as measured from a vehicle whose odometry drifts [m]."""
NO_MEMBER = 1e9
"""Position [m] along the row where there is no side."""


class RowMember(NamedTuple):
    """One car of a row: where it begins and ends along the row, and its front across it [m]; length 0: none."""

    start: float = 0.0
    end: float = 0.0
    front: float = 0.0
    start_known: bool = False
    end_known: bool = False
    start_front: float = 0.0
    """Its front at the start, and at the end [m]: cars stand misaligned."""
    end_front: float = 0.0
    start_sigma: float = 0.0
    """Standard deviation of its start, and of its end [m]."""
    end_sigma: float = 0.0
    start_length: float = 0.0
    """Length [m] of the side that begins at its start, and of the one that ends at its end, as sides are joined; 0:
    not seen in full."""
    end_length: float = 0.0
    gap_evidence: float = 0.0
    """Log-likelihood ratio of a gap between two cars in it, by its echoes."""


class RoadBend(NamedTuple):
    """The road beside a row is an arc that touches the direction of the row's frame at ``at``."""

    curvature: float = 0.0
    """[1/m], left positive."""
    at: float = 0.0
    """Along the row [m]."""


class SlotRow(NamedTuple):
    """A row in its own frame: x along the road as the vehicle drives, y across it; ``side``: 1 left, -1 right.

    Fronts count away from the road, so on either side a larger front is deeper.
    """

    frame: Pose = Pose()
    side: float = -1.0
    members: tuple[RowMember, ...] = (RowMember(),) * MAX_MEMBERS
    """From ahead to behind."""
    used: int = 0
    slope: float = 0.0
    """Tangent of the road's angle to the frame's x axis: the frame of an angled row is square to the way in."""
    front_at: float = 0.0
    """Where the line of the cars' corners at the road is at x = 0, across an angled row [m]."""
    heading_sigma: float = 0.0
    """Standard deviation [rad] of the frame's heading; 0: it is given."""
    bend: RoadBend = RoadBend()


class RowDirection(NamedTuple):
    """How far a row is turned against its frame, and the standard deviation of that [rad]."""

    turn: float
    sigma: float


def find_row(
    landmarks: tuple[Landmark, ...], vehicle: Pose, side: float, bend: RoadBend, params: MappingParams
) -> SlotRow:
    """Return the row on one side (1 left, -1 right) of a vehicle that drives along it, where the road has a ``bend``.

    Its direction follows first from the headings of the sides alone: only along it shows which stand in one line.
    """
    by_headings = _row_in_direction(landmarks, SlotRow(vehicle, side, bend=bend), params)
    return _row_in_direction(landmarks, by_headings, params)


def _row_in_direction(landmarks: tuple[Landmark, ...], row: SlotRow, params: MappingParams) -> SlotRow:
    """Return the row in its frame turned into the direction that the landmarks and its members show."""
    direction = _direction(landmarks, row, params)
    frame = row.frame._replace(heading=row.frame.heading + direction.turn)
    return _members(landmarks, SlotRow(frame, row.side, heading_sigma=direction.sigma, bend=row.bend), params)


def side_as_member(landmark: Landmark, row: SlotRow, side: float, params: MappingParams) -> RowMember:
    """Return a landmark as a member of a row, or of what is across the road; length 0: of none on ``side`` (1, -1)."""
    if landmark.type != LandmarkType.SEGMENT or not is_confirmed(landmark, params) or length_of(landmark) < MIN_SIDE:
        return RowMember()
    a = start_point(landmark)
    b = end_point(landmark)
    p = point_to_frame(a.x, a.y, row.frame)
    q = point_to_frame(b.x, b.y, row.frame)
    if abs(_turn_to_road(landmark.heading, row, side, 0.5 * (p.x + q.x))) > MAX_TILT:
        return RowMember()
    first = p if p.x < q.x else q
    last = q if p.x < q.x else p
    forward = p.x < q.x
    length = last.x - first.x if landmark.start_known and landmark.end_known else 0.0
    member = RowMember(
        first.x,
        last.x,
        side * 0.5 * (p.y + q.y),
        landmark.start_known if forward else landmark.end_known,
        landmark.end_known if forward else landmark.start_known,
        side * first.y,
        side * last.y,
        math.sqrt(landmark.start_variance if forward else landmark.end_variance),
        math.sqrt(landmark.end_variance if forward else landmark.start_variance),
        length,
        length,
        landmark.gap_evidence,
    )
    return member if _front_from_road(member, row, side) >= 0.0 else RowMember()


def road_heading(row: SlotRow, along: float) -> float:
    """Return the heading [rad] of the road ``along`` a row [m]."""
    return row.frame.heading + math.asin(clamp(row.bend.curvature * (along - row.bend.at), -1.0, 1.0))


def _turn_to_road(heading: float, row: SlotRow, side: float, along: float) -> float:
    """Return by how much [rad] a side of this ``heading`` on a ``side`` of the road is turned against that."""
    road = road_heading(row, along)
    return wrap_angle(heading - (road if side < 0.0 else road + math.pi))


def _front_from_road(member: RowMember, row: SlotRow, side: float) -> float:
    """Return the front [m] in the middle of a member, which may be of several cars, as on a straight road."""
    along = 0.5 * (member.start + member.end) - row.bend.at
    turn = road_heading(row, along + row.bend.at) - row.frame.heading
    return 0.5 * (member.start_front + member.end_front) - side * along * math.tan(0.5 * turn)


def corner_of(landmark: Landmark, is_start: bool, row: SlotRow, params: MappingParams) -> Point:
    """Return a known end of a landmark, or a point: along a row, and deep [m]; at ``NO_MEMBER`` if it is not known."""
    is_known = landmark.type == LandmarkType.POINT or (landmark.start_known if is_start else landmark.end_known)
    if not is_known or not is_confirmed(landmark, params):
        return Point(NO_MEMBER, 0.0)
    end = start_point(landmark) if is_start else end_point(landmark)
    at = point_to_frame(end.x, end.y, row.frame)
    return Point(at.x, row.side * at.y)


def _hidden_front(corners: tuple[Point, ...], hitch: Point, side: float) -> RowMember:
    """Return the front behind a point that stands out of it and hides it, such as a hitch: between its corners.

    They are points, or ends of sides towards which the hitch does not lie. It is in the middle of its car: a corner
    that is not known is as far from it as the other one.
    """
    first = Point(-NO_MEMBER, 0.0)
    last = Point(NO_MEMBER, 0.0)
    for number in range(2 * MAX_LANDMARKS):
        corner = corners[number]
        if UNEVEN_SIGMA < corner.y - hitch.y < ROW_DEPTH:
            is_first = (number % 2 == 0) == (side < 0.0)
            first = corner if is_first and first.x < corner.x < hitch.x else first
            last = corner if not is_first and hitch.x < corner.x < last.x else last
    is_started = hitch.x - first.x < MAX_HIDDEN
    is_ended = last.x - hitch.x < MAX_HIDDEN
    first = first if is_started else Point(2.0 * hitch.x - last.x, last.y)
    last = last if is_ended else Point(2.0 * hitch.x - first.x, first.y)
    length = last.x - first.x
    if length > 2.0 * MAX_HIDDEN or is_too_short_for_car(length):
        return RowMember()
    member = RowMember(first.x, last.x, 0.5 * (first.y + last.y), is_started, is_ended, first.y, last.y)
    return member._replace(
        start_sigma=0.0 if is_started else CAR_WIDTH_SIGMA, end_sigma=0.0 if is_ended else CAR_WIDTH_SIGMA
    )


def _member_of(corners: tuple[Point, ...], landmark: Landmark, row: SlotRow, params: MappingParams) -> RowMember:
    """Return a landmark as a member of a row: a side, else the front that its end at the road hides.

    The echoes of a hitch and of a corner behind it may seem one side that is turned too far.
    """
    side = side_as_member(landmark, row, row.side, params)
    if side.end > side.start or landmark.type == LandmarkType.NONE or not is_confirmed(landmark, params):
        return side
    whole = landmark._replace(start_known=True, end_known=True)
    a = corner_of(whole, True, row, params)
    b = corner_of(whole, False, row, params)
    near = a if a.y < b.y else b
    return side if near.y < 0.0 else _hidden_front(corners, near, row.side)


def _members(landmarks: tuple[Landmark, ...], row: SlotRow, params: MappingParams) -> SlotRow:
    """Return a row with its members from ahead to behind, overlapping sides joined."""
    corners: tuple[Point, ...] = tuple(
        corner_of(landmarks[number // 2], number % 2 == 0, row, params) for number in range(2 * MAX_LANDMARKS)
    )
    sides: tuple[RowMember, ...] = tuple(_member_of(corners, item, row, params) for item in landmarks)
    fronts: tuple[float, ...] = tuple(
        _front_from_road(member, row, row.side) if member.end > member.start else NO_MEMBER for member in sides
    )
    limit = min(min(fronts) + ROW_DEPTH, 0.5 * NO_MEMBER)
    last = NO_MEMBER
    for _ in range(MAX_LANDMARKS):
        best = RowMember(end=-NO_MEMBER)
        for number in range(MAX_LANDMARKS):
            if fronts[number] < limit and best.end < sides[number].end < last:
                best = sides[number]
        if best.end <= -NO_MEMBER:
            return row
        last = best.end
        row = _with_next(row, best)
    return row


def _with_next(row: SlotRow, member: RowMember) -> SlotRow:
    """Return the row with a member farther behind; one that touches the last is joined to it."""
    last = row.members[max(row.used - 1, 0)]
    if row.used > 0 and last.start - member.end < MEMBER_GAP:
        longer = member if member.end - member.start > last.end - last.start else last
        joined = last._replace(front=longer.front, gap_evidence=longer.gap_evidence)
        if member.start < last.start:
            joined = joined._replace(
                start=member.start,
                start_known=member.start_known,
                start_front=member.start_front,
                start_sigma=member.start_sigma,
                start_length=member.start_length,
            )
        return with_member(row, row.used - 1, joined)
    return with_member(row, row.used, member)._replace(used=row.used + 1) if row.used < MAX_MEMBERS else row


def with_member(row: SlotRow, at: int, member: RowMember) -> SlotRow:
    """Return the row with the member at the index ``at`` replaced."""
    return row._replace(members=tuple(member if number == at else row.members[number] for number in range(MAX_MEMBERS)))


def _direction(landmarks: tuple[Landmark, ...], row: SlotRow, params: MappingParams) -> RowDirection:
    """Return how far a row is turned against its frame: the road's direction.

    It follows from the headings of all sides, those of cars, what lies deeper and what stands across the road, and from
    the line through the row. A line that contradicts the headings is none of the row: one of its cars has moved out of
    it. Half of the deviation is the slot's own: the vehicle stands between cars that make it.
    """
    total = 0.0
    turn = 0.0
    for side in (row.side, -row.side):
        sides = tuple(side_as_member(landmarks[number], row, side, params) for number in range(MAX_LANDMARKS))
        for number in range(MAX_LANDMARKS):
            if sides[number].end > sides[number].start:
                weight = _side_weight(landmarks, sides, number)
                total += weight
                turn += weight * _turn_to_road(
                    landmarks[number].heading, row, side, 0.5 * (sides[number].start + sides[number].end)
                )
    if total <= 0.0:
        return RowDirection(0.0, MAX_TILT)
    line = _line_direction(row)
    difference = line.turn - turn / total
    if difference * difference < params.gate * (1.0 / total + line.sigma * line.sigma):
        weight = 1.0 / (line.sigma * line.sigma)
        turn += weight * line.turn
        total += weight
    return RowDirection(turn / total, 0.5 / math.sqrt(total))


def _side_weight(landmarks: tuple[Landmark, ...], sides: tuple[RowMember, ...], at: int) -> float:
    """Return the weight [1/rad2] of a landmark's heading in the mean of a row; all ``sides`` of a car weigh as one.

    They share its misalignment. That of what is longer than cars, such as a wall, is how unevenly its ends may stand.
    """
    side = sides[at]
    known = 0.0
    for number in range(MAX_LANDMARKS):
        other = sides[number]
        overlaps = other.end > side.start and side.end > other.start
        if other.end > other.start and overlaps and abs(other.front - side.front) < ROW_DEPTH:
            known += 1.0 / _heading_variance(landmarks[number], other)
    uneven = STAGGER_SIGMA / (side.end - side.start)
    return 1.0 / (_heading_variance(landmarks[at], side) * (1.0 + min(ASKEW_VARIANCE, 2.0 * uneven * uneven) * known))


def _heading_variance(landmark: Landmark, side: RowMember) -> float:
    """Return the variance [rad2] of a side's heading as a car's.

    What is too short for a car may be turned anyhow: a pillar, or what shows of a front behind a hitch.
    """
    is_part = is_too_short_for_car(side.end - side.start)
    return max(landmark.hh, MIN_HEADING_VARIANCE) + (MAX_TILT * MAX_TILT / 3.0 if is_part else 0.0)


def is_too_short_for_car(length: float) -> bool:
    """Return whether a side of ``length`` [m], 0 if unknown, is shorter than any car is wide: of a pillar or a post."""
    return 0.0 < length < CAR_WIDTH - 3.0 * CAR_WIDTH_SIGMA


def _line_direction(row: SlotRow) -> RowDirection:
    """Return the direction of the line through the middles of a row's sides; of a single one it is not known."""
    sums = PointSums()
    for number in range(MAX_MEMBERS):
        member = row.members[number]
        if number < row.used:
            front = _front_from_road(member, row, row.side)
            sums = add_point(sums, 0.5 * (member.start + member.end), row.side * front)
    middles = about_mean(sums)
    if middles.xx <= UNEVEN_SIGMA * UNEVEN_SIGMA:
        return RowDirection(0.0, PI)
    return RowDirection(math.atan(middles.xy / middles.xx), STAGGER_SIGMA / math.sqrt(middles.xx))
