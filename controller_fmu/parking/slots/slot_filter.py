"""The slot while the vehicle drives into it: an extended Kalman filter of its neighbours and its end.

State: each neighbour's corner at the mouth (x, y) and heading, the end's distance along the direction into the slot,
and by how much the odometry frame has turned since; in that frame. A neighbour is the two lines that meet at its
corner, its front and its flank. The frame drifts as the vehicle moves, for all of them alike, so what is measured of
one corrects the others too. An echo measures the range to the nearest of them, from a point p with the unit vector u
towards it:

    z = |p - s|    dz = u (dc + dh e_z x (p - c)) for a point of the neighbour (c, h),  dz = (u n) de for the end
"""

import math
from typing import NamedTuple

from controller_fmu.parking.geometry.frames import point_to_frame, pose_from_frame, pose_to_frame
from controller_fmu.parking.geometry.outline import VehicleOutline
from controller_fmu.parking.map.params import CAR_LENGTH, CAR_LENGTH_SIGMA, CAR_WIDTH, CAR_WIDTH_SIGMA, MappingParams
from controller_fmu.parking.measurement.predicted_range import (
    EchoOrigin,
    PredictedRange,
    direction_of,
    predict_range_to_segment,
)
from controller_fmu.parking.measurement.sensor import Measurement, SensorPose, in_field_of_view
from controller_fmu.parking.slots.candidate import UNKNOWN_DEPTH, SlotCandidate, SlotType, into_heading, row_point
from controller_fmu.parking.slots.correction import correction_gate
from controller_fmu.parking.slots.row import ASKEW_VARIANCE, RowMember, SlotRow, is_too_short_for_car, road_heading
from modelkit.geometry import Point
from modelkit.maths import wrap_angle
from modelkit.vocabulary import Pose

STATE_COUNT = 8
"""Corner x, y and heading of the neighbour behind, then of the one ahead, then the end and the frame's turn."""
AHEAD_OFFSET = 3
END_INDEX = 6
TURN_INDEX = 7
FRONT_SIGMA = 0.03
"""Standard deviation [m] of a front where a side ends, and of a body's surface from a straight line."""
END_SIGMA = 0.05
"""And of what a slot ends at, measured from the road: turned by 1 deg over half a slot."""
CONE_SPREAD = 1.15
"""Tangent of the widest half cone over the usual one (34 deg, 30 deg), and of the usual one over the narrowest."""
CORRELATED_ECHOES = 9.0
"""So many echoes in a row share the error of the sensor's mounting and of the surface: each counts as a part of one."""


class SlotFilter(NamedTuple):
    """State, its covariance by rows, and the direction into the slot; ``is_begun``: there is a slot."""

    state: tuple[float, ...] = (0.0,) * STATE_COUNT
    covariance: tuple[float, ...] = (0.0,) * (STATE_COUNT * STATE_COUNT)
    into_x: float = 0.0
    into_y: float = 1.0
    is_begun: bool = False
    road_behind: float = 0.0
    """Heading of the road [rad] at the neighbour behind, and at the one ahead."""
    road_ahead: float = 0.0
    absent: int = 0
    """Measurements through both neighbours in a row, where cars that stand across the road had to be."""


class SlotEcho(NamedTuple):
    """The predicted echo of a slot: its range, and its derivatives by the states; ``is_known``: it tells something."""

    predicted: PredictedRange = PredictedRange()
    gradient: tuple[float, ...] = (0.0,) * STATE_COUNT
    is_known: bool = False


def begin_slot_filter(slot: SlotCandidate) -> SlotFilter:
    """Return the filter of a slot as it has been found; of an external slot, whose corners are given, there is none."""
    if slot.is_external:
        return SlotFilter()
    a = row_point(slot.row, slot.behind.end, slot.behind.end_front)
    b = row_point(slot.row, slot.ahead.start, slot.ahead.start_front)
    heading = into_heading(slot)
    into_x = math.cos(heading)
    into_y = math.sin(heading)
    end = row_point(slot.row, 0.5 * (slot.behind.end + slot.ahead.start), slot.front + slot.depth)
    state = (
        a.x,
        a.y,
        _front_heading(slot.row, slot.behind, slot.behind.end_length),
        b.x,
        b.y,
        _front_heading(slot.row, slot.ahead, slot.ahead.start_length),
        end.x * into_x + end.y * into_y,
        0.0,
    )
    front = FRONT_SIGMA * FRONT_SIGMA
    cos = math.cos(slot.row.frame.heading)
    sin = math.sin(slot.row.frame.heading)
    behind = (cos * slot.behind.end_sigma, sin * slot.behind.end_sigma, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    ahead = (0.0, 0.0, 0.0, cos * slot.ahead.start_sigma, sin * slot.ahead.start_sigma, 0.0, 0.0, 0.0)
    behind_turn = _heading_variance(slot.behind, slot.behind.end_length)
    ahead_turn = _heading_variance(slot.ahead, slot.ahead.start_length)
    diagonal = (front, front, behind_turn, front, front, ahead_turn, END_SIGMA * END_SIGMA, 0.0)
    covariance = tuple(
        behind[number // STATE_COUNT] * behind[number % STATE_COUNT]
        + ahead[number // STATE_COUNT] * ahead[number % STATE_COUNT]
        + (diagonal[number % STATE_COUNT] if number // STATE_COUNT == number % STATE_COUNT else 0.0)
        for number in range(STATE_COUNT * STATE_COUNT)
    )
    road_behind = _road_heading_at(slot.row, slot.behind, slot.behind.end_length)
    road_ahead = _road_heading_at(slot.row, slot.ahead, slot.ahead.start_length)
    return SlotFilter(state, covariance, into_x, into_y, True, road_behind, road_ahead)


def _front_heading(row: SlotRow, member: RowMember, side_length: float) -> float:
    """Return the heading [rad] of a member's front as it was passed; a pillar stands along the row.

    A car stands nearly along the road: a short look at its front shows less of its heading than that.
    """
    road = _road_heading_at(row, member, side_length)
    if is_too_short_for_car(side_length):
        return road
    length = max(member.end - member.start, FRONT_SIGMA)
    share = _heading_variance(member, side_length) / _front_variance(member, side_length)
    turn = row.side * math.atan2(member.end_front - member.start_front, length)
    return road + share * (row.frame.heading + turn - road)


def _road_heading_at(row: SlotRow, member: RowMember, side_length: float) -> float:
    """Return the heading [rad] of the road at a member, at a pillar that of the row."""
    return (
        row.frame.heading if is_too_short_for_car(side_length) else road_heading(row, 0.5 * (member.start + member.end))
    )


def _heading_variance(member: RowMember, side_length: float) -> float:
    """Return the variance [rad2] of that heading: of what was observed, and of how cars stand."""
    return 1.0 / (1.0 / _front_variance(member, side_length) + 1.0 / ASKEW_VARIANCE)


def _front_variance(member: RowMember, side_length: float) -> float:
    """Return the variance [rad2] of a front's heading by what was observed of it alone."""
    if is_too_short_for_car(side_length):
        return FRONT_SIGMA * FRONT_SIGMA
    length = max(member.end - member.start, FRONT_SIGMA)
    return 2.0 * FRONT_SIGMA * FRONT_SIGMA / (length * length)


def predict_slot(slot_filter: SlotFilter, before: Pose, vehicle: Pose, params: MappingParams) -> SlotFilter:
    """Return the filter after the vehicle drove from ``before`` to ``vehicle``: the odometry drifts.

    An error of the distance along an arc is one of the heading, too.
    """
    ux = math.cos(vehicle.heading)
    uy = math.sin(vehicle.heading)
    driven = (vehicle.x - before.x) * ux + (vehicle.y - before.y) * uy
    if driven == 0.0:
        return slot_filter
    curvature = wrap_angle(vehicle.heading - before.heading) / driven
    state = slot_filter.state
    nx = slot_filter.into_x
    ny = slot_filter.into_y
    middle_x = 0.5 * (state[0] + state[AHEAD_OFFSET])
    middle_y = 0.5 * (state[1] + state[AHEAD_OFFSET + 1])
    ahead = (ux, uy, 0.0, ux, uy, 0.0, nx * ux + ny * uy, 0.0)
    turn = (
        vehicle.y - state[1],
        state[0] - vehicle.x,
        1.0,
        vehicle.y - state[AHEAD_OFFSET + 1],
        state[AHEAD_OFFSET] - vehicle.x,
        1.0,
        nx * (vehicle.y - middle_y) + ny * (middle_x - vehicle.x),
        1.0,
    )
    along = tuple(ahead[number] + curvature * turn[number] for number in range(STATE_COUNT))
    q_along = params.distance_variance * abs(driven)
    q_turn = params.heading_variance * abs(driven)
    covariance = tuple(
        slot_filter.covariance[number]
        + q_along * along[number // STATE_COUNT] * along[number % STATE_COUNT]
        + q_turn * turn[number // STATE_COUNT] * turn[number % STATE_COUNT]
        for number in range(STATE_COUNT * STATE_COUNT)
    )
    return slot_filter._replace(covariance=covariance)


def update_slot(slot_filter: SlotFilter, slot: SlotCandidate, reading: Measurement, gate: float) -> SlotFilter:
    """Return the filter after the echo of a reading, if that is within the ``gate`` [1] (chi-square)."""
    echo = predict_echo(slot_filter, slot, reading.sensor)
    if not echo.is_known:
        return slot_filter
    h = echo.gradient
    p = slot_filter.covariance
    gains = tuple(_row_product(p, h, number) for number in range(STATE_COUNT))
    prior = 0.0
    for number in range(STATE_COUNT):
        prior += h[number] * gains[number]
    s = prior + CORRELATED_ECHOES * (reading.variance + FRONT_SIGMA * FRONT_SIGMA)
    innovation = reading.range - echo.predicted.distance
    if innovation * innovation > gate * (prior + reading.variance + FRONT_SIGMA * FRONT_SIGMA):
        return slot_filter
    state = tuple(slot_filter.state[number] + gains[number] / s * innovation for number in range(STATE_COUNT))
    covariance = tuple(
        p[number] - gains[number // STATE_COUNT] * gains[number % STATE_COUNT] / s
        for number in range(STATE_COUNT * STATE_COUNT)
    )
    return slot_filter._replace(state=state, covariance=covariance)


def count_absent(slot_filter: SlotFilter, slot: SlotCandidate, reading: Measurement) -> SlotFilter:
    """Return the filter after a reading, with those counted that pass through a neighbour's flank.

    Beside a perpendicular slot cars are as deep as they are long. Those along the road are no deeper than wide: where
    no corner of such a car is in view an echo tells which they are.
    """
    if slot.type != SlotType.PERPENDICULAR:
        return slot_filter
    echo = predict_echo(slot_filter, slot, reading.sensor)
    state = slot_filter.state
    x = echo.predicted.x - 0.5 * (state[0] + state[AHEAD_OFFSET])
    y = echo.predicted.y - 0.5 * (state[1] + state[AHEAD_OFFSET + 1])
    deep = x * slot_filter.into_x + y * slot_filter.into_y
    beyond_width = deep - CAR_WIDTH - 2.0 * CAR_WIDTH_SIGMA
    tells = beyond_width * reading.sensor.cone_cos > CONE_SPREAD * reading.sensor.cone_sin * echo.predicted.distance
    if not echo.is_known or not tells or deep > CAR_LENGTH - 2.0 * CAR_LENGTH_SIGMA:
        return slot_filter
    beyond = reading.range - echo.predicted.distance
    if beyond > 0.5 * CAR_WIDTH:
        return slot_filter._replace(absent=slot_filter.absent + 1)
    return slot_filter._replace(absent=0) if beyond < CAR_WIDTH_SIGMA else slot_filter


def _row_product(covariance: tuple[float, ...], gradient: tuple[float, ...], row: int) -> float:
    total = 0.0
    for number in range(STATE_COUNT):
        total += covariance[row * STATE_COUNT + number] * gradient[number]
    return total


def predict_echo(slot_filter: SlotFilter, slot: SlotCandidate, sensor: SensorPose) -> SlotEcho:
    """Return the echo that a sensor should measure of the slot; not known where the beam, or the slot's model, ends.

    Cones open by some degrees more or less: the nearest point of the widest must lie in the narrowest.
    """
    is_parallel = slot.type == SlotType.PARALLEL
    depth = CAR_WIDTH if is_parallel else CAR_LENGTH
    length = CAR_LENGTH if is_parallel else CAR_WIDTH
    side = slot.row.side
    best = SlotEcho()
    wide = sensor._replace(cone_sin=CONE_SPREAD * sensor.cone_sin)
    for number in range(2):
        towards = -1.0 if number == 0 else 1.0
        at = AHEAD_OFFSET * number
        corner = Point(slot_filter.state[at], slot_filter.state[at + 1])
        side_length = slot.behind.end_length if number == 0 else slot.ahead.start_length
        is_pillar = is_too_short_for_car(side_length)
        width = side_length if is_pillar else length
        body = side_length if is_pillar else depth
        cos = math.cos(slot_filter.state[at + 2])
        sin = math.sin(slot_filter.state[at + 2])
        far_front = Point(corner.x + towards * width * cos, corner.y + towards * width * sin)
        far_flank = Point(corner.x - side * body * sin, corner.y + side * body * cos)
        best = _nearer(best, predict_range_to_segment(wide, corner, far_front), sensor, slot_filter, at)
        best = _nearer(best, predict_range_to_segment(wide, corner, far_flank), sensor, slot_filter, at)
    if slot.depth < UNKNOWN_DEPTH:
        best = _nearer(best, _range_to_end(slot_filter, wide), sensor, slot_filter, END_INDEX)
    narrow = sensor._replace(cone_sin=sensor.cone_sin / CONE_SPREAD)
    return best._replace(is_known=best.is_known and in_field_of_view(narrow, best.predicted.x, best.predicted.y))


def _range_to_end(slot_filter: SlotFilter, sensor: SensorPose) -> PredictedRange:
    """Return the predicted range to the slot's end between its neighbours."""
    state = slot_filter.state
    nx = slot_filter.into_x
    ny = slot_filter.into_y
    a = state[END_INDEX] - (state[0] * nx + state[1] * ny)
    b = state[END_INDEX] - (state[AHEAD_OFFSET] * nx + state[AHEAD_OFFSET + 1] * ny)
    start = Point(state[0] + a * nx, state[1] + a * ny)
    end = Point(state[AHEAD_OFFSET] + b * nx, state[AHEAD_OFFSET + 1] + b * ny)
    return predict_range_to_segment(sensor, start, end)


def _nearer(before: SlotEcho, new: PredictedRange, sensor: SensorPose, slot_filter: SlotFilter, at: int) -> SlotEcho:
    """Return the nearer of two predicted echoes; the new one is of the states from ``at``."""
    if new.origin == EchoOrigin.OUT_OF_VIEW or new.distance >= before.predicted.distance:
        return before
    u = direction_of(new, sensor)
    if at == END_INDEX:
        into = u.x * slot_filter.into_x + u.y * slot_filter.into_y
        return SlotEcho(new, (0.0,) * END_INDEX + (into, 0.0), new.origin == EchoOrigin.INTERIOR)
    turn = u.y * (new.x - slot_filter.state[at]) - u.x * (new.y - slot_filter.state[at + 1])
    own = (u.x, u.y, turn)
    gradient = own + (0.0, 0.0, 0.0, 0.0, 0.0) if at == 0 else (0.0, 0.0, 0.0) + own + (0.0, 0.0)
    return SlotEcho(new, gradient, new.origin in (EchoOrigin.INTERIOR, EchoOrigin.START))


def is_slot_corner(slot_filter: SlotFilter, point: Point) -> bool:
    """Return whether a point [m] is one of a slot's corners, as far as that is known."""
    for at in (0, AHEAD_OFFSET):
        dx = point.x - slot_filter.state[at]
        dy = point.y - slot_filter.state[at + 1]
        xx = slot_filter.covariance[at * STATE_COUNT + at]
        yy = slot_filter.covariance[(at + 1) * STATE_COUNT + at + 1]
        gate = correction_gate(math.sqrt(xx + yy))
        if slot_filter.is_begun and dx * dx + dy * dy < gate * gate:
            return True
    return False


def slot_frame(slot: SlotCandidate, slot_filter: SlotFilter) -> Pose:
    """Return the middle of a slot's mouth, and the direction along its row that the vehicle is to stand by.

    That turns with the odometry frame, and from the road's towards the neighbours' mean one, by a half. Across the road
    bays may be marked, which follow the road: nobody knows, so half of that.
    """
    state = slot_filter.state
    heading = slot.row.frame.heading
    behind = wrap_angle(state[2] - slot_filter.road_behind)
    ahead = wrap_angle(state[AHEAD_OFFSET + 2] - slot_filter.road_ahead)
    share = 0.5 if slot.type == SlotType.PARALLEL else 0.25
    turn = state[TURN_INDEX] + share * (0.5 * (behind + ahead) - state[TURN_INDEX])
    return Pose(0.5 * (state[0] + state[AHEAD_OFFSET]), 0.5 * (state[1] + state[AHEAD_OFFSET + 1]), heading + turn)


def slot_of_filter(slot: SlotCandidate, slot_filter: SlotFilter, outline: VehicleOutline) -> SlotCandidate:
    """Return the slot as the filter knows it.

    Between neighbours that are misaligned a perpendicular slot lies where the vehicle's middle will be.
    """
    if not slot_filter.is_begun:
        return slot
    state = slot_filter.state
    middle = slot_frame(slot, slot_filter)
    frame = pose_from_frame(pose_to_frame(slot.row.frame, middle._replace(heading=slot.row.frame.heading)), middle)
    a = point_to_frame(state[0], state[1], frame)
    b = point_to_frame(state[AHEAD_OFFSET], state[AHEAD_OFFSET + 1], frame)
    behind_front = slot.row.side * a.y
    ahead_front = slot.row.side * b.y
    moved = behind_front - slot.behind.end_front + ahead_front - slot.ahead.start_front
    depth = slot.depth
    if slot.depth < UNKNOWN_DEPTH:
        depth = state[END_INDEX] - (middle.x * slot_filter.into_x + middle.y * slot_filter.into_y)
    deep = slot.row.side * outline.half_length if slot.type == SlotType.PERPENDICULAR else 0.0
    behind = a.x - deep * math.sin(state[2] - frame.heading)
    ahead = b.x - deep * math.sin(state[AHEAD_OFFSET + 2] - frame.heading)
    known = _with_sigmas(slot, slot_filter.covariance, deep)
    return known._replace(
        row=known.row._replace(frame=frame),
        behind=known.behind._replace(end=behind, end_front=behind_front),
        ahead=known.ahead._replace(start=ahead, start_front=ahead_front),
        front=slot.front + 0.5 * moved,
        depth=depth,
    )


def _with_sigmas(slot: SlotCandidate, covariance: tuple[float, ...], deep: float) -> SlotCandidate:
    """Return the slot with its standard deviations, ``deep`` [m] behind the corners, by its side's sign.

    All echoes share the errors of the sensors' mounting and of the surfaces, however many there are.
    """
    heading = slot.row.frame.heading
    half_cos = 0.5 * math.cos(heading)
    half_sin = 0.5 * math.sin(heading)
    across = Pose(-half_sin, half_cos, 0.0)
    along = Pose(half_cos, half_sin, -0.5 * deep)
    edge = Pose(2.0 * half_cos, 2.0 * half_sin, -deep)
    shared = FRONT_SIGMA * FRONT_SIGMA
    turned = covariance[TURN_INDEX * STATE_COUNT + TURN_INDEX] + slot.row.heading_sigma * slot.row.heading_sigma
    return slot._replace(
        row=slot.row._replace(heading_sigma=math.sqrt(turned)),
        behind=slot.behind._replace(end_sigma=math.sqrt(_sum_variance(covariance, edge, Pose()))),
        ahead=slot.ahead._replace(start_sigma=math.sqrt(_sum_variance(covariance, Pose(), edge))),
        front_sigma=math.sqrt(_sum_variance(covariance, across, across) + shared),
        middle_sigma=math.sqrt(_sum_variance(covariance, along, along) + shared),
    )


def _sum_variance(covariance: tuple[float, ...], behind: Pose, ahead: Pose) -> float:
    """Return the variance of a sum of both neighbours' states, with what each counts in it."""
    weights = (behind.x, behind.y, behind.heading, ahead.x, ahead.y, ahead.heading, 0.0, 0.0)
    total = 0.0
    for row in range(END_INDEX):
        total += weights[row] * _row_product(covariance, weights, row)
    return max(total, 0.0)
