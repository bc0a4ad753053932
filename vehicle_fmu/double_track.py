"""The car on four wheels: planar motion, four spins, load transfer, Magic Formula tyres.

State: pose of the rear axle, v_x, v_y at the centre of gravity, yaw rate; per wheel its spin
and two carcass deflections; the accelerations its springs have felt. Road slope and bank by
gravity in the road plane, friction per wheel. One step is semi-implicit: wheels by the old
motion, then the motion by their forces; stable at rest, in reverse and at speed.

Each wheel is computed by the same function, and sums go front pair plus rear pair, so that a
mirrored manoeuvre gives mirrored bits.
"""

import math
from typing import Annotated, NamedTuple

from modelkit.signal import Signal
from modelkit.vocabulary import Pose
from vehicle_fmu.chassis import (
    CHOSEN,
    ChassisParams,
    Motion,
    RoadParams,
    Wrench,
    accelerations,
    gravity_in_car,
    move_body,
)
from vehicle_fmu.effort import Effort
from vehicle_fmu.loads import Felt, Loads, RollParams, feel, wheel_loads
from vehicle_fmu.tires import Force, TireParams
from vehicle_fmu.wheels import Contact, HubParams, Wheel, turn_wheel


class DoubleTrackParams(NamedTuple):
    """What the four-wheel body has beyond mass and axles."""

    track_front: Annotated[float, Signal("m", "front track width", 0.1, 5.0, CHOSEN)] = 1.42
    track_rear: Annotated[float, Signal("m", "rear track width", 0.1, 5.0, CHOSEN)] = 1.42
    ackermann: Annotated[
        float, Signal("1", "front wheels: 0 parallel to 1 aimed at one turning centre", 0.0, 1.0, CHOSEN)
    ] = 1.0
    hub: HubParams = HubParams()
    roll: RollParams = RollParams()
    tires: TireParams = TireParams()


class DoubleTrackState(NamedTuple):
    """Motion, wheels (front left, front right, rear left, rear right) and felt acceleration."""

    motion: Motion = Motion()
    wheels: tuple[Wheel, ...] = (Wheel(),) * 4
    felt: Felt = Felt()


class Corner(NamedTuple):
    """A wheel's place and what acts on it besides the road."""

    x: float
    y: float
    angle: float
    load: float
    camber: float
    grip: float
    drive: float
    brake: float


def wheel_angles(angle: float, wheelbase: float, track: float, ackermann: float) -> tuple[float, float]:
    """Return (left, right) front-wheel angles [rad] around the equivalent ``angle``.

    cot(left) = cot(angle) - T / 2L, right with plus (Ackermann); ``ackermann`` scales T.
    """
    if angle == 0.0:
        return angle, angle
    tangent = math.tan(angle)
    half = 0.5 * ackermann * track * tangent / wheelbase
    return _inner(tangent, 1.0 - half), _inner(tangent, 1.0 + half)


def resting(
    pose: Pose, angle: float, wheelbase: float, chassis: ChassisParams, p: DoubleTrackParams, road: RoadParams
) -> DoubleTrackState:
    """Return the car at rest, its carcasses deflected so that they carry it on the slope."""
    gravity = gravity_in_car(pose.heading, road)
    felt = Felt(-gravity.x, -gravity.y)
    loads = wheel_loads(felt, gravity.normal, wheelbase, (p.track_front, p.track_rear), chassis, p.roll)
    left, right = wheel_angles(angle, wheelbase, p.track_front, p.ackermann)
    share = 1.0 / (chassis.mass * gravity.normal)
    return DoubleTrackState(
        Motion(pose, 0.0, 0.0, 0.0),
        (
            _carrying(chassis.mass * share * loads.front_left, felt, left, p.tires),
            _carrying(chassis.mass * share * loads.front_right, felt, right, p.tires),
            _carrying(chassis.mass * share * loads.rear_left, felt, 0.0, p.tires),
            _carrying(chassis.mass * share * loads.rear_right, felt, 0.0, p.tires),
        ),
        felt,
    )


def _carrying(mass: float, felt: Felt, angle: float, tires: TireParams) -> Wheel:
    cos = math.cos(angle)
    sin = math.sin(angle)
    x = mass * (felt.x * cos + felt.y * sin)
    y = mass * (felt.y * cos - felt.x * sin)
    return Wheel(0.0, x / tires.carcass_x, y / tires.carcass_y, Force(x, y))


def step_double_track(
    state: DoubleTrackState,
    angle: float,
    effort: Effort,
    wheelbase: float,
    chassis: ChassisParams,
    p: DoubleTrackParams,
    road: RoadParams,
    h: float,
) -> DoubleTrackState:
    """Return the car ``h`` [s] later at front-wheel ``angle`` [rad] under ``effort``."""
    motion = state.motion
    gravity = gravity_in_car(motion.pose.heading, road)
    loads = wheel_loads(state.felt, gravity.normal, wheelbase, (p.track_front, p.track_rear), chassis, p.roll)
    corners = _corners(angle, effort, loads, wheelbase, chassis, p, road)
    fl = _turn(state.wheels[0], corners[0], motion, p.hub, p.tires, h)
    fr = _turn(state.wheels[1], corners[1], motion, p.hub, p.tires, h)
    rl = _turn(state.wheels[2], corners[2], motion, p.hub, p.tires, h)
    rr = _turn(state.wheels[3], corners[3], motion, p.hub, p.tires, h)
    on_fl = _wrench(fl, corners[0])
    on_fr = _wrench(fr, corners[1])
    on_rl = _wrench(rl, corners[2])
    on_rr = _wrench(rr, corners[3])
    total = Wrench(
        (on_fl.x + on_fr.x) + (on_rl.x + on_rr.x),
        (on_fl.y + on_fr.y) + (on_rl.y + on_rr.y),
        (on_fl.yaw + on_fr.yaw) + (on_rl.yaw + on_rr.yaw),
    )
    change = accelerations(motion, total, gravity, chassis)
    return DoubleTrackState(
        move_body(motion, change, chassis.cg_to_rear, h),
        (fl, fr, rl, rr),
        feel(state.felt, total.x / chassis.mass, total.y / chassis.mass, p.roll.lag, h),
    )


def _corners(
    angle: float,
    effort: Effort,
    loads: Loads,
    wheelbase: float,
    chassis: ChassisParams,
    p: DoubleTrackParams,
    road: RoadParams,
) -> tuple[Corner, Corner, Corner, Corner]:
    a = wheelbase - chassis.cg_to_rear
    b = -chassis.cg_to_rear
    left, right = wheel_angles(angle, wheelbase, p.track_front, p.ackermann)
    half = 0.5 * p.hub.radius
    drive_f = half * effort.drive * chassis.front_drive_share
    drive_r = half * effort.drive * (1.0 - chassis.front_drive_share)
    brake_f = half * effort.brake * chassis.front_brake_share
    brake_r = half * effort.brake * (1.0 - chassis.front_brake_share)
    y_f = 0.5 * p.track_front
    y_r = 0.5 * p.track_rear
    lean_f = p.roll.camber_front * loads.roll
    lean_r = p.roll.camber_rear * loads.roll
    drag = chassis.rolling_resistance * p.hub.radius
    fl = loads.front_left
    fr = loads.front_right
    rl = loads.rear_left
    rr = loads.rear_right
    return (
        Corner(a, y_f, left, fl, lean_f, road.grip[0], drive_f, brake_f + drag * fl),
        Corner(a, -y_f, right, fr, lean_f, road.grip[1], drive_f, brake_f + drag * fr),
        Corner(b, y_r, 0.0, rl, lean_r, road.grip[2], drive_r, brake_r + drag * rl),
        Corner(b, -y_r, 0.0, rr, lean_r, road.grip[3], drive_r, brake_r + drag * rr),
    )


def _turn(wheel: Wheel, at: Corner, motion: Motion, hub: HubParams, tires: TireParams, h: float) -> Wheel:
    forward = motion.speed_x - at.y * motion.yaw_rate
    leftward = motion.speed_y + at.x * motion.yaw_rate
    cos = math.cos(at.angle)
    sin = math.sin(at.angle)
    contact = Contact(
        forward * cos + leftward * sin,
        leftward * cos - forward * sin,
        at.load,
        at.camber,
        at.grip,
        at.drive,
        at.brake,
    )
    return turn_wheel(wheel, contact, hub, tires, h)


def _wrench(wheel: Wheel, at: Corner) -> Wrench:
    cos = math.cos(at.angle)
    sin = math.sin(at.angle)
    x = wheel.force.x * cos - wheel.force.y * sin
    y = wheel.force.x * sin + wheel.force.y * cos
    return Wrench(x, y, at.x * y - at.y * x)


def _inner(tangent: float, share: float) -> float:
    return math.atan(tangent / share) if share > 0.05 else math.atan(tangent / 0.05)
