"""The fault monitor: each quantity that must not last has a clock [ns]; a clock that runs out is a reason to fail."""

from typing import NamedTuple

from controller_fmu.common.monitor import MonitorState, is_usable_input, reason_to_fail
from controller_fmu.common.phases import PhaseExpectation
from controller_fmu.interface import Monitored, Reason, SensedWithFault
from controller_fmu.parking.measurement.cycle import seconds
from controller_fmu.parking.signals import ParkingSystemInput
from modelkit.vocabulary import Gear

SETTLING_TIME = 0.3
"""The driver's foot leaves the pedal within this time [s] after the system took over."""
MAX_PEDAL = 0.2
"""A foot that rests on the brake pedal presses it by less than this."""
MAX_SHIFT_SPEED = 0.2
"""The gearbox itself passes neutral at a lower speed [m/s]."""
PULL_ANGLE = 0.3
PULL_TIME = 0.2
"""A driver turns the wheel away from a request that is off by more than this [rad], for longer than this [s]."""


class FaultClocks(NamedTuple):
    """Clocks [ns]: those that every system has, with the steering monitor, and those of this one."""

    common: MonitorState = MonitorState()
    blocked: int = 0
    fast: int = 0
    running: int = 0


def advance_clocks(
    clocks: FaultClocks, common: MonitorState, stands: bool, is_blocked: bool, is_fast: bool, dt_ns: int
) -> FaultClocks:
    """Return the clocks after a sample of ``dt_ns``, the ``common`` ones as ``watch`` advanced them.

    A vehicle that the collision monitor keeps standing (``is_blocked``) is not waited for.
    """
    return FaultClocks(
        common._replace(waiting=0) if is_blocked else common,
        clocks.blocked + (dt_ns if is_blocked else 0) if stands else 0,
        clocks.fast + dt_ns if is_fast else 0,
        clocks.running + dt_ns,
    )


def is_taken_over(clocks: FaultClocks, inputs: ParkingSystemInput, driver_drives: bool) -> bool:
    """Return whether the driver has taken over: by signal, gear selector, steering wheel, or brake pedal.

    Where the driver controls the speed as prompted, the pedal is none.
    """
    is_settled = seconds(clocks.running) > SETTLING_TIME
    is_braked = inputs.brake_pedal > MAX_PEDAL and not driver_drives
    is_out_of_gear = inputs.gear in (Gear.PARK, Gear.NEUTRAL) and abs(inputs.measured_speed) > MAX_SHIFT_SPEED
    wheel = clocks.common.wheel
    is_pulled = abs(wheel.request - wheel.angle) > PULL_ANGLE and seconds(wheel.away_ns) > PULL_TIME
    return inputs.driver_takeover or (is_settled and (is_braked or is_out_of_gear)) or is_pulled


def input_fault(inputs: SensedWithFault) -> int:
    """Return the Reason for which nothing can go on, ``NONE`` if there is none."""
    if not is_usable_input(inputs):
        return Reason.BAD_INPUT
    return Reason.VEHICLE_FAULT if inputs.vehicle_fault != 0 else Reason.NONE


def fault_reason(
    clocks: FaultClocks,
    inputs: SensedWithFault,
    phase: PhaseExpectation,
    manoeuvres: int,
    over_speed_time: float,
    params: Monitored,
) -> int:
    """Return the first Reason that holds, ``NONE`` if all is as it should be; ``over_speed_time`` [s] is a limit."""
    fault = input_fault(inputs)
    if fault != Reason.NONE:
        return fault
    if seconds(clocks.fast) > over_speed_time:
        return Reason.OVER_SPEED
    phase = phase._replace(begun=True)
    return reason_to_fail(clocks.common, inputs, phase, clocks.running, manoeuvres, params)
