"""Watches car, wheel and way at every sample; a reason to give up comes from clocks [ns]."""

from typing import NamedTuple

from controller_fmu.common.monitor import Command, clock_before, is_unmoved, is_usable_input
from controller_fmu.common.steering_monitor import SteeringMonitorState, at_rest, has_failed, watch_steering
from controller_fmu.interface import Reason
from controller_fmu.valet.chart import Step
from controller_fmu.valet.params import ValetParams
from controller_fmu.valet.signals import ValetInput
from modelkit.vocabulary import Pose


class Watch(NamedTuple):
    """Clocks [ns], the watch over the wheel, and where the car was."""

    waiting: int = 0
    """The car is asked to move or to turn its wheel, and stands."""
    stopping: int = 0
    frozen: int = 0
    blocked: int = 0
    """Something unknown is in the way of a standing car."""
    running: int = 0
    wheel: SteeringMonitorState = SteeringMonitorState()
    pose: Pose = Pose()


def watch(state: Watch, command: Command, inputs: ValetInput, params: ValetParams, dt_ns: int) -> Watch:
    """Return the clocks after one sample of ``dt_ns``."""
    speed = inputs.measured_speed
    still = abs(speed) <= params.threshold.standstill
    angle = inputs.steering_wheel_angle
    wheel = at_rest(angle, state.wheel.steering)
    if command.step != Step.PLAN:
        rate = params.car.steering.rate_limit
        wheel = watch_steering(state.wheel, command.wheel, angle, params.limit.steering_tracking_error, rate, dt_ns)
    moves = command.step in (Step.SET_WHEEL, Step.DRIVE, Step.STRAIGHTEN)
    return Watch(
        waiting=state.waiting + dt_ns if still and moves and not command.blocked else 0,
        stopping=state.stopping + dt_ns if not still and not moves else 0,
        frozen=state.frozen + dt_ns if is_unmoved(inputs.odometry, state.pose, speed, dt_ns) else 0,
        blocked=clock_before(command.blocked, state.blocked, still, dt_ns),
        running=state.running + dt_ns,
        wheel=wheel,
        pose=inputs.odometry,
    )


def fault_of(inputs: ValetInput) -> int:
    """Return the Reason for which not even a search goes on, ``NONE`` if there is none."""
    if not is_usable_input(inputs):
        return Reason.BAD_INPUT
    return Reason.VEHICLE_FAULT if inputs.vehicle_fault != 0 else Reason.NONE


def reason_to_fail(state: Watch, inputs: ValetInput, step: int, manoeuvres: int, params: ValetParams) -> int:
    """Return the first Reason that holds, ``NONE`` if all is as it should be."""
    limit = params.limit
    fault = fault_of(inputs)
    if fault != Reason.NONE:
        return fault
    if state.frozen * 1e-9 > limit.pose_frozen:
        return Reason.POSE_FROZEN
    if has_failed(state.wheel, limit.steering_fault_debounce):
        return Reason.STEERING_FAULT
    if state.stopping * 1e-9 > limit.stopping:
        return Reason.NOT_STOPPING
    if state.waiting * 1e-9 > limit.driver_response_timeout:
        return Reason.STEERING_FAULT if step != Step.DRIVE else Reason.NOT_MOVING
    if manoeuvres > limit.manoeuvres:
        return Reason.TOO_MANY_SHIFTS
    return Reason.TIMEOUT if state.running * 1e-9 > limit.duration else Reason.NONE
