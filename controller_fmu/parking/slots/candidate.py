"""A slot candidate: one gap between two members of a row, its likelier type, and why it is rejected if it is.

Type hypotheses, compared by log-likelihood: cars that stand parallel show a side of about 4.4 m, cars that stand
perpendicular a front of about 1.8 m; a side not seen in full says only how long it is at least. A kerb or wall nearer
than a car is long speaks for parallel; where nothing is, the flanks of both cars show how deep they are. Where the
vehicle fits both ways the likelier one counts; a gap too short to park along is one only if that is ten times likelier.
"""

import math
from enum import IntEnum
from typing import NamedTuple

from controller_fmu.common.external_slot import SlotKind
from controller_fmu.interface import Reason
from controller_fmu.parking.geometry.frames import point_from_frame, point_to_frame
from controller_fmu.parking.geometry.outline import VehicleOutline
from controller_fmu.parking.map.free_space import Ray, is_free
from controller_fmu.parking.map.landmark import MAX_LANDMARKS, Landmark, LandmarkType, segment_point
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
from controller_fmu.parking.measurement.predicted_range import EchoOrigin, predict_range_to_segment
from controller_fmu.parking.slots.params import SlotParams
from controller_fmu.parking.slots.row import (
    MAX_MEMBERS,
    MEMBER_GAP,
    NO_MEMBER,
    ROW_DEPTH,
    UNEVEN_SIGMA,
    RowMember,
    SlotRow,
    corner_of,
    is_too_short_for_car,
)
from modelkit.geometry import Point
from modelkit.maths import clamp

UNKNOWN_DEPTH = 50.0
"""Depth [m] of a gap in which nothing was detected."""
LOG_TEN = 2.3
"""Log of the likelihood ratio ten."""
MAX_MERGED = 4
"""So many cars in a row at most seem one side."""
MERGED_LENGTH = 1.0
"""So much [m] of a side that is still being passed may be the next car's: the gap shows when as much is seen of it."""
MAX_CAR = 6.0
"""A longer side [m] is of several cars; one twice as long may be a wall, and shows nothing of how cars stand."""
MAX_POST = 0.6
"""A shorter side [m] may be a pillar's."""
MIN_INSET = 0.25
"""What stands at least this far [m] from both neighbours and behind their fronts is in the gap."""
SAMPLE_COUNT = 9
FREE_DEPTHS = (0.4, 1.0, 1.6)
FREE_FRACTIONS = (0.4, 0.5, 0.6)
MIN_FREE = 4
"""Of the points so deep [m] and at these fractions of the gap, so many must have been observed free."""
NEAR_FRONT = 2.9
"""Up to so far [m] from the vehicle's axis, 2 m from its side, the echoes of a gap between cars show its edges."""


class SlotType(IntEnum):
    """How a vehicle stands in a slot."""

    NONE = 0
    PARALLEL = 1
    PERPENDICULAR = 2


class SlotCandidate(NamedTuple):
    """A gap in a row; positions in the row's frame [m]."""

    type: int = SlotType.NONE
    reason: int = Reason.NONE
    """Why it is rejected."""
    row: SlotRow = SlotRow()
    behind: RowMember = RowMember()
    """The neighbour that was passed first (A)."""
    ahead: RowMember = RowMember()
    """The neighbour that was passed last (B)."""
    front: float = 0.0
    """Line of the neighbours' fronts, across the row."""
    depth: float = UNKNOWN_DEPTH
    """Behind that line."""
    front_sigma: float = 0.0
    """Standard deviation of that line across the row [m], and of the middle of the gap along it."""
    middle_sigma: float = 0.0
    is_nose_in: bool = False
    is_external: bool = False
    missing: float = 0.0
    """Length [m] along the row that it lacks."""
    flank_ratio: float = 0.0
    """Log-likelihood ratio of how deep both neighbours are: parallel over perpendicular."""


def find_slot(
    row: SlotRow,
    landmarks: tuple[Landmark, ...],
    rays: tuple[Ray, ...],
    outline: VehicleOutline,
    slot: SlotParams,
    params: MappingParams,
) -> SlotCandidate:
    """Return the gap passed last into which the vehicle fits, else a rejected one, else type NONE.

    With ``slot.open_ended`` the place beyond the last car counts as a gap, as far as it is observed free.
    """
    found = SlotCandidate()
    if slot.open_ended and row.used > 0:
        beside = _judge(_gap(_with_end(row, outline, slot), 0, landmarks, outline, params), rays, outline, slot)
        found = beside if beside.type == SlotType.PERPENDICULAR and is_observed_free(beside, rays) else found
    for number in range(MAX_MEMBERS - 1):
        if number + 1 < row.used and (found.type == SlotType.NONE or found.reason != Reason.NONE):
            candidate = _judge(_gap(row, number, landmarks, outline, params), rays, outline, slot)
            if candidate.type != SlotType.NONE and is_observed_free(candidate, rays):
                found = candidate if candidate.reason == Reason.NONE or found.type == SlotType.NONE else found
    return found


def _with_end(row: SlotRow, outline: VehicleOutline, slot: SlotParams) -> SlotRow:
    """Return a row that ends with a car ahead of the last one, of which nothing is known but the room before it."""
    last = row.members[0]
    width = 2.0 * (outline.half_width + slot.room_across)
    start = last.end + width
    front = last.front + row.slope * row.side * (width + CAR_WIDTH)
    end = RowMember(start, start + CAR_WIDTH, front, False, False, front, front)
    return row._replace(
        members=tuple(end if number == 0 else row.members[number - 1] for number in range(MAX_MEMBERS)),
        used=min(row.used + 1, MAX_MEMBERS),
    )


def _gap(
    row: SlotRow, number: int, landmarks: tuple[Landmark, ...], outline: VehicleOutline, params: MappingParams
) -> SlotCandidate:
    """Return the gap behind the member ``number`` of a row, of no type yet; without a row: too narrow for anything."""
    behind = row.members[min(number + 1, MAX_MEMBERS - 1)]
    found = SlotCandidate(row=row, behind=behind, ahead=row.members[number])
    found = _between_posts(found, landmarks, 2.0 * outline.half_width, params)
    if found.ahead.start - found.behind.end < 2.0 * outline.half_width:
        return SlotCandidate()
    found = found._replace(front=_front_of(found, number, outline.half_width))
    return found._replace(depth=gap_depth(found, middle_of(found), outline.half_width, landmarks, params))


def _judge(found: SlotCandidate, rays: tuple[Ray, ...], outline: VehicleOutline, slot: SlotParams) -> SlotCandidate:
    """Return a gap typed and judged."""
    if found.row.used == 0:
        return found
    width = found.ahead.start - found.behind.end
    if found.depth >= UNKNOWN_DEPTH:
        behind_ratio = _flank_ratio(found, found.behind.end, found.behind.end_front, rays)
        ahead_ratio = _flank_ratio(found, found.ahead.start, found.ahead.start_front, rays)
        found = found._replace(flank_ratio=behind_ratio + ahead_ratio)
    least_length = 2.0 * outline.half_length + slot.room_along
    least_width = 2.0 * outline.half_width + slot.room_across
    parallel = log_likelihood_ratio(found) > (0.0 if width >= least_length else LOG_TEN) and found.row.slope == 0.0
    parallel = parallel if slot.wanted == SlotKind.NONE else slot.wanted == SlotKind.PARALLEL
    missing = max((least_length if parallel else least_width) - width, 0.0)
    needed = 2.0 * outline.half_width if parallel else 2.0 * outline.half_length + slot.distance_behind - slot.stand_out
    reason = Reason.NONE
    if missing > 0.0:
        reason = Reason.SLOT_TOO_SHORT
    elif found.depth < needed:
        reason = Reason.SLOT_TOO_SHALLOW
    kind = SlotType.PARALLEL if parallel else SlotType.PERPENDICULAR
    leads_on = found.row.slope * found.row.side > 0.0
    is_nose_in = slot.wanted == SlotKind.NOSE_IN or (slot.wanted != SlotKind.TAIL_IN and leads_on)
    return found._replace(type=kind, reason=reason, is_nose_in=is_nose_in, missing=missing)


def _front_of(found: SlotCandidate, number: int, half_width: float) -> float:
    """Return the line of fronts at a gap behind the member ``number``: of cars, also where posts narrow the gap."""
    row = found.row
    slope = row.side * row.slope
    if slope != 0.0:
        corner = middle_of(found) + (half_width if slope > 0.0 else -half_width)
        return row.front_at + slope * corner
    ahead = row.members[number]
    if is_too_short_for_car(ahead.start_length) and number > 0:
        ahead = row.members[number - 1]
    behind = row.members[min(number + 1, MAX_MEMBERS - 1)]
    if is_too_short_for_car(behind.end_length) and number + 2 < row.used:
        behind = row.members[min(number + 2, MAX_MEMBERS - 1)]
    return 0.5 * (behind.end_front + ahead.start_front)


def _between_posts(
    found: SlotCandidate, landmarks: tuple[Landmark, ...], least: float, params: MappingParams
) -> SlotCandidate:
    """Return a gap as posts in the row, too short to be sides, narrow it: the part passed last, ``least`` [m] wide."""
    for _ in range(MAX_MEMBERS):
        post = _last_post(found, landmarks, params)
        if found.ahead.start - post.x >= least:
            behind = found.behind._replace(end=post.x, end_front=post.y, end_length=MIN_INSET)
            return found._replace(behind=behind) if post.x > found.behind.end else found
        found = found._replace(ahead=found.ahead._replace(start=post.x, start_front=post.y, start_length=MIN_INSET))
    return found


def _last_post(found: SlotCandidate, landmarks: tuple[Landmark, ...], params: MappingParams) -> Point:
    """Return where [m] along the row, and how deep, the post in a gap is that was passed last; -``NO_MEMBER``: none."""
    last = Point(-NO_MEMBER, 0.0)
    for landmark in landmarks:
        is_point = landmark.type == LandmarkType.POINT
        for is_start in (True, False):
            at = corner_of(landmark, is_start, found.row, params)
            low = found.behind.end + _post_offset(found.row, at, found.behind, is_point)
            high = found.ahead.start - _post_offset(found.row, at, found.ahead, is_point)
            if max(low, last.x) < at.x < high:
                last = at
    return last


def _post_offset(row: SlotRow, at: Point, member: RowMember, is_point: bool) -> float:
    """Return how far [m] beside a member a post must stand to be none of its corners; one out of the row never does.

    What is no point is one only at the fronts or before them: deeper it is a part of a flank.
    """
    off = at.y - (member.front if row.slope == 0.0 else row.front_at + row.side * row.slope * at.x)
    if abs(off) > ROW_DEPTH or (off > MIN_INSET and not is_point):
        return UNKNOWN_DEPTH
    return UNEVEN_SIGMA if off > MIN_INSET else MEMBER_GAP


def log_likelihood_ratio(candidate: SlotCandidate) -> float:
    """Return ln P(observations | parallel) - ln P(observations | perpendicular) [1]."""
    ratio = 0.0
    for number in range(MAX_MEMBERS):
        if number < candidate.row.used:
            member = candidate.row.members[number]
            length = member.end - member.start
            is_started = member.start_known or number + 1 < candidate.row.used
            is_complete = is_started and (member.end_known or number > 0)
            if length < 2.0 * MAX_CAR:
                ratio += side_log_likelihood(length, is_complete, CAR_LENGTH, CAR_LENGTH_SIGMA, 0.0)
                ratio -= side_log_likelihood(length, is_complete, CAR_WIDTH, CAR_WIDTH_SIGMA, member.gap_evidence)
    ratio -= length_log_likelihood(-candidate.depth, False, -CAR_LENGTH, CAR_LENGTH_SIGMA)
    return ratio + candidate.flank_ratio


def _flank_ratio(found: SlotCandidate, along: float, front: float, rays: tuple[Ray, ...]) -> float:
    """Return the log-likelihood ratio of the car whose corner is ``along`` a row, its ``front`` across it [m].

    Its flank returns an echo where the cone's boundary meets it, by half a car's width: the car is at least so deep as
    the range tells, however wide the cone. A ray that goes on shows that it is not. One in ten is of something else.
    """
    corner = row_point(found.row, along, front)
    end = row_point(found.row, along, front + CAR_LENGTH)
    ratio = 0.0
    for ray in rays:
        flank = predict_range_to_segment(ray.sensor, corner, end)
        beyond = ray.range - flank.distance
        if flank.origin == EchoOrigin.CONE_EDGE and beyond > -0.5 * CAR_WIDTH:
            is_passed = beyond > 0.5 * CAR_WIDTH
            at = point_to_frame(ray.sensor.x, ray.sensor.y, found.row.frame)
            reached = flank.distance if is_passed else ray.range
            across = reached * reached - (at.x - along) * (at.x - along)
            deep = math.sqrt(max(across, 0.0)) + found.row.side * at.y - front
            sense = -1.0 if is_passed else 1.0
            likelihood = length_log_likelihood(sense * deep, False, sense * CAR_WIDTH, CAR_WIDTH_SIGMA)
            likelihood -= length_log_likelihood(sense * deep, False, sense * CAR_LENGTH, CAR_LENGTH_SIGMA)
            ratio += clamp(likelihood, -LOG_TEN, LOG_TEN) if is_passed or ray.is_echo else 0.0
    return clamp(ratio, -2.0 * LOG_TEN, 2.0 * LOG_TEN)


def side_log_likelihood(length: float, is_complete: bool, car: float, sigma: float, evidence: float) -> float:
    """Return the log-likelihood of a side of ``length`` [m] where cars show one of ``car`` [m], one or some that merge.

    Cars in a row stand as far apart as bays are wider than cars. The map leaves one gap in ten unsplit; the
    ``evidence`` of its echoes, a log-likelihood ratio, counts once. Of an incomplete side the last car has begun.
    """
    gap_variance = BAY_SIGMA * BAY_SIGMA - CAR_WIDTH_SIGMA * CAR_WIDTH_SIGMA
    best = -2.0 * LOG_TEN
    for gaps in range(MAX_MERGED):
        mean = car + gaps * (car + BAY_WIDTH - CAR_WIDTH)
        deviation = math.sqrt(sigma * sigma + gaps * (sigma * sigma + gap_variance))
        likelihood = length_log_likelihood(length, True, mean, deviation)
        if not is_complete:
            likelihood = length_log_likelihood(length - MERGED_LENGTH, False, mean, deviation)
            likelihood += length_log_likelihood(-length, False, car - mean, deviation)
        best = max(best, likelihood + (evidence if gaps > 0 else 0.0) - gaps * LOG_TEN)
    return best


def length_log_likelihood(length: float, is_complete: bool, mean: float, sigma: float) -> float:
    """Return the log-likelihood of a side of ``length`` [m]; of an incomplete one only what is too long counts."""
    deviation = (length - mean) / sigma
    if not is_complete and deviation < 0.0:
        return 0.0
    return -min(0.5 * deviation * deviation, 2.0 * LOG_TEN)


def middle_of(candidate: SlotCandidate) -> float:
    """Return the middle [m] of a gap along its row."""
    return 0.5 * (candidate.behind.end + candidate.ahead.start)


def gap_depth(
    candidate: SlotCandidate, middle: float, half: float, landmarks: tuple[Landmark, ...], params: MappingParams
) -> float:
    """Return how deep [m] behind the fronts the first landmark lies, up to ``half`` [m] from the ``middle`` [m]."""
    row = candidate.row
    low = max(candidate.behind.end + MIN_INSET, middle - half)
    high = min(candidate.ahead.start - MIN_INSET, middle + half)
    depth = UNKNOWN_DEPTH
    for number in range(MAX_LANDMARKS):
        landmark = landmarks[number]
        if is_confirmed(landmark, params):
            for sample in range(SAMPLE_COUNT):
                along = landmark.start + (landmark.end - landmark.start) * sample / (SAMPLE_COUNT - 1)
                at = segment_point(landmark, along)
                point = point_to_frame(at.x, at.y, row.frame)
                deep = row.side * point.y - candidate.front
                if low < point.x < high and deep > -MIN_INSET:
                    depth = min(depth, max(deep, 0.0))
    return depth


def is_observed_free(candidate: SlotCandidate, rays: tuple[Ray, ...]) -> bool:
    """Return whether the gap behind the fronts has been observed free, as deep as it is; less if an edge is known.

    Echoes of two edges nearby may hide all of a gap. From afar they show none: a pedestrian before a wall hides it so.
    """
    count = 0
    for deep in FREE_DEPTHS:
        for fraction in FREE_FRACTIONS:
            x = candidate.behind.end + fraction * (candidate.ahead.start - candidate.behind.end)
            point = row_point(candidate.row, x, candidate.front + min(deep, 0.5 * candidate.depth))
            count += 1 if is_free(rays, point.x, point.y) else 0
    edges = (1 if candidate.behind.end_known else 0) + (1 if candidate.ahead.start_known else 0)
    return count >= MIN_FREE - edges or (edges == 2 and (count > 0 or candidate.front < NEAR_FRONT))


def row_point(row: SlotRow, along: float, deep: float) -> Point:
    """Return the point ``along`` a row and ``deep`` [m] across it in the odometry frame."""
    return point_from_frame(along, row.side * deep, row.frame)


def into_heading(candidate: SlotCandidate) -> float:
    """Return the direction [rad] from the road into the slot."""
    return candidate.row.frame.heading + candidate.row.side * 0.5 * math.pi
