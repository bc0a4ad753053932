"""The car with one wheel per axle and three degrees of freedom: along, across, yaw.

    F_yf = -C_f s_f    F_yr = -C_r s_r    C = stiffness at rest load * F_z / F_z at rest
    F_zf = m (g b - a_x h) / L            F_zr = m (g a + a_x h) / L

One parametrised model, two well-known instances:

- full (``small_angles`` false): slip s = V_y / |V_x| in the wheel's own frame, forces turned by
  the steering angle; with h = 0 the 3-DOF model of the preview paper (section 2, Table 3:
  linear tyres, rolling resistance, air drag along and across).
- ``small_angles`` true: s_f = beta + a r / |v| - sign(v) delta, s_r = beta - b r / |v|, forces
  across the car: CommonRoad's ST with C_f = mu C_Sf m g b / L. ST holds for v > 0; here the
  sign of v makes it hold in reverse, where ST diverges.

In a step slip follows over a relaxation length (see tires.relax), so that v = 0 is no special
case; rolling resistance and brake act through a stiff spring that slips, so that they hold a
car at rest and let go without a jump. Forces are limited by friction.
"""

import math
from typing import Annotated, NamedTuple

from modelkit.maths import clamp
from modelkit.signal import Signal
from vehicle_fmu.bodies.chassis import (
    CHOSEN,
    GRAVITY_ACCELERATION,
    Build,
    ChassisParams,
    Motion,
    Stance,
    Wrench,
    accelerations,
    gravity_in_car,
    move_body,
)
from vehicle_fmu.bodies.tires import relax, slide_rate
from vehicle_fmu.effort import Effort

HOLD_RATE = 40.0
"""A held car rocks at this rate [rad/s] on its brakes and tyres (6 mm under 1 g)."""
LOOK_AHEAD = 0.01
"""Time [s] by which forces look ahead on their springs, which damps them."""


class SingleTrackParams(NamedTuple):
    """Axle stiffness, friction and form of the equations."""

    stiffness_front: Annotated[
        float, Signal("N/rad", "cornering stiffness of the front axle at rest load", 1.0, 1e7, CHOSEN)
    ] = 65000.0
    stiffness_rear: Annotated[
        float, Signal("N/rad", "cornering stiffness of the rear axle at rest load", 1.0, 1e7, CHOSEN)
    ] = 65000.0
    load_height: Annotated[float, Signal("m", "height h of the load transfer by a_x; 0: none", 0.0, 3.0, CHOSEN)] = 0.0
    friction: Annotated[float, Signal("1", "largest force over load, both axles", 0.01, 3.0, CHOSEN)] = 1.0
    relaxation: Annotated[float, Signal("m", "relaxation length", 0.01, 5.0, CHOSEN)] = 0.3
    small_angles: Annotated[bool, Signal("1", "linearised in steering and slip angle, as CommonRoad's ST")] = False


class AxleForces(NamedTuple):
    """Forces of the road on the car [N], each in its wheel's direction."""

    front: float = 0.0
    """Lateral, front axle."""
    rear: float = 0.0
    """Lateral, rear axle."""
    along: float = 0.0
    """Drive less brake and rolling resistance, all wheels."""


class SingleTrackState(NamedTuple):
    """Motion and what the springs of tyres and brake remember."""

    motion: Motion = Motion()
    front: float = 0.0
    """Carcass deflection [m] of the front axle to the left; its force has the same sign."""
    rear: float = 0.0
    hold: float = 0.0
    """Deflection [m] of brake and rolling resistance; its force has the opposite sign."""
    forces: AxleForces = AxleForces()
    """Of the last step."""


class Slip(NamedTuple):
    """Sliding across and rolling speed of an axle's wheel [m/s]."""

    across: float
    along: float


class Axles(NamedTuple):
    """One number for each axle."""

    front: float
    rear: float


def axle_loads(accel: float, normal: float, stance: Stance, p: SingleTrackParams, chassis: ChassisParams) -> Axles:
    """Return the axle loads [N] at longitudinal acceleration ``accel`` [m/s2], never below zero."""
    weight = chassis.mass * normal
    rest = weight * stance.cg_to_rear / stance.wheelbase
    front = clamp(rest - chassis.mass * accel * p.load_height / stance.wheelbase, 0.0, weight)
    return Axles(front, weight - front)


def axle_stiffness(loads: Axles, stance: Stance, p: SingleTrackParams, chassis: ChassisParams) -> Axles:
    """Return the cornering stiffness [N/rad] under ``loads``: proportional to load."""
    rest_front = chassis.mass * GRAVITY_ACCELERATION * stance.cg_to_rear / stance.wheelbase
    rest_rear = chassis.mass * GRAVITY_ACCELERATION - rest_front
    return Axles(p.stiffness_front * loads.front / rest_front, p.stiffness_rear * loads.rear / rest_rear)


def front_slip(motion: Motion, angle: float, wheelbase: float, b: float, small: bool) -> Slip:
    """Return the front wheel's sliding and rolling speed [m/s] at steering ``angle`` [rad]."""
    across = motion.speed_y + (wheelbase - b) * motion.yaw_rate
    if small:
        return Slip(across - motion.speed_x * angle, abs(motion.speed_x))
    cos = math.cos(angle)
    sin = math.sin(angle)
    return Slip(across * cos - motion.speed_x * sin, abs(motion.speed_x * cos + across * sin))


def rear_slip(motion: Motion, b: float) -> Slip:
    """Return the rear wheel's sliding and rolling speed [m/s]."""
    return Slip(motion.speed_y - b * motion.yaw_rate, abs(motion.speed_x))


def wrench(forces: AxleForces, angle: float, stance: Stance, small: bool) -> Wrench:
    """Return force and moment on the car [N, N m] of the axles' lateral and the wheels' rolling force."""
    front, rear, along = forces
    b = stance.cg_to_rear
    a = stance.wheelbase - b
    if small:
        return Wrench(along, front + rear, a * front - b * rear)
    cos = math.cos(angle)
    return Wrench(along - front * math.sin(angle), front * cos + rear, a * front * cos - b * rear)


def step_single_track(
    state: SingleTrackState,
    angle: float,
    effort: Effort,
    build: Build,
    p: SingleTrackParams,
    h: float,
) -> SingleTrackState:
    """Return the car ``h`` [s] later at front-wheel ``angle`` [rad] under ``effort``."""
    motion = state.motion
    stance, chassis, road = build
    wheelbase, b = stance
    gravity = gravity_in_car(motion.pose, road)
    accel = state.forces.along / chassis.mass
    loads = axle_loads(accel, gravity.normal, stance, p, chassis)
    stiffness = axle_stiffness(loads, stance, p, chassis)
    grip = Axles(
        p.friction * loads.front * 0.5 * (road.grip[0] + road.grip[1]),
        p.friction * loads.rear * 0.5 * (road.grip[2] + road.grip[3]),
    )
    front, front_force = _push(
        state.front,
        front_slip(motion, angle, wheelbase, b, p.small_angles),
        stiffness.front,
        grip.front,
        p.stiffness_front / p.relaxation,
        h,
    )
    rear, rear_force = _push(
        state.rear, rear_slip(motion, b), stiffness.rear, grip.rear, p.stiffness_rear / p.relaxation, h
    )
    hold, along = _along(state.hold, motion.speed_x, _limit_by_grip(effort, grip, chassis), loads, chassis, h)
    forces = AxleForces(front_force, rear_force, along)
    change = accelerations(motion, wrench(forces, angle, stance, p.small_angles), gravity, chassis)
    return SingleTrackState(move_body(motion, change, b, h), front, rear, hold, forces)


def _push(
    deflection: float, slip: Slip, stiffness: float, grip: float, carcass: float, h: float
) -> tuple[float, float]:
    """Return the axle's next deflection [m] and its lateral force [N]."""
    speed = max(0.1 * abs(slip.across), slip.along)
    secant = stiffness
    if stiffness * abs(slip.across) > grip * speed:
        secant = grip * speed / abs(slip.across)
    rate = slide_rate(carcass, speed, secant)
    now = relax(deflection, -slip.across, rate, h)
    return now, carcass * relax(deflection, -slip.across, rate, h + LOOK_AHEAD)


def _limit_by_grip(effort: Effort, grip: Axles, chassis: ChassisParams) -> Effort:
    """Return what of the effort the road takes [N]."""
    share = chassis.front_drive_share
    drive = clamp(effort.drive * share, -grip.front, grip.front)
    drive = drive + clamp(effort.drive * (1.0 - share), -grip.rear, grip.rear)
    share = chassis.front_brake_share
    brake = clamp(effort.brake * share, 0.0, grip.front) + clamp(effort.brake * (1.0 - share), 0.0, grip.rear)
    return Effort(drive, brake)


def _along(
    hold: float, speed: float, effort: Effort, loads: Axles, chassis: ChassisParams, h: float
) -> tuple[float, float]:
    """Return the brake's next deflection [m] and the rolling force of all wheels [N] under an effort gripped."""
    level = effort.brake + chassis.rolling_resistance * (loads.front + loads.rear)
    spring = chassis.mass * HOLD_RATE * HOLD_RATE
    limit = level / spring
    now = clamp(hold + h * speed, -limit, limit)
    ahead = clamp(hold + (h + LOOK_AHEAD) * speed, -limit, limit)
    return now, effort.drive - spring * ahead
