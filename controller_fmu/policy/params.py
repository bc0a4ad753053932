"""What can be set of the controller that carries out a policy: car, target, slot, largest requests, tolerances."""

from enum import IntEnum
from math import pi
from typing import Annotated, NamedTuple

from controller_fmu.interface import HOUSE, AssumedCar, SampleTime, Target
from modelkit.car import Car
from modelkit.signal import Group, Role, Signal
from modelkit.vocabulary import Pose


class PolicySystem(IntEnum):
    """Its value of ``controller.system``."""

    POLICY = 9
    """Carries out the actions of a learned policy; without one the car stands; a controller of its own."""


class KnownSlot(NamedTuple):
    """The slot as the policy knows it."""

    x: Annotated[float, Signal("m", "x of its middle", -1e8, 1e8)] = 0.0
    y: Annotated[float, Signal("m", "y of its middle", -1e8, 1e8)] = 0.0
    heading: Annotated[float, Signal("rad", "direction of its length", -100.0, 100.0)] = 0.0
    length: Annotated[float, Signal("m", "its length; 0: not known", 0.0, 1000.0)] = 0.0
    width: Annotated[float, Signal("m", "its width", 0.0, 1000.0)] = 0.0


class ToleranceParams(NamedTuple):
    """A car that stands within these is parked."""

    longitudinal: Annotated[float, Signal("m", "longitudinal error at which it is parked", 0.0, 10.0, HOUSE)] = 0.3
    lateral: Annotated[float, Signal("m", "lateral error at which it is parked", 0.0, 10.0, HOUSE)] = 0.1
    heading: Annotated[float, Signal("rad", "heading error at which it is parked", 0.0, 1.5, HOUSE)] = 2.5 * pi / 180.0
    standstill: Annotated[float, Signal("m/s", "speed below which it stands", 1e-6, 0.5, HOUSE)] = 0.005


class ActionParams(NamedTuple):
    """What an action of 1 means."""

    pedals: Annotated[bool, Signal("1", "actions are accelerator, wheel, brake; else speed, wheel"), Role.FIXED] = False
    max_speed: Annotated[float, Signal("m/s", "requested speed at an action of 1", 0.01, 10.0, HOUSE)] = 2.0
    min_speed: Annotated[float, Signal("m/s", "requested speeds below this stop the car", 0.0, 1.0, HOUSE)] = 0.1


class PolicyParams(NamedTuple):
    """The car as the policy knows it, where it shall stand, and its limits."""

    system: Annotated[int, Signal("1", "which system", states=PolicySystem)] = PolicySystem.POLICY
    car: AssumedCar = Car()
    sample_time: SampleTime = 0.01
    target: Target = Pose()
    slot: Annotated[KnownSlot, Group("slot")] = KnownSlot()
    action: ActionParams = ActionParams()
    tolerance: ToleranceParams = ToleranceParams()
    max_distance: Annotated[
        float, Signal("m", "distance to the target above which the controller gives up", 1.0, 1e4, HOUSE)
    ] = 30.0
