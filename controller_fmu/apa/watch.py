"""Watches driver, car and sensors at every sample; a reason to fail or a takeover comes from clocks [ns]."""

from typing import NamedTuple

from controller_fmu.apa.hearing.mute import count_mute
from controller_fmu.apa.manoeuvre_chart import Step
from controller_fmu.apa.params import ApaSystemParams
from controller_fmu.apa.signals import ApaInput
from controller_fmu.common.driver_selection import ChosenTask
from controller_fmu.common.monitor import Command, clock_before, is_unmoved
from controller_fmu.common.params import Longitudinal
from controller_fmu.common.steering_monitor import SteeringMonitorState, at_rest, has_failed, watch_steering
from controller_fmu.interface import Reason
from modelkit.maths import is_finite
from modelkit.vocabulary import Gear, Pose

STANDING = 0.01
PULLED = 0.3
"""The wheel is this far [rad] from its request and goes the other way: the driver turns it."""
PULLED_FOR = 0.2
"""For so long [s]."""
WAIT_OUT = 30.0
"""On the way out a car waits so long [s] at least before an obstacle: who stands beside a parked car goes again."""
SETTLING = 0.3
"""The driver's pedal and selector are looked at this long [s] after the assist took over."""


class Watch(NamedTuple):
    """Clocks [ns] and what was last."""

    waiting: int = 0
    stopping: int = 0
    blocked: int = 0
    fast: int = 0
    blind: int = 0
    """Since more sensors than can be spared tell nothing,"""
    mute: int = 0
    """and since any does."""
    frozen: int = 0
    running: int = 0
    """Since the driver confirmed."""
    wheel: SteeringMonitorState = SteeringMonitorState()
    pose: Pose = Pose()


class Duty(NamedTuple):
    """What the assist is about, and what it needs for that."""

    driving: bool
    """It has been given the car."""
    spared: int
    """So many sensors can be gone without."""


def watch(state: Watch, command: Command, inputs: ApaInput, duty: Duty, params: ApaSystemParams, dt_ns: int) -> Watch:
    """Return the clocks after one sample."""
    driving = duty.driving
    speed = inputs.measured_speed
    still = abs(speed) <= STANDING
    angle = inputs.steering_wheel_angle
    rate = params.car.steering.rate_limit
    wheel = at_rest(angle, state.wheel.steering)
    mute = count_mute(inputs.ultrasonic)
    if driving:
        wheel = watch_steering(state.wheel, command.wheel, angle, params.limit.steering_tracking_error, rate, dt_ns)
    moving_expected = command.step in (Step.SET_WHEEL, Step.DRIVE, Step.STRAIGHTEN)
    own = params.apa.drive.longitudinal == Longitudinal.OWN_SPEED
    limit = params.apa.guard.over_speed if not own else 1.5 * params.apa.drive.speed
    return Watch(
        waiting=state.waiting + dt_ns if still and moving_expected and not command.blocked else 0,
        stopping=state.stopping + dt_ns if not still and command.step == Step.HALT else 0,
        blocked=clock_before(command.blocked and driving, state.blocked, still, dt_ns),
        fast=state.fast + dt_ns if abs(speed) > limit and driving else 0,
        blind=state.blind + dt_ns if mute > duty.spared else 0,
        mute=state.mute + dt_ns if mute > 0 else 0,
        frozen=state.frozen + dt_ns if is_unmoved(inputs.odometry, state.pose, speed, dt_ns) else 0,
        running=state.running + dt_ns if driving else state.running,
        wheel=wheel,
        pose=inputs.odometry,
    )


def is_taken_over(state: Watch, inputs: ApaInput, params: ApaSystemParams) -> bool:
    """Return whether the driver has taken the car back: by signal, brake, selector or steering wheel."""
    own = params.apa.drive.longitudinal == Longitudinal.OWN_SPEED
    settled = state.running * 1e-9 > SETTLING
    pedal = own and settled and inputs.brake_pedal > params.apa.guard.pedal
    out_of_gear = inputs.gear in (Gear.PARK, Gear.NEUTRAL) and abs(inputs.measured_speed) > 0.2
    wheel = _is_off(state.wheel) and state.wheel.away_ns * 1e-9 > PULLED_FOR
    return inputs.driver_takeover or pedal or (settled and out_of_gear) or wheel


def _is_off(wheel: SteeringMonitorState) -> bool:
    return abs(wheel.request - wheel.angle) > PULLED


def reason_to_fail(
    state: Watch, inputs: ApaInput, driving: bool, params: ApaSystemParams, task: int = ChosenTask.PARK
) -> int:
    """Return the first Reason that holds, ``NONE`` if all is as it should be; ``task``: what the car does."""
    guard = params.apa.guard
    if not is_finite_input(inputs):
        return Reason.BAD_INPUT
    if inputs.vehicle_fault != 0:
        return Reason.VEHICLE_FAULT
    if state.blind * 1e-9 > params.apa.sensors.blind_time:
        return Reason.SENSOR_LOSS
    if state.frozen * 1e-9 > params.limit.pose_frozen:
        return Reason.POSE_FROZEN
    if not driving:
        return Reason.NONE
    if state.fast * 1e-9 > guard.over_speed_time:
        return Reason.OVER_SPEED
    if has_failed(state.wheel, params.limit.steering_fault_debounce):
        return Reason.STEERING_FAULT
    if state.stopping * 1e-9 > params.limit.stopping:
        return Reason.NOT_STOPPING
    if state.blocked * 1e-9 > (max(guard.blocked, WAIT_OUT) if task == ChosenTask.PULL_OUT else guard.blocked):
        return Reason.BLOCKED
    if state.waiting * 1e-9 > guard.driver_response_timeout:
        return Reason.STEERING_FAULT if _is_off(state.wheel) else Reason.NOT_MOVING
    if state.running * 1e-9 > guard.duration:
        return Reason.TIMEOUT
    return Reason.NONE


def is_finite_input(inputs: ApaInput) -> bool:
    """Return False if a number that the assist steers by is NaN or infinite (sensors: see SENSOR_LOSS)."""
    pose = inputs.odometry
    return (
        is_finite(pose.x)
        and is_finite(pose.y)
        and is_finite(pose.heading)
        and is_finite(inputs.measured_speed)
        and is_finite(inputs.steering_wheel_angle)
        and is_finite(inputs.brake_pedal)
    )
