"""The vehicle as one step: the car and its driver, then what its sensors tell.

A communication step of any length is split into equal internal steps of at most
``largest_step`` (``body_step`` for the bodies with mass). Inputs that are not finite make the car
brake to standstill with the wheel held, and show as ``vehicle_fault``. Sensors with a cycle are
read at the end of a communication step in which their time has come.
"""

import math
from typing import NamedTuple

from modelkit.geometry import NO_HIT
from modelkit.maths import is_finite
from modelkit.vocabulary import Pose, VehicleFault
from vehicle_fmu.bodies.body import speed_for_display
from vehicle_fmu.car import CarState, initial_car, step_car
from vehicle_fmu.driver import presses_confirm, switch_is_on
from vehicle_fmu.interface import Body, VehicleInput, VehicleOutput, VehicleParams
from vehicle_fmu.odometry import wheel_speed_reading
from vehicle_fmu.scene import clearance
from vehicle_fmu.ultrasonic import UltrasonicState, first_readings, is_due, measure
from vehicle_fmu.usable import is_usable


class VehicleState(NamedTuple):
    """Everything the vehicle remembers."""

    car: CarState = CarState()
    ultrasonic: UltrasonicState = UltrasonicState()
    fault: int = VehicleFault.NONE


def initialize(params: VehicleParams) -> tuple[VehicleState, VehicleOutput]:
    """Return the car at rest at its start pose, wheel straight, in park."""
    state = begin(params)
    gap = 0.0
    if state.fault == VehicleFault.NONE:
        gap = _clearance(state.car.pose, params, 0)
    return state, outputs(state, gap, False, params)


def step(
    state: VehicleState, inputs: VehicleInput, params: VehicleParams, dt_ns: int
) -> tuple[VehicleState, VehicleOutput]:
    """Return the vehicle ``dt_ns`` later, its inputs held."""
    state = advance(state, inputs, params, dt_ns)
    gap = 0.0
    if state.fault != VehicleFault.BAD_PARAMETER:
        gap = _clearance(state.car.pose, params, state.car.time_ns)
    return state, outputs(state, gap, inputs.manual.active and inputs.manual.confirm, params)


def begin(params: VehicleParams) -> VehicleState:
    """Return the vehicle at time zero."""
    fault = VehicleFault.NONE
    start = params.start
    ultrasonic = UltrasonicState()
    if is_usable(params):
        ultrasonic = first_readings(start, params.scene, params.car.ultrasonic, params.ultrasonic)
    else:
        fault = VehicleFault.BAD_PARAMETER
        start = Pose()
    return VehicleState(initial_car(start, fault == VehicleFault.NONE, params), ultrasonic, fault)


def advance(state: VehicleState, inputs: VehicleInput, params: VehicleParams, dt_ns: int) -> VehicleState:
    """Return the vehicle ``dt_ns`` later, its inputs held."""
    fault = state.fault
    if fault == VehicleFault.NONE and not _is_finite_input(inputs):
        fault = VehicleFault.BAD_INPUT
    car = state.car
    ultrasonic = state.ultrasonic
    if fault != VehicleFault.BAD_PARAMETER and dt_ns > 0:
        count = _internal_steps(dt_ns, params)
        start_ns = car.time_ns
        for number in range(1, count + 1):
            car = step_car(car, inputs, fault != VehicleFault.NONE, params, start_ns + dt_ns * number // count)
        if is_due(start_ns, car.time_ns, params.car.ultrasonic.cycle):
            ultrasonic = measure(
                ultrasonic, car.pose, params.scene, params.car.ultrasonic, params.ultrasonic, car.time_ns
            )
    state = VehicleState(car, ultrasonic, fault)
    return state


def _clearance(pose: Pose, params: VehicleParams, time_ns: int) -> float:
    return clearance(pose, params.car, params.scene, params.ultrasonic.kerb_height, time_ns, NO_HIT)


def _internal_steps(dt_ns: int, params: VehicleParams) -> int:
    longest = params.largest_step if params.body == Body.KINEMATIC else min(params.largest_step, params.body_step)
    return math.ceil(dt_ns * 1e-9 / longest - 1e-9)


def outputs(state: VehicleState, gap: float, confirms: bool, params: VehicleParams) -> VehicleOutput:
    """Return what the vehicle tells: ``gap`` is its clearance [m], ``confirms``: a person presses the button."""
    car = state.car
    speed = car.speed
    measured = car.speed if params.odometry.ideal else car.rolled_speed
    if params.body != Body.KINEMATIC:
        speed = speed_for_display(speed)
        measured = speed_for_display(measured)
    front = 0.0
    if state.fault != VehicleFault.BAD_PARAMETER:
        front = car.steering.play / params.car.steering.ratio
    return VehicleOutput(
        pose=car.pose,
        odometry=car.odometry.pose,
        speed=speed,
        measured_speed=wheel_speed_reading(measured, params.odometry),
        steering_wheel_angle=car.steering_wheel_angle,
        front_wheel_angle=front,
        gear=car.selector.gear,
        brake_pedal=car.brake_pedal,
        driver_takeover=car.driver.takeover,
        vehicle_fault=state.fault,
        distance=car.distance,
        ultrasonic=state.ultrasonic.readings,
        clearance=gap,
        contact=gap <= 0.0,
        apa_switch=switch_is_on(car.time_ns, params.driver),
        driver_confirm=confirms or presses_confirm(car.driver, car.time_ns, params.driver),
    )


def _is_finite_input(inputs: VehicleInput) -> bool:
    asked = inputs.steering_wheel_request + inputs.advised_speed + inputs.speed_request + inputs.force_request
    return is_finite(asked + inputs.manual.accelerator + inputs.manual.brake)
