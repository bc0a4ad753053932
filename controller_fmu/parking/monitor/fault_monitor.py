"""The fault monitor: each quantity that must not last has a clock [ns]; a clock that runs out is a reason to fail."""

from typing import NamedTuple

from controller_fmu.common.monitor import is_unmoved, is_usable_input
from controller_fmu.common.params import LimitParams
from controller_fmu.common.steering_monitor import SteeringMonitorState, at_rest, has_failed, watch_steering
from controller_fmu.interface import Reason, SensedWithFault
from controller_fmu.parking.measurement.cycle import seconds
from controller_fmu.parking.signals import ParkingSystemInput
from modelkit.vocabulary import Gear, Pose

SETTLING_TIME = 0.3
"""The driver's foot leaves the pedal within this time [s] after the system took over."""
MAX_PEDAL = 0.2
"""A foot that rests on the brake pedal presses it by less than this."""
MAX_SHIFT_SPEED = 0.2
"""The gearbox itself passes neutral at a lower speed [m/s]."""
PULL_ANGLE = 0.3
PULL_TIME = 0.2
"""A driver turns the wheel away from a request that is off by more than this [rad], for longer than this [s]."""


class ExpectedMotion(NamedTuple):
    """What the system requested of the vehicle over the last sample."""

    steers: bool
    """It holds the steering wheel."""
    moves: bool
    """It turns the wheel or drives; else the vehicle is to come to a stop."""
    is_blocked: bool
    """The monitor keeps it standing."""
    steering_wheel_angle: float
    """[rad]"""
    max_speed: float
    """Largest speed [m/s]."""


class FaultClocks(NamedTuple):
    """Clocks [ns], the steering monitor, and the last odometry pose."""

    waiting: int = 0
    stopping: int = 0
    frozen: int = 0
    blocked: int = 0
    fast: int = 0
    running: int = 0
    steering: SteeringMonitorState = SteeringMonitorState()
    pose: Pose = Pose()


class FaultLimits(NamedTuple):
    """Limits of the clocks, the steering wheel's rate [rad/s], and the speed [m/s] of a standstill."""

    limit: LimitParams
    steering_rate: float
    standstill: float
    over_speed_time: float
    """[s]"""


def advance_clocks(
    clocks: FaultClocks, expectation: ExpectedMotion, inputs: SensedWithFault, limits: FaultLimits, dt_ns: int
) -> FaultClocks:
    """Return the clocks after a sample of ``dt_ns``."""
    speed = inputs.measured_speed
    still = abs(speed) <= limits.standstill
    angle = inputs.steering_wheel_angle
    steering = at_rest(angle, clocks.steering.steering)
    if expectation.steers:
        tolerance = limits.limit.steering_tracking_error
        requested = expectation.steering_wheel_angle
        steering = watch_steering(clocks.steering, requested, angle, tolerance, limits.steering_rate, dt_ns)
    waits = still and expectation.moves and not expectation.is_blocked
    return FaultClocks(
        waiting=clocks.waiting + dt_ns if waits else 0,
        stopping=clocks.stopping + dt_ns if not still and not expectation.moves else 0,
        frozen=clocks.frozen + dt_ns if is_unmoved(inputs.odometry, clocks.pose, speed, dt_ns) else 0,
        blocked=clocks.blocked + (dt_ns if expectation.is_blocked else 0) if still else 0,
        fast=clocks.fast + dt_ns if abs(speed) > expectation.max_speed else 0,
        running=clocks.running + dt_ns,
        steering=steering,
        pose=inputs.odometry,
    )


def is_taken_over(clocks: FaultClocks, inputs: ParkingSystemInput, driver_drives: bool) -> bool:
    """Return whether the driver has taken over: by signal, gear selector, steering wheel, or brake pedal.

    Where the driver controls the speed as prompted, the pedal is none.
    """
    is_settled = seconds(clocks.running) > SETTLING_TIME
    is_braked = inputs.brake_pedal > MAX_PEDAL and not driver_drives
    is_out_of_gear = inputs.gear in (Gear.PARK, Gear.NEUTRAL) and abs(inputs.measured_speed) > MAX_SHIFT_SPEED
    wheel = clocks.steering
    is_pulled = abs(wheel.request - wheel.angle) > PULL_ANGLE and seconds(wheel.away_ns) > PULL_TIME
    return inputs.driver_takeover or (is_settled and (is_braked or is_out_of_gear)) or is_pulled


def input_fault(inputs: SensedWithFault) -> int:
    """Return the Reason for which nothing can go on, ``NONE`` if there is none."""
    if not is_usable_input(inputs):
        return Reason.BAD_INPUT
    return Reason.VEHICLE_FAULT if inputs.vehicle_fault != 0 else Reason.NONE


def fault_reason(
    clocks: FaultClocks, inputs: SensedWithFault, drives: bool, manoeuvres: int, limits: FaultLimits
) -> int:
    """Return the first Reason that holds, ``NONE`` if all is as it should be."""
    fault = input_fault(inputs)
    if fault != Reason.NONE:
        return fault
    limit = limits.limit
    if seconds(clocks.frozen) > limit.pose_frozen:
        return Reason.POSE_FROZEN
    if seconds(clocks.fast) > limits.over_speed_time:
        return Reason.OVER_SPEED
    if has_failed(clocks.steering, limit.steering_fault_debounce):
        return Reason.STEERING_FAULT
    if seconds(clocks.stopping) > limit.stopping:
        return Reason.NOT_STOPPING
    if seconds(clocks.waiting) > limit.driver_response_timeout:
        return Reason.NOT_MOVING if drives else Reason.STEERING_FAULT
    if manoeuvres > limit.manoeuvres:
        return Reason.TOO_MANY_SHIFTS
    return Reason.TIMEOUT if seconds(clocks.running) > limit.duration else Reason.NONE
