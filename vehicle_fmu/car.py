"""One internal step of the car: driver, gear, steering, drive, body, odometry."""

from typing import NamedTuple

from modelkit.maths import clamp
from modelkit.vocabulary import Gear, Pose
from vehicle_fmu.bodies.body import BodyState, motion_of, place, push_body, wheel_speed
from vehicle_fmu.bodies.kinematic import KinematicInput, KinematicState, move, resting_at
from vehicle_fmu.drive import change_speed, push_speed
from vehicle_fmu.driver import (
    DriverState,
    brakes,
    follows_bend,
    front_wheel_angle_along_bend,
    grabs,
    target_speed,
    watch,
)
from vehicle_fmu.drivetrain import Pedals, Rolling, Selector, along, attainable_speed, obey, press, shift, target_gear
from vehicle_fmu.effort import Effort, mean_effort
from vehicle_fmu.interface import Body, DriverParams, ManualInput, VehicleInput, VehicleParams
from vehicle_fmu.manual_driving import has_pedals, lever_gear, roll, stops_controller, tread
from vehicle_fmu.odometry import OdometryState, reckon
from vehicle_fmu.steering import (
    DELAY_CELLS,
    SteeringState,
    delay_request,
    pass_request,
    take_up_play,
    turn_steering_wheel,
)


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
    request_line: tuple[float, ...] = (0.0,) * DELAY_CELLS
    """Requests [rad] of the steering's dead time, oldest first; without one, they are not kept."""
    pedals: Pedals = Pedals()
    kinematic: KinematicState = KinematicState()
    body: BodyState = BodyState()
    odometry: OdometryState = OdometryState()


def initial_car(start: Pose, usable: bool, params: VehicleParams) -> CarState:
    """Return the car at rest, wheel straight, in park, the brake pressed; on its tyres if its numbers are usable."""
    holding = Effort(brake=params.chassis.mass * params.drive.hold_deceleration)
    return CarState(
        pose=start,
        pedals=Pedals(effort=holding),
        kinematic=resting_at(start),
        body=place(start, params.body if usable else Body.KINEMATIC, params),
        odometry=OdometryState(start),
    )


def step_car(state: CarState, inputs: VehicleInput, faulty: bool, params: VehicleParams, next_ns: int) -> CarState:
    """Return the car at ``next_ns``; a faulty one brakes and holds its wheel."""
    h = (next_ns - state.time_ns) * 1e-9
    driver = watch(state.driver, inputs.prompt, state.time_ns, params.driver)
    braked = inputs.brake_request or brakes(state.time_ns, params.driver) or stops_controller(inputs)
    free = not (faulty or driver.takeover or braked)
    target = _target_speed(state, driver, inputs, params.driver) if free else 0.0
    wanted = target_gear(state.selector.gear, target)
    treads = free and has_pedals(inputs)
    if treads:
        wanted = lever_gear(inputs.manual, state.selector.gear, state.speed)
    selector = shift(state.selector, wanted, state.speed, params.drive.shift_time, next_ns - state.time_ns)
    state = _steer(state, inputs, driver.takeover or faulty, params, next_ns)
    steering = state.steering
    wheel = _turn_wheel(state, params, h)
    play = take_up_play(steering.play, wheel, params.steering.backlash)
    state = state._replace(driver=driver, selector=selector)
    angles = (steering.play / params.car.steering.ratio, play / params.car.steering.ratio)
    speed, rolled_speed = state.speed, state.rolled_speed
    if treads:
        state = _tread(state, inputs.manual, angles, params, h)
    else:
        state = _go(state, inputs, attainable_speed(selector, target), angles, params, h)
    odometry = OdometryState(state.pose)
    if not params.odometry.ideal:
        arc = 0.5 * h * (rolled_speed + state.rolled_speed)
        odometry = reckon(state.odometry, arc, 0.5 * (angles[0] + angles[1]), params.car.wheelbase, params.odometry)
    driven = inputs.speed_control_active or inputs.force_control_active
    return state._replace(
        time_ns=next_ns,
        steering_wheel_angle=wheel,
        distance=state.distance + 0.5 * h * abs(speed + state.speed),
        brake_pedal=1.0 if faulty else _brake_pedal(state.time_ns, driver, driven, inputs, params.driver),
        steering=state.steering._replace(play=play),
        odometry=odometry,
    )


def _steer(state: CarState, inputs: VehicleInput, released: bool, params: VehicleParams, next_ns: int) -> CarState:
    """Return the car with the request of whoever holds the wheel: driver, controller or nobody."""
    grabbed = grabs(state.time_ns, params.driver)
    held = params.driver.steering_override_angle if grabbed else state.steering_wheel_angle
    if not (grabbed or inputs.steering_active or released) and follows_bend(state.driver, params.driver):
        car = params.car
        angle = front_wheel_angle_along_bend(state.pose, params.start, car.wheelbase, params.driver.road_curvature)
        held = car.steering.ratio * angle
    passes = inputs.steering_active and not released and not grabbed
    request = inputs.steering_wheel_request if passes else held
    if params.steering.dead_time > 0.0:
        line = (held,) * DELAY_CELLS
        if passes:
            line = delay_request(state.request_line, request, params.steering.dead_time, state.time_ns, next_ns)
        state = state._replace(request_line=line)
        request = line[0]
    if passes:
        return state._replace(steering=pass_request(state.steering, request, params.steering, state.time_ns, next_ns))
    return state._replace(steering=state.steering._replace(lagged=held))


def _turn_wheel(state: CarState, params: VehicleParams, h: float) -> float:
    """Return the steering-wheel angle [rad] ``h`` [s] later; a stuck wheel stays."""
    wheel = state.steering_wheel_angle
    if state.time_ns * 1e-9 >= params.steering.fault_time:
        return wheel
    rate = params.steering.standstill_rate
    return turn_steering_wheel(wheel, state.steering.lagged, params.car.steering, rate, h, state.speed)


def _go(
    state: CarState, inputs: VehicleInput, target: float, angles: tuple[float, float], params: VehicleParams, h: float
) -> CarState:
    """Return the car ``h`` [s] later on the way to ``target`` [m/s], front wheels turning from angle to angle.

    A ``target`` of 0 stops it, whatever force is requested.
    """
    forced = inputs.force_control_active and target != 0.0
    gear = state.selector.gear
    if params.body == Body.KINEMATIC:
        speed = change_speed(state.speed, target, params.drive, h)
        if forced:
            speed = push_speed(state.speed, inputs.force_request, params.chassis.mass, along(gear), h)
        return _roll(state, speed, angles, params, h)
    rolling = Rolling(state.speed, gear)
    if forced:
        pedals = obey(state.pedals, inputs.force_request, rolling, params.drive, h)
    else:
        pedals = press(state.pedals, target, rolling, params.chassis.mass, params.drive, h)
    return _push(state, pedals, params, h)


def _tread(
    state: CarState, manual: ManualInput, angles: tuple[float, float], params: VehicleParams, h: float
) -> CarState:
    """Return the car ``h`` [s] later under a person's feet."""
    pedals = tread(state.pedals, manual, Rolling(state.speed, state.selector.gear), params.drive, h)
    if params.body != Body.KINEMATIC:
        return _push(state, pedals, params, h)
    speed = roll(state.speed, _at_wheels(pedals.effort, state.selector.gear, params), params.chassis, h)
    state = state._replace(pedals=pedals)
    return _roll(state, speed, angles, params, h)


def _roll(state: CarState, speed: float, angles: tuple[float, float], params: VehicleParams, h: float) -> CarState:
    """Return the car ``h`` [s] later, of the body without tyres, whose ``speed`` [m/s] is known."""
    now = KinematicInput(state.speed, angles[0])
    moved = move(state.kinematic, now, KinematicInput(speed, angles[1]), params.car.wheelbase, h)
    return state._replace(kinematic=moved, pose=moved.pose, speed=speed, rolled_speed=speed)


def _push(state: CarState, pedals: Pedals, params: VehicleParams, h: float) -> CarState:
    """Return the car ``h`` [s] later, of a body with mass; its error is of second order in ``h``.

    The mean of the forces of the old and the new pedals acts on it. The slip of the tyres is that of the old motion:
    for it the front wheels have their mean angle over half a step before and after.
    """
    steering = state.steering
    early = take_up_play(steering.play, _turn_wheel(state, params, 0.25 * h), params.steering.backlash)
    late = take_up_play(steering.play, _turn_wheel(state, params, 0.75 * h), params.steering.backlash)
    angle = 0.5 * (steering.late + early) / params.car.steering.ratio
    effort = _at_wheels(mean_effort(state.pedals.effort, pedals.effort), state.selector.gear, params)
    state = state._replace(body=push_body(state.body, angle, effort, params, h), steering=steering._replace(late=late))
    motion = motion_of(state.body, params.body)
    rolled = wheel_speed(state.body, params.body, params.double_track.hub.radius)
    return state._replace(pose=motion.pose, speed=motion.speed_x, rolled_speed=rolled, pedals=pedals)


def _at_wheels(effort: Effort, gear: int, params: VehicleParams) -> Effort:
    """Return what reaches the wheels: in park they are locked."""
    return Effort(brake=params.drive.brake_force_limit) if gear == Gear.PARK else effort


def _target_speed(state: CarState, driver: DriverState, inputs: VehicleInput, params: DriverParams) -> float:
    if inputs.speed_control_active or inputs.force_control_active:
        return inputs.speed_request
    return target_speed(driver, inputs.advised_speed, state.time_ns, state.distance, params)


def _brake_pedal(time_ns: int, driver: DriverState, driven: bool, inputs: VehicleInput, params: DriverParams) -> float:
    if brakes(time_ns, params) or driver.takeover:
        return 1.0
    if inputs.manual.active:
        return clamp(inputs.manual.brake, 0.0, 1.0)
    return 1.0 if driver.direction == 0 and not driven else 0.0
