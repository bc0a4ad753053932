"""The vehicle as one step: driver, steering, drive, body.

A communication step of any length is split into equal internal steps of at most
``largest_step``. Inputs that are not finite make the car brake to standstill with the wheel
held, and show as ``vehicle_fault``.
"""

import math
from typing import NamedTuple

from modelkit.maths import is_finite
from modelkit.vocabulary import Gear, Pose
from vehicle_fmu.drive import change_speed
from vehicle_fmu.driver import DriverState, wanted_speed, watch
from vehicle_fmu.interface import VehicleFault, VehicleInput, VehicleOutput, VehicleParams
from vehicle_fmu.kinematic import move
from vehicle_fmu.steering import turn_steering_wheel

PARK = int(Gear.PARK)
REVERSE = int(Gear.REVERSE)
DRIVE = int(Gear.DRIVE)
NO_FAULT = int(VehicleFault.NONE)
BAD_INPUT = int(VehicleFault.BAD_INPUT)
BAD_PARAMETER = int(VehicleFault.BAD_PARAMETER)


class VehicleState(NamedTuple):
    """Everything the vehicle remembers."""

    time_ns: int = 0
    pose: Pose = Pose()
    speed: float = 0.0
    steering_wheel_angle: float = 0.0
    distance: float = 0.0
    gear: int = PARK
    fault: int = NO_FAULT
    driver: DriverState = DriverState()


def initialize(params: VehicleParams) -> tuple[VehicleState, VehicleOutput]:
    """Return the car at rest at its start pose, wheel straight, in park."""
    fault = NO_FAULT if _is_usable(params) else BAD_PARAMETER
    start = params.start if fault == NO_FAULT else Pose(0.0, 0.0, 0.0)
    state = VehicleState(0, start, 0.0, 0.0, 0.0, PARK, fault, DriverState(0, 0, 0, 0, False))
    return state, _outputs(state, params)


def step(
    state: VehicleState, inputs: VehicleInput, params: VehicleParams, dt_ns: int
) -> tuple[VehicleState, VehicleOutput]:
    """Return the vehicle ``dt_ns`` later, its inputs held."""
    if state.fault == NO_FAULT and not _is_finite_input(inputs):
        state = _with_fault(state, BAD_INPUT)
    if state.fault != BAD_PARAMETER and dt_ns > 0:
        count = math.ceil(dt_ns * 1e-9 / params.largest_step - 1e-9)
        start_ns = state.time_ns
        for number in range(1, count + 1):
            state = _internal_step(state, inputs, params, start_ns + dt_ns * number // count)
    return state, _outputs(state, params)


def _internal_step(state: VehicleState, inputs: VehicleInput, params: VehicleParams, next_ns: int) -> VehicleState:
    h = (next_ns - state.time_ns) * 1e-9
    driver = watch(state.driver, inputs.prompt, state.time_ns, params.driver)
    target = _target_speed(state, driver, inputs, params)
    speed = change_speed(state.speed, target, params.drive, h)
    request = state.steering_wheel_angle
    if inputs.steering_active and not driver.takeover and state.fault == NO_FAULT:
        request = inputs.steering_wheel_request
    wheel = turn_steering_wheel(state.steering_wheel_angle, request, params.steering, h)
    ratio = params.steering.ratio
    angle = state.steering_wheel_angle / ratio
    pose = move(state.pose, state.speed, speed, angle, wheel / ratio, params.wheelbase, h)
    distance = state.distance + 0.5 * h * abs(state.speed + speed)
    gear = REVERSE if target < 0.0 else DRIVE if target > 0.0 else state.gear
    return VehicleState(next_ns, pose, speed, wheel, distance, gear, state.fault, driver)


def _target_speed(state: VehicleState, driver: DriverState, inputs: VehicleInput, params: VehicleParams) -> float:
    if state.fault != NO_FAULT or inputs.brake_request or driver.takeover:
        return 0.0
    if inputs.speed_control_active:
        return inputs.speed_request
    return wanted_speed(driver, inputs.advised_speed, state.time_ns, state.distance, params.driver)


def _outputs(state: VehicleState, params: VehicleParams) -> VehicleOutput:
    return VehicleOutput(
        pose=state.pose,
        odometry=state.pose,
        speed=state.speed,
        measured_speed=state.speed,
        steering_wheel_angle=state.steering_wheel_angle,
        front_wheel_angle=state.steering_wheel_angle / params.steering.ratio,
        gear=state.gear,
        brake_pedal=1.0 if state.driver.direction == 0 else 0.0,
        driver_takeover=state.driver.takeover,
        vehicle_fault=state.fault,
        distance=state.distance,
    )


def _with_fault(state: VehicleState, fault: int) -> VehicleState:
    return VehicleState(
        state.time_ns,
        state.pose,
        state.speed,
        state.steering_wheel_angle,
        state.distance,
        state.gear,
        fault,
        state.driver,
    )


def _is_finite_input(inputs: VehicleInput) -> bool:
    return is_finite(inputs.steering_wheel_request + inputs.advised_speed + inputs.speed_request)


def _is_usable(params: VehicleParams) -> bool:
    start = params.start
    return (
        is_finite(start.x + start.y + start.heading)
        and is_finite(params.wheelbase)
        and params.wheelbase > 0.0
        and params.steering.ratio > 0.0
        and params.largest_step > 0.0
    )
