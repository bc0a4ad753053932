"""The filter of a slot against numpy, and over a drive whose odometry drifts."""

import math
from typing import Any

import numpy as np
import pytest

from controller_fmu.parking.chart import ParkingState
from controller_fmu.parking.following.path_tracking import PathProgress
from controller_fmu.parking.geometry.frames import pose_to_frame
from controller_fmu.parking.geometry.outline import vehicle_outline
from controller_fmu.parking.map.params import MappingParams
from controller_fmu.parking.measurement.sensor import (
    Measurement,
    ReadingStatus,
    SensorPose,
    reading_status,
    sensor_pose,
)
from controller_fmu.parking.params import ParkingParams
from controller_fmu.parking.perception import perceive, with_slot_type
from controller_fmu.parking.planning.problem import PlanningRequest
from controller_fmu.parking.signals import ParkingSystemInput
from controller_fmu.parking.slots.candidate import SlotCandidate, SlotType
from controller_fmu.parking.slots.row import RowMember, SlotRow
from controller_fmu.parking.slots.slot_filter import (
    CORRELATED_ECHOES,
    FRONT_SIGMA,
    STATE_COUNT,
    SlotFilter,
    begin_slot_filter,
    count_absent,
    predict_echo,
    predict_slot,
    slot_frame,
    slot_of_filter,
    update_slot,
)
from controller_fmu.parking.state import ParkingMemory, PlanProgress, SearchProgress
from modelkit.geometry import Box
from modelkit.vocabulary import Pose
from tests.parking.simulated_pass import CAR, exact_ranges

PARAMS = MappingParams()
OUTLINE = vehicle_outline(CAR, 1.0)
WIDTH, DEPTH = 3.0, 4.8
BOXES = [Box(-0.9, -2.25, 0.0, 1.8, 4.5), Box(WIDTH + 0.9, -2.25, 0.0, 1.8, 4.5), Box(1.5, -5.3, 0.0, 6.0, 1.0)]


def slot_at(dx: float = 0.0, dy: float = 0.0, turn: float = 0.0) -> SlotCandidate:
    """Return the slot between ``BOXES`` as a row to the right, seen shifted and turned."""
    behind = RowMember(-1.8, 0.0, 0.0, True, True, 0.0, 0.0, 0.05, 0.05)
    ahead = RowMember(WIDTH, WIDTH + 1.8, 0.0, True, True, 0.0, 0.0, 0.05, 0.05)
    row = SlotRow(Pose(dx, dy, turn), -1.0, used=2)
    return SlotCandidate(SlotType.PERPENDICULAR, 0, row, behind, ahead, 0.0, DEPTH)


def matrix(slot_filter: SlotFilter) -> Any:
    return np.array(slot_filter.covariance).reshape(STATE_COUNT, STATE_COUNT)


def echo_of(sensor: SensorPose, measured: float) -> Measurement:
    return Measurement(sensor, ReadingStatus.ECHO, measured, 1e-4)


VIEWS = [(Pose(1.5, 1.2, 1.2), 11), (Pose(1.4, -1.5, 1.5), 9), (Pose(1.6, -2.5, 1.6), 11), (Pose(1.5, -3.2, 1.57), 5)]


@pytest.mark.parametrize(("vehicle", "number"), VIEWS)
def test_gradient_is_the_derivative_of_the_range(vehicle: Pose, number: int) -> None:
    slot = slot_at(0.1, -0.05, 0.02)
    begun = begin_slot_filter(slot)
    sensor = sensor_pose(CAR.ultrasonic.mounts[number], CAR.ultrasonic.half_angle, vehicle)
    echo = predict_echo(begun, slot, sensor)
    assert echo.is_known
    for state in range(STATE_COUNT):
        moved = [
            begun._replace(state=tuple(x + (d if n == state else 0.0) for n, x in enumerate(begun.state)))
            for d in (-1e-5, 1e-5)
        ]
        low, high = (predict_echo(item, slot, sensor).predicted.distance for item in moved)
        assert echo.gradient[state] == pytest.approx((high - low) / 2e-5, abs=1e-3)


def test_behind_a_pillar_nothing_is_known_of_a_flank() -> None:
    """The rear left sensor of a vehicle deep in the slot measures a flank; beside a pillar of 0.5 m it need be none."""
    vehicle, slot = Pose(1.5, -3.2, 0.5 * math.pi), slot_at()
    slot = slot._replace(depth=50.0)
    sensor = sensor_pose(CAR.ultrasonic.mounts[9], CAR.ultrasonic.half_angle, vehicle)
    assert predict_echo(begin_slot_filter(slot), slot, sensor).is_known
    pillar = slot.behind._replace(start=-0.5, end_length=0.5, end_front=0.2)
    beside = slot._replace(behind=pillar)
    begun = begin_slot_filter(beside)
    assert not predict_echo(begun, beside, sensor).is_known
    assert begun.state[2] == 0.0, "so short a front tells no heading"


def test_what_the_slot_is_unsure_follows_from_both_neighbours() -> None:
    """Half a vehicle deep its middle lies between flanks; all echoes share what 3 cm of mounting and surfaces err."""
    slot = slot_at()
    drifted = predict_slot(begin_slot_filter(slot), Pose(), Pose(6.0, 0.6, 0.2), PARAMS)
    known = slot_of_filter(slot, drifted, OUTLINE)
    turned = -0.5 * slot.row.side * OUTLINE.half_length
    for found, weights in (
        (known.middle_sigma, [0.5, 0.0, turned, 0.5, 0.0, turned, 0.0, 0.0]),
        (known.front_sigma, [0.0, 0.5, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0]),
    ):
        assert found == pytest.approx(math.sqrt(np.array(weights) @ matrix(drifted) @ weights + FRONT_SIGMA**2))
    assert known.row.heading_sigma > slot.row.heading_sigma


@pytest.mark.parametrize(("kind", "share"), [(SlotType.PARALLEL, 0.5), (SlotType.PERPENDICULAR, 0.25)])
def test_the_vehicle_is_to_stand_between_the_road_and_its_neighbours(kind: SlotType, share: float) -> None:
    slot = slot_at()._replace(type=kind)
    begun = begin_slot_filter(slot)
    turned = begun._replace(state=(*begun.state[:2], 0.08, *begun.state[3:5], 0.04, *begun.state[6:]))
    assert slot_of_filter(slot, turned, OUTLINE).row.frame.heading == pytest.approx(share * 0.06)
    drifted = turned._replace(state=(*turned.state[:7], 0.06))
    assert slot_of_filter(slot, drifted, OUTLINE).row.frame.heading == pytest.approx(0.06)


def test_a_heading_that_was_unknown_does_not_turn_the_row() -> None:
    """Of a neighbour only 0.3 m had been seen: what its flank shows says little of the odometry's drift."""
    turns = []
    for seen in (1.8, 0.3):
        slot = slot_at()
        slot = slot._replace(ahead=slot.ahead._replace(end=WIDTH + seen))
        before = predict_slot(begin_slot_filter(slot), Pose(), Pose(6.0, 0.6, 0.2), PARAMS)
        p, h = matrix(before), np.eye(STATE_COUNT)[5]
        turns.append(float(p[7] @ h / (h @ p @ h)))
    assert 0.0 < turns[1] < 0.5 * turns[0]


def test_an_error_of_the_distance_turns_the_frame_only_in_a_bend() -> None:
    begun = begin_slot_filter(slot_at())
    straight, bend = (matrix(predict_slot(begun, Pose(), to, PARAMS)) for to in (Pose(2.0), Pose(2.0, 0.0, 0.5)))
    assert straight[7, 7] == pytest.approx(PARAMS.heading_variance * 2.0)
    way = 2.0 * math.cos(0.5)
    assert bend[7, 7] == pytest.approx((PARAMS.heading_variance + PARAMS.distance_variance * (0.5 / way) ** 2) * way)


def test_update_is_the_kalman_filter_of_the_textbook() -> None:
    slot = slot_at(0.1, -0.05, 0.02)
    before = predict_slot(begin_slot_filter(slot), Pose(), Pose(6.0, 0.6, 0.2), PARAMS)
    sensor = sensor_pose(CAR.ultrasonic.mounts[9], CAR.ultrasonic.half_angle, Pose(1.4, -1.5, 1.5))
    echo = predict_echo(before, slot, sensor)
    h, p = np.array(echo.gradient), matrix(before)
    s = h @ p @ h + CORRELATED_ECHOES * (1e-4 + FRONT_SIGMA**2)
    after = update_slot(before, slot, echo_of(sensor, echo.predicted.distance + 0.05), 9.0)
    assert after.state == pytest.approx(tuple(np.array(before.state) + p @ h / s * 0.05))
    assert matrix(after) == pytest.approx(p - np.outer(p @ h, p @ h) / s)
    far = update_slot(before, slot, echo_of(sensor, echo.predicted.distance + 1.0), 9.0)
    assert far == before, "an echo of something else"


@pytest.mark.parametrize(("depth", "absent"), [(4.5, 0), (1.9, 12)])
def test_cars_along_the_road_contradict_a_slot_across_it(depth: float, absent: int) -> None:
    """Neighbours as deep as a car is wide: beside a vehicle deep between them nothing is measured."""
    boxes = [Box(x, -0.5 * depth, 0.0, 1.8, depth) for x in (-0.9, WIDTH + 0.9)]
    slot = slot_at()._replace(depth=50.0)
    slot_filter = begin_slot_filter(slot)
    for _ in range(12):
        vehicle = Pose(1.5, -2.7, 0.5 * math.pi)
        measured = exact_ranges(vehicle, boxes, CAR.ultrasonic)[9]
        sensor = sensor_pose(CAR.ultrasonic.mounts[9], CAR.ultrasonic.half_angle, vehicle)
        slot_filter = count_absent(slot_filter, slot, echo_of(sensor, measured))
    assert slot_filter.absent == absent
    wide = slot._replace(ahead=slot.ahead._replace(start=6.5))
    for width, kind in (
        (slot, SlotType.PERPENDICULAR),
        (wide, SlotType.PARALLEL if absent else SlotType.PERPENDICULAR),
    ):
        search = SearchProgress(slot=width, slot_filter=slot_filter)
        assert with_slot_type(search, False, ParkingParams(car=CAR)).slot.type == kind


@pytest.mark.parametrize("is_too_shallow", [False, True])
@pytest.mark.parametrize("ahead", [2.6, 6.5])
def test_a_slot_too_shallow_to_stand_across_is_one_along_the_road_if_it_is_long_enough(
    is_too_shallow: bool, ahead: float
) -> None:
    slot = slot_at()
    search = SearchProgress(slot=slot._replace(ahead=slot.ahead._replace(start=ahead)))
    kind = with_slot_type(search, is_too_shallow, ParkingParams(car=CAR)).slot.type
    assert kind == (SlotType.PARALLEL if is_too_shallow and ahead > 6.0 else SlotType.PERPENDICULAR)


def errors_after_drive(seed: int) -> tuple[float, float, float]:
    """Return middle, front and turn of the slot after a drive into it, less the truth; the odometry drifts."""
    rng = np.random.default_rng(seed)
    slot = slot_at(rng.normal(0.0, 0.05), rng.normal(0.0, 0.05), rng.normal(0.0, 0.01))
    slot_filter = begin_slot_filter(slot)
    scale, drift = rng.normal(0.0, 0.005), rng.normal(0.0, 0.002)
    sensors = CAR.ultrasonic
    true = believed = Pose(1.5 + rng.normal(0.0, 0.1), 1.5, 0.5 * math.pi + rng.normal(0.0, 0.05))
    for _ in range(120):
        step, turn = -0.04, (0.5 * math.pi - true.heading) * 0.02
        true = Pose(true.x + step * math.cos(true.heading), true.y + step * math.sin(true.heading), true.heading + turn)
        way, heading = step * (1.0 + scale), believed.heading + turn + drift * step
        before, believed = (
            believed,
            Pose(believed.x + way * math.cos(heading), believed.y + way * math.sin(heading), heading),
        )
        slot_filter = predict_slot(slot_filter, before, believed, PARAMS)
        for number, exact in enumerate(exact_ranges(true, BOXES, sensors)):
            measured = exact + 0.01 * rng.standard_normal()
            if reading_status(measured, sensors) == ReadingStatus.ECHO:
                sensor = sensor_pose(sensors.mounts[number], sensors.half_angle, believed)
                slot_filter = update_slot(slot_filter, slot, echo_of(sensor, measured), PARAMS.gate)
    found = slot_of_filter(slot, slot_filter, OUTLINE)
    turned = believed.heading - true.heading
    c, s = math.cos(turned), math.sin(turned)
    middle_x, middle_y = 0.5 * WIDTH - true.x, -true.y
    expected = (believed.x + c * middle_x - s * middle_y, believed.y + s * middle_x + c * middle_y)
    middle = 0.5 * (found.behind.end + found.ahead.start)
    frame = found.row.frame
    c, s = math.cos(frame.heading), math.sin(frame.heading)
    at = (frame.x + c * middle + s * found.front, frame.y + s * middle - c * found.front)
    return at[0] - expected[0], at[1] - expected[1], frame.heading - turned


def test_a_slot_is_known_better_after_the_way_in() -> None:
    """It was found with errors of 5 cm and 0.6 deg; the odometry is off by 0.5 % and 0.1 deg per metre."""
    errors = np.array([errors_after_drive(seed) for seed in range(6)])
    along, front, turn = np.sqrt(np.mean(np.square(errors), axis=0))
    assert along < 0.03
    assert front < 0.06
    assert turn < 0.012


def test_the_path_moves_with_the_slot() -> None:
    """The slot was found 6 cm aside and turned by 0.6 deg: driving in, the path's end moves as the slot does."""
    slot = slot_at(0.06, 0.0, 0.01)
    params = ParkingParams(car=CAR)
    sensors = CAR.ultrasonic
    pose = Pose(1.5, 0.5, 0.5 * math.pi)
    memory = ParkingMemory(
        state=ParkingState.DRIVING,
        search=SearchProgress(slot=slot, slot_filter=begin_slot_filter(slot)),
        progress=PathProgress(begin=pose),
        plan=PlanProgress(request=PlanningRequest(goal=Pose(1.56, -3.6, 0.5 * math.pi + 0.01))),
    )
    begun = memory
    for _ in range(60):
        pose = pose._replace(y=pose.y - 0.05)
        readings = tuple(exact_ranges(pose, BOXES, sensors))
        inputs = ParkingSystemInput(ultrasonic=readings, odometry=pose, measured_speed=-1.0)
        memory = perceive(memory, inputs, params, round(sensors.cycle * 1e9))
    before = slot_frame(slot, begun.search.slot_filter)
    after = slot_frame(memory.search.slot, memory.search.slot_filter)
    assert math.hypot(after.x - before.x, after.y - before.y) > 0.03
    for moved, initial in (
        (memory.progress.begin, begun.progress.begin),
        (memory.plan.request.goal, begun.plan.request.goal),
    ):
        assert pose_to_frame(moved, after) == pytest.approx(pose_to_frame(initial, before), abs=1e-9)
