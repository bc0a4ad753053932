"""Gear selector, and pedals that follow a speed: force requests to drive and brake for the bodies with mass.

    reference' within the acceleration limits (see drive)
    force = m (reference' + k_p (reference - speed)) + k_i m * integral of the error

A force along the gear's direction goes to the drive, against it to the brake; both lag. The
integral waits while the force is beyond what the drive has (no windup). At a
reference of zero the brake holds the car. In D and R the car creeps: a force that fades out at
the creep speed. The traction limit is the tyres' own.
"""

from typing import NamedTuple

from modelkit.maths import clamp
from modelkit.vocabulary import Gear
from vehicle_fmu.drive import change_speed
from vehicle_fmu.effort import Effort
from vehicle_fmu.interface import DriveParams

SELECTOR_SPEED = 0.02
"""Speed [m/s] below which the selector may be moved."""
NO_GEAR = -1
LAST_DECELERATION = 0.5
"""Deceleration [m/s2] with which a car comes to rest, so that it rocks little on its tyres."""
BRAKE_GROWTH = 4.0
"""Growth [m/s3] of that if it does not come to rest, as on a slope."""


class Selector(NamedTuple):
    """Gear engaged, and the one being engaged."""

    gear: int = Gear.PARK
    wanted: int = NO_GEAR
    left_ns: int = 0
    """Time [ns] until ``wanted`` is engaged."""


class Pedals(NamedTuple):
    """What the feet remember."""

    reference: float = 0.0
    """Speed [m/s] the pedals aim at."""
    integral: float = 0.0
    """Integral of the speed error [m]."""
    effort: Effort = Effort()
    stopping: float = 0.0
    """Time [s] since the aim became to stand."""
    error: float = 0.0
    """Speed error [m/s] before the last step."""


class Rolling(NamedTuple):
    """How the car rolls: what a gearbox makes its creep of."""

    speed: float
    """[m/s]"""
    gear: int
    """Engaged."""


def target_gear(gear: int, target: float) -> int:
    """Return the gear for going at ``target`` [m/s]; to stand, the one engaged will do."""
    return Gear.REVERSE if target < 0.0 else Gear.DRIVE if target > 0.0 else gear


def shift(selector: Selector, wanted: int, speed: float, shift_time: float, step_ns: int) -> Selector:
    """Return the selector ``step_ns`` later when the gear ``wanted`` is requested at ``speed`` [m/s].

    With a shift time the car must stand, and N is engaged meanwhile; without, the gear follows at once.
    """
    gear = selector.gear
    if shift_time <= 0.0:
        return Selector(wanted)
    if selector.wanted != NO_GEAR:
        left = selector.left_ns - step_ns
        return Selector(selector.wanted) if left <= 0 else Selector(Gear.NEUTRAL, selector.wanted, left)
    if wanted == gear or abs(speed) >= SELECTOR_SPEED:
        return Selector(gear)
    return Selector(Gear.NEUTRAL, wanted, int(shift_time * 1e9))


def attainable_speed(selector: Selector, target: float) -> float:
    """Return the speed [m/s] to aim at with the gear engaged: ``target`` if it fits, else 0."""
    if (target > 0.0 and selector.gear == Gear.DRIVE) or (target < 0.0 and selector.gear == Gear.REVERSE):
        return target
    return 0.0


def along(gear: int) -> float:
    """Return the direction of the gear: -1 in reverse, else 1."""
    return -1.0 if gear == Gear.REVERSE else 1.0


def press(pedals: Pedals, target: float, car: Rolling, mass: float, p: DriveParams, h: float) -> Pedals:
    """Return the pedals ``h`` [s] later, on the way to ``target`` [m/s].

    The speed error is that of the middle of the step, extrapolated from the last two.
    """
    reference = change_speed(pedals.reference, target, p, h)
    idle = creep(car, p)
    if reference == 0.0 and target == 0.0:
        brake = mass * _stopping_deceleration(car.speed, pedals.stopping, p)
        return Pedals(effort=lag(pedals.effort, idle, brake, p, h), stopping=pedals.stopping + h)
    error = pedals.reference - car.speed
    midway = error + 0.5 * (error - pedals.error)
    push = (reference - pedals.reference) / h + p.speed_gain * midway + p.speed_integral * pedals.integral
    force = mass * push - idle
    integral = pedals.integral
    if abs(force) < p.drive_force_limit:
        integral = clamp(integral + h * midway, -p.integral_limit, p.integral_limit)
    ahead = 1.0 if reference > 0.0 else -1.0
    return Pedals(reference, integral, _split(pedals.effort, force, idle, ahead, p, h), error=error)


def obey(pedals: Pedals, force: float, car: Rolling, p: DriveParams, h: float) -> Pedals:
    """Return the pedals ``h`` [s] later under a force request [N], forward positive.

    Along the gear's direction it goes to the drive, against it to the brake. The aim follows the car's speed,
    so that a speed request takes over without a jump.
    """
    return Pedals(car.speed, effort=_split(pedals.effort, force, creep(car, p), along(car.gear), p, h))


def _split(effort: Effort, force: float, idle: float, ahead: float, p: DriveParams, h: float) -> Effort:
    """Return the effort ``h`` [s] later: along ``ahead`` (1 or -1) a force drives, against it it brakes."""
    if force * ahead >= 0.0:
        return lag(effort, force + idle, 0.0, p, h)
    return lag(effort, idle, abs(force), p, h)


def _stopping_deceleration(speed: float, time: float, p: DriveParams) -> float:
    """Return how hard to brake [m/s2] at the end of a stop: gently while it still rolls, then to hold."""
    if abs(speed) < SELECTOR_SPEED:
        return p.hold_deceleration
    gentle = LAST_DECELERATION + BRAKE_GROWTH * time + p.speed_gain * abs(speed)
    return min(p.hold_deceleration, gentle)


def creep(car: Rolling, p: DriveParams) -> float:
    """Return the force [N] with which an automatic gearbox pushes at idle."""
    if car.gear == Gear.DRIVE:
        return p.creep_force * clamp(1.0 - car.speed / p.creep_speed, 0.0, 1.0)
    if car.gear == Gear.REVERSE:
        return -p.creep_force * clamp(1.0 + car.speed / p.creep_speed, 0.0, 1.0)
    return 0.0


def lag(effort: Effort, drive: float, brake: float, p: DriveParams, h: float) -> Effort:
    """Return the forces [N] ``h`` [s] later on their way to those asked for, within what there is.

    Trapezoidal rule; a lag below half the step counts as that.
    """
    wanted = clamp(drive, -p.drive_force_limit, p.drive_force_limit)
    pressed = clamp(brake, 0.0, p.brake_force_limit)
    half = 0.5 * h
    return Effort(
        effort.drive + (wanted - effort.drive) * h / (max(p.drive_lag, half) + half),
        effort.brake + (pressed - effort.brake) * h / (max(p.brake_lag, half) + half),
    )
