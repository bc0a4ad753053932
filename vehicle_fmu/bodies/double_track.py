"""The car on four wheels: planar motion, four spins, load transfer, Magic Formula tyres.

State: pose of the rear axle, v_x, v_y at the centre of gravity, yaw rate; per wheel its spin
and two carcass deflections; the accelerations its springs have felt. Road grade and cross slope by
gravity in the road plane, friction per wheel. One step is semi-implicit: wheels by the old
motion, then the motion by their forces; stable at rest, in reverse and at speed.

Each wheel is computed by the same function, and sums go front pair plus rear pair, so that a
mirrored manoeuvre gives mirrored bits.
"""

import math
from typing import Annotated, NamedTuple

from modelkit.signal import Signal
from modelkit.vocabulary import Pose
from vehicle_fmu.bodies.chassis import CHOSEN, Build, Motion, Wrench, accelerations, gravity_in_car, move_body
from vehicle_fmu.bodies.loads import Felt, Loads, RollParams, feel, wheel_loads
from vehicle_fmu.bodies.tires import Force, TireParams
from vehicle_fmu.bodies.wheels import Contact, HubParams, Wheel, turn_wheel
from vehicle_fmu.effort import Effort


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


class CarCorner(NamedTuple):
    """A wheel's place and what acts on it besides the road."""

    x: float
    y: float
    cos: float
    """Of the angle the wheel is turned by."""
    sin: float
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


def resting(pose: Pose, angle: float, build: Build, p: DoubleTrackParams) -> DoubleTrackState:
    """Return the car at rest, its carcasses deflected so that they carry it on the slope."""
    mass = build.chassis.mass
    gravity = gravity_in_car(pose, build.road)
    felt = Felt(-gravity.x, -gravity.y)
    loads = wheel_loads(felt, gravity.normal, build.stance, (p.track_front, p.track_rear), build.chassis, p.roll)
    left, right = wheel_angles(angle, build.stance.wheelbase, p.track_front, p.ackermann)
    share = 1.0 / (mass * gravity.normal)
    wheels = tuple(
        _carrying(mass * share * load, felt, turned, p.tires)
        for load, turned in zip(loads.wheels, (left, right, 0.0, 0.0), strict=True)
    )
    return DoubleTrackState(Motion(pose), wheels, felt)


def _carrying(mass: float, felt: Felt, angle: float, tires: TireParams) -> Wheel:
    cos = math.cos(angle)
    sin = math.sin(angle)
    x = mass * (felt.x * cos + felt.y * sin)
    y = mass * (felt.y * cos - felt.x * sin)
    return Wheel(u=x / tires.carcass_x, w=y / tires.carcass_y, force=Force(x, y))


def step_double_track(
    state: DoubleTrackState,
    angle: float,
    effort: Effort,
    build: Build,
    p: DoubleTrackParams,
    h: float,
) -> DoubleTrackState:
    """Return the car ``h`` [s] later at front-wheel ``angle`` [rad] under ``effort``."""
    motion = state.motion
    chassis = build.chassis
    gravity = gravity_in_car(motion.pose, build.road)
    loads = wheel_loads(state.felt, gravity.normal, build.stance, (p.track_front, p.track_rear), chassis, p.roll)
    corners = _corners(angle, effort, loads, build, p)
    wheels = tuple(_turn(wheel, at, motion, p.hub, p.tires, h) for wheel, at in zip(state.wheels, corners, strict=True))
    total = _sum(tuple(_wrench(wheel, at) for wheel, at in zip(wheels, corners, strict=True)))
    change = accelerations(motion, total, gravity, chassis)
    return DoubleTrackState(
        move_body(motion, change, build.stance.cg_to_rear, h),
        wheels,
        feel(state.felt, total.x / chassis.mass, total.y / chassis.mass, p.roll.lag, h),
    )


def _sum(on: tuple[Wrench, ...]) -> Wrench:
    """Return the sum over the wheels, front pair plus rear pair."""
    return Wrench(
        (on[0].x + on[1].x) + (on[2].x + on[3].x),
        (on[0].y + on[1].y) + (on[2].y + on[3].y),
        (on[0].yaw + on[1].yaw) + (on[2].yaw + on[3].yaw),
    )


def _corners(
    angle: float, effort: Effort, loads: Loads, build: Build, p: DoubleTrackParams
) -> tuple[CarCorner, CarCorner, CarCorner, CarCorner]:
    chassis = build.chassis
    front = build.stance.wheelbase - build.stance.cg_to_rear
    rear = -build.stance.cg_to_rear
    left, right = wheel_angles(angle, build.stance.wheelbase, p.track_front, p.ackermann)
    half = 0.5 * p.hub.radius
    drive_front = half * effort.drive * chassis.front_drive_share
    drive_rear = half * effort.drive * (1.0 - chassis.front_drive_share)
    brake_front = half * effort.brake * chassis.front_brake_share
    brake_rear = half * effort.brake * (1.0 - chassis.front_brake_share)
    y_front = 0.5 * p.track_front
    y_rear = 0.5 * p.track_rear
    lean_front = p.roll.camber_front * loads.roll
    lean_rear = p.roll.camber_rear * loads.roll
    drag = chassis.rolling_resistance * p.hub.radius
    grip = build.road.grip
    load = loads.wheels
    cos = (math.cos(left), math.cos(right))
    sin = (math.sin(left), math.sin(right))
    return (
        CarCorner(
            front, y_front, cos[0], sin[0], load[0], lean_front, grip[0], drive_front, brake_front + drag * load[0]
        ),
        CarCorner(
            front, -y_front, cos[1], sin[1], load[1], lean_front, grip[1], drive_front, brake_front + drag * load[1]
        ),
        CarCorner(rear, y_rear, 1.0, 0.0, load[2], lean_rear, grip[2], drive_rear, brake_rear + drag * load[2]),
        CarCorner(rear, -y_rear, 1.0, 0.0, load[3], lean_rear, grip[3], drive_rear, brake_rear + drag * load[3]),
    )


def _turn(wheel: Wheel, at: CarCorner, motion: Motion, hub: HubParams, tires: TireParams, h: float) -> Wheel:
    forward = motion.speed_x - at.y * motion.yaw_rate
    leftward = motion.speed_y + at.x * motion.yaw_rate
    contact = Contact(
        forward * at.cos + leftward * at.sin,
        leftward * at.cos - forward * at.sin,
        at.load,
        at.camber,
        at.grip,
        at.drive,
        at.brake,
    )
    return turn_wheel(wheel, contact, hub, tires, h)


def _wrench(wheel: Wheel, at: CarCorner) -> Wrench:
    x = wheel.force.x * at.cos - wheel.force.y * at.sin
    y = wheel.force.x * at.sin + wheel.force.y * at.cos
    return Wrench(x, y, at.x * y - at.y * x)


def _inner(tangent: float, share: float) -> float:
    return math.atan(tangent / max(0.05, share))
