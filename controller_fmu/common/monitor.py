"""Watches the car and the driver at every sample; each reason to fail has a limit in time.

A quantity that must not last has a clock [ns] that runs while it holds and is put back to zero
when it does not. The steering has a monitor of its own, ``controller_fmu.common.steering_monitor``.
"""

import math
from typing import NamedTuple

from controller_fmu.common.phases import PhaseExpectation
from controller_fmu.common.steering_monitor import SteeringMonitorState, at_rest, has_failed, watch_steering
from controller_fmu.interface import Monitored, Reason, Sensed, SensedWithFault
from modelkit.maths import sign
from modelkit.vocabulary import Pose

MAX_PLAUSIBLE_VALUE = 1e9
"""No position [m], heading [rad] or speed [m/s] is beyond this; NaN is not within it either."""
SLOWEST_SEEN = 0.1
"""A pose counted in ticks may rightly stand still for half a second at less than this [m/s]."""


SLOW_DRIVING_SPEED = 0.3
"""A car slower than this [m/s] is given more time."""


class MonitorState(NamedTuple):
    """Clocks [ns], the watch over the wheel, and where the car was."""

    waiting: int = 0
    stopping: int = 0
    wrong_direction_ns: int = 0
    frozen: int = 0
    wheel: SteeringMonitorState = SteeringMonitorState()
    pose: Pose = Pose()
    """Pose at the last sample."""


def watch(
    state: MonitorState,
    inputs: Sensed,
    expected: PhaseExpectation,
    request: float,
    dt_ns: int,
    params: Monitored,
) -> MonitorState:
    """Return the clocks after one sample of ``dt_ns`` in a phase with the wheel at ``request``."""
    speed = inputs.measured_speed
    still = abs(speed) <= params.threshold.standstill
    direction = expected.direction
    angle = inputs.steering_wheel_angle
    rate = params.car.steering.rate_limit
    wheel = at_rest(angle, state.wheel.steering)
    if expected.begun:
        wheel = watch_steering(state.wheel, request, angle, params.limit.steering_tracking_error, rate, dt_ns)
    return state._replace(
        waiting=state.waiting + dt_ns if still and (direction != 0 or expected.steering) else 0,
        stopping=state.stopping + dt_ns if not still and direction == 0 else 0,
        wrong_direction_ns=state.wrong_direction_ns + dt_ns if sign(speed) * direction < 0.0 and not still else 0,
        frozen=state.frozen + dt_ns if is_unmoved(inputs.odometry, state.pose, speed, dt_ns) else 0,
        wheel=wheel,
        pose=inputs.odometry,
    )


def time_counted(dt_ns: int, speed: float, standstill: float, begun: bool = True) -> int:
    """Return what of a sample counts against the longest duration [ns]: a car that creeps counts by distance.

    So a slow driver whose car moves has as far to go as one at ``SLOW_DRIVING_SPEED``. In standby (``begun`` false) no
    path leads to the slot: a car that creeps instead of standing is waited for no longer than one that stands.
    """
    if begun and standstill < abs(speed) < SLOW_DRIVING_SPEED:
        return math.floor(dt_ns * abs(speed) / SLOW_DRIVING_SPEED)
    return dt_ns


def is_unmoved(pose: Pose, before: Pose, speed: float, dt_ns: int) -> bool:
    """Return whether the pose has moved by less than a tenth of ``speed`` [m/s] times the sample."""
    dx = pose.x - before.x
    dy = pose.y - before.y
    distance = speed * (dt_ns * 1e-9)
    return dx * dx + dy * dy < 0.01 * distance * distance and abs(speed) > SLOWEST_SEEN


def reason_to_fail(
    state: MonitorState,
    inputs: SensedWithFault,
    expected: PhaseExpectation,
    running_ns: int,
    manoeuvres: int,
    params: Monitored,
) -> int:
    """Return the first Reason that holds, ``NONE`` if the car and the driver are as they should be."""
    limit = params.limit
    if inputs.vehicle_fault != 0:
        return Reason.VEHICLE_FAULT
    if not expected.begun:
        return Reason.TIMEOUT if running_ns * 1e-9 > limit.duration else Reason.NONE
    if state.frozen * 1e-9 > limit.pose_frozen:
        return Reason.POSE_FROZEN
    if has_failed(state.wheel, limit.steering_fault_debounce):
        return Reason.STEERING_FAULT
    if state.wrong_direction_ns * 1e-9 > limit.wrong_direction:
        return Reason.WRONG_DIRECTION
    if state.stopping * 1e-9 > limit.stopping:
        return Reason.NOT_STOPPING
    if state.waiting * 1e-9 > limit.driver_response_timeout:
        return Reason.STEERING_FAULT if expected.steering else Reason.NOT_MOVING
    if manoeuvres > limit.manoeuvres:
        return Reason.TOO_MANY_SHIFTS
    if running_ns * 1e-9 > limit.duration:
        return Reason.TIMEOUT
    return Reason.NONE


def is_usable_input(inputs: Sensed) -> bool:
    """Return False if a number that the controller steers by is NaN, infinite or beyond all sense."""
    pose = inputs.odometry
    return (
        abs(pose.x) < MAX_PLAUSIBLE_VALUE
        and abs(pose.y) < MAX_PLAUSIBLE_VALUE
        and abs(pose.heading) < MAX_PLAUSIBLE_VALUE
        and abs(inputs.measured_speed) < MAX_PLAUSIBLE_VALUE
        and abs(inputs.steering_wheel_angle) < MAX_PLAUSIBLE_VALUE
    )
