"""The car: its outline, axles, steering and distance sensors. What drives and what controls each have one of these.

The same number in both is one fact: a scenario's ``car`` fills ``car.*`` of the vehicle and of the controller.
A controller whose model is of another car than it drives is a study of what it then does.
"""

import math
from math import pi
from typing import Annotated, NamedTuple

from modelkit.signal import Role, Signal

GUO = "Guo 2015, Table 1"
HOUSE = "project default; the source states none"
USUAL = "usual for parking sensors"


class CarSteering(NamedTuple):
    """From the steering wheel to the front wheels."""

    ratio: Annotated[float, Signal("1", "steering-wheel angle over front-wheel angle", 1.0, 60.0, GUO)] = 19.0
    angle_limit: Annotated[float, Signal("rad", "largest steering-wheel angle", 0.1, 20.0, GUO), Role.TUNABLE] = (
        570.0 * pi / 180.0
    )
    rate_limit: Annotated[float, Signal("rad/s", "largest steering-wheel rate", 0.01, 100.0, GUO), Role.TUNABLE] = (
        570.0 * pi / 180.0
    )


class SensorMount(NamedTuple):
    """Where a sensor sits on the car and where it looks."""

    x: Annotated[float, Signal("m", "ahead of the rear axle", -30.0, 30.0)] = 0.0
    y: Annotated[float, Signal("m", "to the left of the car's middle", -10.0, 10.0)] = 0.0
    yaw: Annotated[float, Signal("rad", "direction of its axis, left positive", -10.0, 10.0)] = 0.0


SENSOR_MOUNTS = (
    SensorMount(3.10, 0.68, pi / 6.0),
    SensorMount(3.205, 0.25, 0.0),
    SensorMount(3.205, -0.25, 0.0),
    SensorMount(3.10, -0.68, -pi / 6.0),
    SensorMount(-0.50, 0.68, pi * 5.0 / 6.0),
    SensorMount(-0.60, 0.25, pi),
    SensorMount(-0.60, -0.25, pi),
    SensorMount(-0.50, -0.68, -pi * 5.0 / 6.0),
    SensorMount(2.80, 0.825, pi / 2.0),
    SensorMount(-0.20, 0.825, pi / 2.0),
    SensorMount(2.80, -0.825, -pi / 2.0),
    SensorMount(-0.20, -0.825, -pi / 2.0),
)
"""Twelve ultrasonic sensors on the car of Guo 2015: 3.205 m ahead, 0.6 m behind, 0.825 m to each side."""


class CarUltrasonic(NamedTuple):
    """The twelve ultrasonic sensors: where they sit, how far they hear, how often they tell."""

    mounts: tuple[SensorMount, ...] = SENSOR_MOUNTS
    half_angle: Annotated[float, Signal("rad", "half beam width", 0.01, 1.5, USUAL)] = 30.0 * pi / 180.0
    min_range: Annotated[float, Signal("m", "minimum range (blind zone)", 0.0, 10.0, USUAL)] = 0.15
    max_range: Annotated[float, Signal("m", "maximum range", 0.1, 100.0, USUAL)] = 5.0
    resolution: Annotated[float, Signal("m", "quantisation of a measurement; 0: none", 0.0, 1.0, USUAL)] = 0.01
    cycle: Annotated[float, Signal("s", "measurement cycle", 1e-3, 10.0, USUAL)] = 0.04


class Car(NamedTuple):
    """The car, about the midpoint of its rear axle; the default is that of Guo 2015."""

    wheelbase: Annotated[float, Signal("m", "front to rear axle", 0.1, 20.0, GUO)] = 2.405
    front_overhang: Annotated[float, Signal("m", "front axle to bumper", 0.0, 5.0, HOUSE)] = 0.80
    rear_overhang: Annotated[float, Signal("m", "rear axle to bumper", 0.0, 5.0, HOUSE)] = 0.60
    width: Annotated[float, Signal("m", "body width", 0.1, 5.0, HOUSE)] = 1.65
    cg_to_rear: Annotated[float, Signal("m", "centre of gravity to rear axle", 0.01, 20.0, HOUSE)] = 1.40
    steering: CarSteering = CarSteering()
    ultrasonic: CarUltrasonic = CarUltrasonic()


def car_length(car: Car) -> float:
    """Return the length of the car [m]."""
    return car.wheelbase + car.front_overhang + car.rear_overhang


def largest_curvature(car: Car) -> float:
    """Return the largest curvature [1/m] of the rear axle's path: the front wheels at their lock, tan(phi) / L."""
    return math.tan(car.steering.angle_limit / car.steering.ratio) / car.wheelbase


def smallest_radius(car: Car) -> float:
    """Return the smallest radius [m] that the rear axle's middle turns on: the front wheels at their lock."""
    return car.wheelbase / math.tan(car.steering.angle_limit / car.steering.ratio)


def mounts_on(front: float, rear: float, half_width: float) -> tuple[SensorMount, ...]:
    """Return twelve sensors on an outline ``front`` ahead of and ``rear`` behind the rear axle [m], as usual.

    Four across each bumper, the outer two turned out by 30 deg, and two on each side.
    """
    side = half_width - 0.15
    places = (
        (front - 0.1, side),
        (front, 0.25),
        (front, -0.25),
        (front - 0.1, -side),
        (0.1 - rear, side),
        (-rear, 0.25),
        (-rear, -0.25),
        (0.1 - rear, -side),
        (front - 0.4, half_width),
        (0.4 - rear, half_width),
        (front - 0.4, -half_width),
        (0.4 - rear, -half_width),
    )
    return tuple(SensorMount(x, y, mount.yaw) for (x, y), mount in zip(places, SENSOR_MOUNTS, strict=True))
