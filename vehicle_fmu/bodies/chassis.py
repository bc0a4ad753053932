"""The rigid car in the plane: mass, gravity on a slope, air drag, and how forces move it.

ISO 8855, car frame at the centre of gravity:

    m (v_x' - v_y r) = F_x    m (v_y' + v_x r) = F_y    I_z r' = M_z

The position kept is the rear-axle midpoint, whose lateral speed is v_y - b r.
"""

import math
from typing import Annotated, NamedTuple

from modelkit.signal import Role, Signal
from modelkit.vocabulary import Pose

GRAVITY_ACCELERATION = 9.81
CHOSEN = "chosen, usual for a small car"


class ChassisParams(NamedTuple):
    """Mass, how high it is, what slows it down, and which axle drives."""

    mass: Annotated[float, Signal("kg", "mass", 10.0, 1e5, CHOSEN)] = 1100.0
    yaw_inertia: Annotated[float, Signal("kg.m2", "moment of inertia about the vertical", 1.0, 1e6, CHOSEN)] = 1500.0
    cg_height: Annotated[float, Signal("m", "centre of gravity above the road", 0.0, 3.0, CHOSEN)] = 0.55
    rolling_resistance: Annotated[float, Signal("1", "rolling resistance over load", 0.0, 0.2, CHOSEN)] = 0.012
    drag_x: Annotated[float, Signal("kg/m", "air drag over speed squared, along", 0.0, 10.0, CHOSEN)] = 0.4
    drag_y: Annotated[float, Signal("kg/m", "air drag over speed squared, across", 0.0, 10.0, CHOSEN)] = 1.5
    front_drive_share: Annotated[
        float, Signal("1", "fraction of the drive force on the front axle", 0.0, 1.0, CHOSEN)
    ] = 1.0
    front_brake_share: Annotated[
        float, Signal("1", "fraction of the brake force on the front axle", 0.0, 1.0, CHOSEN)
    ] = 0.65


class RampParams(NamedTuple):
    """A second plane, such as a drive beside the road: on the left of a line its grade adds to the road's."""

    x: Annotated[float, Signal("m", "x of a point on the line where the ramp begins", -1e8, 1e8)] = 0.0
    y: Annotated[float, Signal("m", "y of a point on the line where the ramp begins", -1e8, 1e8)] = 0.0
    heading: Annotated[float, Signal("rad", "direction of that line; the ramp is on its left", -100.0, 100.0)] = 0.0
    grade: Annotated[float, Signal("1", "grade to the left of the line (rise over run); 0: no ramp", -1.0, 1.0)] = 0.0


class RoadParams(NamedTuple):
    """The road plane, a ramp beside it, and the grip under each wheel."""

    grade: Annotated[float, Signal("1", "grade along the x axis of the world (rise over run)", -1.0, 1.0)] = 0.0
    cross_slope: Annotated[
        float, Signal("1", "cross slope along the y axis of the world (rise over run)", -1.0, 1.0)
    ] = 0.0
    grip: tuple[
        Annotated[
            float,
            Signal("1", "friction against a dry road; front left, front right, rear left, rear right", 0.0, 2.0),
            Role.TUNABLE,
        ],
        ...,
    ] = (1.0, 1.0, 1.0, 1.0)
    ramp: RampParams = RampParams()


class Stance(NamedTuple):
    """How the mass stands between its axles [m]."""

    wheelbase: float
    cg_to_rear: float
    """Centre of gravity to rear axle."""


class Build(NamedTuple):
    """What the bodies with mass have in common: axles, mass, and the road they stand on."""

    stance: Stance
    chassis: ChassisParams
    road: RoadParams


class Motion(NamedTuple):
    """Where the car is and how it moves."""

    pose: Pose = Pose()
    speed_x: float = 0.0
    """Forward speed [m/s], the same at the rear axle and the centre of gravity."""
    speed_y: float = 0.0
    """Leftward speed of the centre of gravity [m/s]."""
    yaw_rate: float = 0.0


class Wrench(NamedTuple):
    """Forces [N] and moment [N m] on the centre of gravity, in the car's frame."""

    x: float
    y: float
    yaw: float


class Gravity(NamedTuple):
    """Acceleration of gravity [m/s2] in the car's frame: along, to the left, into the road."""

    x: float
    y: float
    normal: float


def gravity_in_car(pose: Pose, road: RoadParams) -> Gravity:
    """Return gravity [m/s2] seen by a car at ``pose`` on the plane z = grade x + cross_slope y, or on its ramp.

    It is on the ramp when its rear axle's midpoint is.
    """
    grade = road.grade
    cross_slope = road.cross_slope
    if road.ramp.grade != 0.0:
        left_x = -math.sin(road.ramp.heading)
        left_y = math.cos(road.ramp.heading)
        if (pose.x - road.ramp.x) * left_x + (pose.y - road.ramp.y) * left_y > 0.0:
            grade = grade + road.ramp.grade * left_x
            cross_slope = cross_slope + road.ramp.grade * left_y
    normal = GRAVITY_ACCELERATION / math.sqrt(1.0 + grade * grade + cross_slope * cross_slope)
    east = -normal * grade
    north = -normal * cross_slope
    cos = math.cos(pose.heading)
    sin = math.sin(pose.heading)
    return Gravity(east * cos + north * sin, north * cos - east * sin, normal)


def accelerations(motion: Motion, tires: Wrench, gravity: Gravity, p: ChassisParams) -> Wrench:
    """Return F_x / m, F_y / m [m/s2] and M_z / I_z [rad/s2] of tyres, gravity and air."""
    drag_x = p.drag_x * motion.speed_x * abs(motion.speed_x)
    drag_y = p.drag_y * motion.speed_y * abs(motion.speed_y)
    return Wrench(
        (tires.x - drag_x) / p.mass + gravity.x, (tires.y - drag_y) / p.mass + gravity.y, tires.yaw / p.yaw_inertia
    )


def move_body(motion: Motion, change: Wrench, cg_to_rear: float, h: float) -> Motion:
    """Return the motion ``h`` [s] later under accelerations ``change``.

    Forces change the velocity, then the axes turn under it by an exact rotation (so that turning
    neither makes nor takes energy); the pose follows the mean of old and new velocity.
    """
    yaw_rate = motion.yaw_rate + h * change.yaw
    turn = 0.5 * h * (motion.yaw_rate + yaw_rate)
    push_x = motion.speed_x + h * change.x
    push_y = motion.speed_y + h * change.y
    cos = math.cos(turn)
    sin = math.sin(turn)
    speed_x = push_x * cos + push_y * sin
    speed_y = push_y * cos - push_x * sin
    heading = motion.pose.heading
    rear = 0.5 * ((motion.speed_y - cg_to_rear * motion.yaw_rate) + (speed_y - cg_to_rear * yaw_rate))
    along = 0.5 * (motion.speed_x + speed_x)
    cos = math.cos(heading + 0.5 * turn)
    sin = math.sin(heading + 0.5 * turn)
    pose = Pose(
        motion.pose.x + h * (along * cos - rear * sin), motion.pose.y + h * (along * sin + rear * cos), heading + turn
    )
    return Motion(pose, speed_x, speed_y, yaw_rate)
