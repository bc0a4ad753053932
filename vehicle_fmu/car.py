"""One internal step of the car: driver, gear, steering, drive, body, odometry."""

from typing import NamedTuple

from modelkit.vocabulary import Gear, Pose
from vehicle_fmu.body import KINEMATIC, BodyState, motion_of, place, push_body, wheel_speed
from vehicle_fmu.drive import change_speed, push_speed
from vehicle_fmu.driver import DriverState, brakes, grabs, wanted_speed, watch
from vehicle_fmu.drivetrain import NO_GEAR, Pedals, Selector, along, geared_speed, obey, press, shift
from vehicle_fmu.effort import Effort
from vehicle_fmu.interface import DriverParams, VehicleInput, VehicleParams
from vehicle_fmu.kinematic import move
from vehicle_fmu.odometry import OdometryState, reckon
from vehicle_fmu.steering import SteeringState, hold_request, pass_request, take_up_play, turn_steering_wheel

PARK = int(Gear.PARK)


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


def parked_car(start: Pose, usable: bool, params: VehicleParams) -> CarState:
    """Return the car at rest, wheel straight, in park, the brake pressed; on its tyres if its numbers are usable."""
    body = params.body if usable else KINEMATIC
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
        Pedals(0.0, 0.0, Effort(0.0, params.chassis.mass * params.drive.hold_deceleration), 0.0),
        place(start, body, params.wheelbase, params.chassis, params.double_track, params.road),
        OdometryState(start, 0.0),
    )


def step_car(state: CarState, inputs: VehicleInput, faulty: bool, params: VehicleParams, next_ns: int) -> CarState:
    """Return the car at ``next_ns``; a faulty one brakes and holds its wheel."""
    h = (next_ns - state.time_ns) * 1e-9
    driver = watch(state.driver, inputs.prompt, state.time_ns, params.driver)
    free = not (faulty or inputs.brake_request or driver.takeover or brakes(state.time_ns, params.driver))
    target = 0.0
    if free:
        target = _target_speed(state, driver, inputs, params.driver)
    selector = shift(state.selector, target, state.speed, params.drive.shift_time, next_ns - state.time_ns)
    steering = state.steering
    if grabs(state.time_ns, params.driver):
        steering = hold_request(params.driver.grab_angle, steering.play)
    elif inputs.steering_active and not driver.takeover and not faulty:
        steering = pass_request(steering, inputs.steering_wheel_request, params.steering, state.time_ns, next_ns)
    else:
        steering = hold_request(state.steering_wheel_angle, steering.play)
    wheel = turn_steering_wheel(state.steering_wheel_angle, steering.lagged, params.steering, h, state.speed)
    play = take_up_play(steering.play, wheel, params.steering.backlash)
    angle = state.steering.play / params.steering.ratio
    next_angle = play / params.steering.ratio
    target = geared_speed(selector, target)
    forced = free and inputs.force_control_active and target != 0.0
    middle = 0.5 * (angle + next_angle)
    pedals = state.pedals
    body = state.body
    if params.body == KINEMATIC:
        speed = change_speed(state.speed, target, params.drive, h)
        if forced:
            speed = push_speed(state.speed, inputs.force_request, params.chassis.mass, along(selector), h)
        pose = move(state.pose, state.speed, speed, angle, next_angle, params.wheelbase, h)
        rolled = speed
    else:
        if forced:
            pedals = obey(pedals, inputs.force_request, state.speed, selector.gear, params.drive, h)
        else:
            pedals = press(pedals, target, state.speed, selector.gear, params.chassis.mass, params.drive, h)
        body = _push(body, middle, pedals.effort, selector.gear, params, h)
        motion = motion_of(body, params.body)
        pose = motion.pose
        speed = motion.speed_x
        rolled = wheel_speed(body, params.body, params.double_track.hub.radius)
    odometry = OdometryState(pose, 0.0)
    if not params.odometry.perfect:
        way = 0.5 * h * (state.rolled_speed + rolled)
        odometry = reckon(state.odometry, way, middle, params.wheelbase, params.odometry)
    return CarState(
        next_ns,
        pose,
        speed,
        rolled,
        wheel,
        state.distance + 0.5 * h * abs(state.speed + speed),
        _brake_pedal(state.time_ns, driver, inputs.speed_control_active or inputs.force_control_active, params.driver),
        driver,
        selector,
        SteeringState(steering.line, steering.lagged, play),
        pedals,
        body,
        odometry,
    )


def _push(body: BodyState, angle: float, effort: Effort, gear: int, params: VehicleParams, h: float) -> BodyState:
    if gear == PARK:
        effort = Effort(0.0, params.drive.brake_force_limit)
    return push_body(
        body,
        angle,
        effort,
        params.body,
        params.wheelbase,
        params.chassis,
        params.single_track,
        params.double_track,
        params.road,
        h,
    )


def _target_speed(state: CarState, driver: DriverState, inputs: VehicleInput, params: DriverParams) -> float:
    if inputs.speed_control_active or inputs.force_control_active:
        return inputs.speed_request
    return wanted_speed(driver, inputs.advised_speed, state.time_ns, state.distance, params)


def _brake_pedal(time_ns: int, driver: DriverState, driven: bool, params: DriverParams) -> float:
    if brakes(time_ns, params) or driver.takeover:
        return 1.0
    return 1.0 if driver.direction == 0 and not driven else 0.0
