"""One wheel: spin, carcass springs, drive and brake torque.

    I omega' = T_drive - R F_x - friction,  friction <= T_brake + f_r R F_z, sticking at rest
    u' = (R omega - V_x) - V u / sigma_x    w' = -V_y - V w / sigma_y    V = max(|V_x|, |R omega|)

The force is taken at the deflection a look-ahead time further on, which damps the carcass at low
speed and changes nothing in steady rolling. Spin and force are solved together, linearised about
the old spin (secant stiffness), so that one step of any length is stable from standstill up.
"""

from typing import Annotated, NamedTuple

from modelkit.maths import move_towards
from modelkit.signal import Signal
from vehicle_fmu.tires import Force, TireParams, relax, tire_force

COMMONROAD = "CommonRoad vehicle models 3.0.2"


class HubParams(NamedTuple):
    """Size and inertia of a wheel."""

    radius: Annotated[float, Signal("m", "rolling radius", 0.05, 2.0, COMMONROAD + ", R_w")] = 0.344
    inertia: Annotated[float, Signal("kg.m2", "about its axle", 0.01, 100.0, COMMONROAD + ", I_y_w")] = 1.7


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
    """Return the wheel ``h`` [s] later and its mean force [N] on the car over the step."""
    rim = hub.radius * wheel.spin
    speed = _larger(abs(contact.along), abs(rim))
    ahead = h + tires.damping
    length = tires.relaxation_x
    u = relax(wheel.u, rim - contact.along, speed, length, ahead)
    w = relax(wheel.w, -contact.across, speed, tires.relaxation_y, ahead)
    force = tire_force(u / length, w / tires.relaxation_y, contact.load, contact.camber, contact.grip, tires)
    stiffness = force.x / u if abs(u) > 1e-9 else _spring(contact, tires)
    slope = stiffness * hub.radius * ahead / (1.0 + ahead * speed / length)
    inertia = hub.inertia + h * hub.radius * slope
    free = wheel.spin + h * (contact.drive - hub.radius * force.x) / inertia
    spin = move_towards(free, 0.0, h * contact.brake / inertia)
    return Wheel(
        spin,
        relax(wheel.u, hub.radius * spin - contact.along, speed, length, h),
        relax(wheel.w, -contact.across, speed, tires.relaxation_y, h),
        Force(force.x + slope * (spin - wheel.spin), force.y),
    )


def _spring(contact: Contact, tires: TireParams) -> float:
    if contact.load <= 0.0 or contact.grip <= 0.0:
        return 0.0
    return tires.stiffness_x * contact.load / tires.relaxation_x


def _larger(a: float, b: float) -> float:
    return a if a > b else b
