"""One internal step of the car: driver, gear, steering, drive, body, odometry."""

from typing import NamedTuple

from modelkit.vocabulary import Gear, Pose
from vehicle_fmu.body import KINEMATIC, BodyState, motion_of, place, push_body, wheel_speed
from vehicle_fmu.chassis import ChassisParams, RoadParams
from vehicle_fmu.double_track import DoubleTrackParams
from vehicle_fmu.drive import change_speed
from vehicle_fmu.driver import DriverState, brakes, grabs, wanted_speed, watch
from vehicle_fmu.drivetrain import NO_GEAR, Pedals, Selector, geared_speed, press, shift
from vehicle_fmu.effort import Effort
from vehicle_fmu.interface import DriveParams, DriverParams, SteeringParams, VehicleInput, VehicleParams
from vehicle_fmu.kinematic import move
from vehicle_fmu.odometry import OdometryParams, OdometryState, reckon
from vehicle_fmu.single_track import SingleTrackParams
from vehicle_fmu.steering import SteeringState, hold_request, pass_request, take_up_play, turn_steering_wheel

PARK = int(Gear.PARK)


class CarParams(NamedTuple):
    """The vehicle's parameters without scene, sensors and outline: what an internal step needs."""

    body: int
    wheelbase: float
    steering: SteeringParams
    drive: DriveParams
    driver: DriverParams
    chassis: ChassisParams
    single_track: SingleTrackParams
    double_track: DoubleTrackParams
    road: RoadParams
    odometry: OdometryParams


class CarState(NamedTuple):
    """Everything the moving car and its driver remember."""

    time_ns: int = 0
    pose: Pose = Pose()
    speed: float = 0.0
    rolled_speed: float = 0.0
    """Speed of the rear wheels' rims [m/s]."""
    steering_wheel_angle: float = 0.0
    distance: float = 0.0
    brake_pedal: float = 1.0
    driver: DriverState = DriverState()
    selector: Selector = Selector()
    steering: SteeringState = SteeringState()
    pedals: Pedals = Pedals()
    body: BodyState = BodyState()
    odometry: OdometryState = OdometryState()


class Move(NamedTuple):
    """What the drive and the body did in a step."""

    pedals: Pedals
    body: BodyState
    pose: Pose
    speed: float
    rolled_speed: float


def car_params(params: VehicleParams) -> CarParams:
    """Return the part of the parameters that an internal step needs."""
    return CarParams(
        params.body,
        params.wheelbase,
        params.steering,
        params.drive,
        params.driver,
        params.chassis,
        params.single_track,
        params.double_track,
        params.road,
        params.odometry,
    )


def parked_car(start: Pose, params: CarParams) -> CarState:
    """Return the car at rest, wheel straight, in park, the brake pressed."""
    return CarState(
        0,
        start,
        0.0,
        0.0,
        0.0,
        0.0,
        1.0,
        DriverState(0, 0, 0, 0, False),
        Selector(PARK, NO_GEAR, 0),
        hold_request(0.0, 0.0),
        Pedals(0.0, 0.0, Effort(0.0, params.chassis.mass * params.drive.hold_deceleration)),
        place(start, params.body, params.wheelbase, params.chassis, params.double_track, params.road),
        OdometryState(start, 0.0),
    )


def step_car(state: CarState, inputs: VehicleInput, faulty: bool, params: CarParams, next_ns: int) -> CarState:
    """Return the car at ``next_ns``; a faulty one brakes and holds its wheel."""
    h = (next_ns - state.time_ns) * 1e-9
    driver = watch(state.driver, inputs.prompt, state.time_ns, params.driver)
    target = 0.0
    if not faulty:
        target = _target_speed(state, driver, inputs, params.driver)
    selector = shift(state.selector, target, state.speed, params.drive.shift_time, next_ns - state.time_ns)
    steering = _steer(state, inputs, driver.takeover or faulty, params, next_ns)
    wheel = turn_steering_wheel(state.steering_wheel_angle, steering.lagged, params.steering, h, state.speed)
    play = take_up_play(steering.play, wheel, params.steering.backlash)
    angle = state.steering.play / params.steering.ratio
    next_angle = play / params.steering.ratio
    moved = _drive(state, geared_speed(selector, target), selector.gear, angle, next_angle, params, h)
    odometry = OdometryState(moved.pose, 0.0)
    if not params.odometry.perfect:
        way = 0.5 * h * (state.rolled_speed + moved.rolled_speed)
        odometry = reckon(state.odometry, way, 0.5 * (angle + next_angle), params.wheelbase, params.odometry)
    return CarState(
        next_ns,
        moved.pose,
        moved.speed,
        moved.rolled_speed,
        wheel,
        state.distance + 0.5 * h * abs(state.speed + moved.speed),
        _brake_pedal(state.time_ns, driver, inputs.speed_control_active, params.driver),
        driver,
        selector,
        SteeringState(steering.line, steering.lagged, play),
        moved.pedals,
        moved.body,
        odometry,
    )


def _drive(
    state: CarState, target: float, gear: int, angle: float, next_angle: float, params: CarParams, h: float
) -> Move:
    if params.body == KINEMATIC:
        speed = change_speed(state.speed, target, params.drive, h)
        pose = move(state.pose, state.speed, speed, angle, next_angle, params.wheelbase, h)
        return Move(state.pedals, state.body, pose, speed, speed)
    pedals = press(state.pedals, target, state.speed, gear, params.chassis.mass, params.drive, h)
    effort = pedals.effort
    if gear == PARK:
        effort = Effort(0.0, params.drive.brake_force_limit)
    body = push_body(
        state.body,
        0.5 * (angle + next_angle),
        effort,
        params.body,
        params.wheelbase,
        params.chassis,
        params.single_track,
        params.double_track,
        params.road,
        h,
    )
    motion = motion_of(body, params.body)
    rolled = wheel_speed(body, params.body, params.double_track.hub.radius)
    return Move(pedals, body, motion.pose, motion.speed_x, rolled)


def _steer(state: CarState, inputs: VehicleInput, held: bool, params: CarParams, next_ns: int) -> SteeringState:
    """Return the steering with the request of the controller, or of the driver, on its way."""
    if grabs(state.time_ns, params.driver):
        return hold_request(params.driver.grab_angle, state.steering.play)
    if inputs.steering_active and not held:
        return pass_request(state.steering, inputs.steering_wheel_request, params.steering, state.time_ns, next_ns)
    return hold_request(state.steering_wheel_angle, state.steering.play)


def _target_speed(state: CarState, driver: DriverState, inputs: VehicleInput, params: DriverParams) -> float:
    if inputs.brake_request or driver.takeover or brakes(state.time_ns, params):
        return 0.0
    if inputs.speed_control_active:
        return inputs.speed_request
    return wanted_speed(driver, inputs.advised_speed, state.time_ns, state.distance, params)


def _brake_pedal(time_ns: int, driver: DriverState, speed_control: bool, params: DriverParams) -> float:
    if brakes(time_ns, params) or driver.takeover:
        return 1.0
    return 1.0 if driver.direction == 0 and not speed_control else 0.0
