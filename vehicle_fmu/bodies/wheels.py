"""One wheel: spin, carcass springs, drive and brake torque.

    I omega' = s T_drive - R F_x - friction,  friction <= T_brake + f_r R F_z, sticking at rest
    s = 2 - (R omega - V_x) / (slip V_x), from 0 to 1: traction control, V_x no less than 1 m/s
    u' = (R omega - V_x) - rate_x u    w' = -V_y - rate_y w        (see tires)

The force is taken at the deflection a damping time further on, which damps the carcass at low
speed and changes nothing in steady rolling. Spin and longitudinal force are solved together (the
force is linear in the new spin), so that a step of any length is stable from standstill up.
"""

from typing import Annotated, NamedTuple

from modelkit.maths import clamp, move_towards
from modelkit.signal import Signal
from vehicle_fmu.bodies.chassis import CHOSEN
from vehicle_fmu.bodies.tires import Force, TireParams, relax, secants, slide_rate

COMMONROAD = "CommonRoad vehicle models 3.0.2"
SLIP_REFERENCE_SPEED = 1.0
"""Slip is relative to this speed [m/s] below it."""


class HubParams(NamedTuple):
    """Size and inertia of a wheel."""

    radius: Annotated[float, Signal("m", "rolling radius", 0.05, 2.0, COMMONROAD + ", R_w")] = 0.344
    inertia: Annotated[
        float, Signal("kg.m2", "moment of inertia of the wheel about its axle", 0.01, 100.0, COMMONROAD + ", I_y_w")
    ] = 1.7
    traction: Annotated[
        float, Signal("1", "slip from which traction control takes the drive back; 100: none", 0.001, 100.0, CHOSEN)
    ] = 0.05


class Wheel(NamedTuple):
    """What a wheel remembers."""

    spin: float = 0.0
    """[rad/s], positive rolling forward."""
    u: float = 0.0
    """Carcass deflection along the wheel [m]; its force on the car has the same sign."""
    w: float = 0.0
    """Carcass deflection across the wheel [m], to the left; force of the same sign."""
    force: Force = Force(0.0, 0.0)


class Contact(NamedTuple):
    """What a wheel feels in one step."""

    along: float
    """Speed of its centre along its own heading [m/s]."""
    across: float
    """Speed of its centre to its own left [m/s]."""
    load: float
    camber: float
    grip: float
    drive: float
    """Drive torque [N m], positive forward."""
    brake: float
    """Largest torque of brake and rolling resistance [N m]."""


def turn_wheel(wheel: Wheel, contact: Contact, hub: HubParams, tires: TireParams, h: float) -> Wheel:
    """Return the wheel ``h`` [s] later and its force [N] on the car over the step."""
    rim = hub.radius * wheel.spin
    speed = max(abs(contact.along), abs(rim), 0.1 * abs(contact.across))
    slide_x = rim - contact.along
    slide_y = speed * tires.camber_slip * contact.camber - contact.across
    over = 1.0 / speed if speed > 1e-12 else 0.0
    secant = secants(slide_x * over, slide_y * over, contact.load, contact.camber, contact.grip, tires)
    rate_x = slide_rate(tires.carcass_x, speed, secant.x)
    rate_y = slide_rate(tires.carcass_y, speed, secant.y)
    ahead = h + tires.damping
    force = tires.carcass_x * relax(wheel.u, slide_x, rate_x, ahead)
    slope = tires.carcass_x * hub.radius * ahead / (1.0 + ahead * rate_x)
    inertia = hub.inertia + h * hub.radius * slope
    drive = contact.drive * _traction_share(slide_x if contact.drive > 0.0 else -slide_x, contact.along, hub)
    free = wheel.spin + h * (drive - hub.radius * force) / inertia
    spin = move_towards(free, 0.0, h * contact.brake / inertia)
    return Wheel(
        spin,
        relax(wheel.u, hub.radius * spin - contact.along, rate_x, h),
        relax(wheel.w, slide_y, rate_y, h),
        Force(force + slope * (spin - wheel.spin), tires.carcass_y * relax(wheel.w, slide_y, rate_y, ahead)),
    )


def _traction_share(slide: float, along: float, hub: HubParams) -> float:
    """Return the share of the drive that traction control lets through at this wheel spin [m/s]."""
    allowed = hub.traction * max(abs(along), SLIP_REFERENCE_SPEED)
    return clamp(2.0 - slide / allowed, 0.0, 1.0)
