"""What can be set of NTBPTcwPT: the gains and the path of Guo 2015, its chart's thresholds, its prompts."""

from enum import IntEnum
from math import pi
from typing import Annotated, NamedTuple

from controller_fmu.common.params import LimitParams, ThresholdParams
from controller_fmu.guo2015.smooth_path import PathShape
from controller_fmu.interface import (
    TARGET,
    AssumedCar,
    Limits,
    SampleTime,
    SteeredCar,
    Target,
    Thresholds,
)
from modelkit.car import Car
from modelkit.signal import Role, Signal, Subset

GUO = "Guo 2015"
HOUSE = "project default; the source states none"


class GuoThresholds(NamedTuple):
    """When the manoeuvre chart calls a pose wrong, right, or reached."""

    leave_lateral: Annotated[
        float, Signal("m", "path deviation at which point tracking starts", 0.0, 10.0, GUO + ", case 4 at 4.58 s")
    ] = 0.154
    leave_heading: Annotated[float, Signal("rad", "path deviation at which point tracking starts", 0.0, 1.5, HOUSE)] = (
        0.25
    )
    resume_lateral: Annotated[
        float, Signal("m", "deviation at Q1 below which path tracking resumes", 0.0, 10.0, HOUSE)
    ] = 0.05
    resume_heading: Annotated[
        float, Signal("rad", "deviation at Q1 below which path tracking resumes", 0.0, 1.5, HOUSE)
    ] = 0.05
    park_lateral: Annotated[
        float, Signal("m", "error at standstill within which the vehicle is parked", 0.0, 10.0, HOUSE)
    ] = 0.03
    park_heading: Annotated[
        float, Signal("rad", "error at standstill within which the vehicle is parked", 0.0, 1.5, HOUSE)
    ] = 0.8 * pi / 180.0
    park_longitudinal: Annotated[
        float,
        Signal(
            "m",
            "an aligned vehicle farther ahead of Q3 is prompted back to Q3; in case 5 it stops in place",
            0.0,
            100.0,
            GUO + ", case 5 at 22.0 s",
        ),
    ] = 100.0
    moving_share: Annotated[
        float, Signal("1", "fraction of the parked limits at which a forward segment ends", 0.01, 1.0, HOUSE)
    ] = 0.35


class GuoPrompts(NamedTuple):
    """What the controller assumes of the driver when it prompts ahead of time."""

    speed_limit: Annotated[float, Signal("m/s", "default advised speed", 0.1, 10.0, HOUSE)] = 2.5
    point_speed: Annotated[
        float, Signal("m/s", "advised speed of point tracking", 0.01, 10.0, GUO + ", case 4: 5 to 9 s slowly forward")
    ] = 0.5
    creep_speed: Annotated[float, Signal("m/s", "advised speed at the end of a path segment", 0.01, 2.0, HOUSE)] = 0.2
    reaction: Annotated[float, Signal("s", "assumed reaction time of the driver", 0.0, 5.0, HOUSE)] = 0.3
    deceleration: Annotated[float, Signal("m/s2", "assumed deceleration of the driver", 0.1, 10.0, HOUSE)] = 2.0
    jump_deviation: Annotated[float, Signal("m", "accepted path deviation at a curvature jump", 1e-3, 1.0, HOUSE)] = (
        0.025
    )


class GuoParams(NamedTuple):
    """Gains and geometry of path tracking (k1, k2), point tracking (k3, k4) and the two-arc path."""

    path: Annotated[int, Signal("1", "path geometry", states=PathShape), Role.FIXED] = PathShape.TWO_ARCS
    k1: Annotated[float, Signal("1/m2", "path tracking, distance gain", 0.0, 100.0, GUO)] = 1.0
    k2: Annotated[float, Signal("1/m", "path tracking, heading gain", 0.0, 100.0, GUO)] = 0.8
    k3: Annotated[float, Signal("1/m2", "point tracking, distance gain", 0.0, 100.0, GUO)] = 1.0
    k4: Annotated[float, Signal("1/m", "point tracking, heading gain", 0.0, 100.0, GUO)] = 4.0
    radius: Annotated[float, Signal("m", "largest radius of both arcs", 0.5, 100.0, GUO + ", eq. (9)"), Role.FIXED] = (
        5.5
    )
    radius_reserve: Annotated[
        float, Signal("1", "smallest planned radius over the minimum turning radius", 1.0, 3.0, HOUSE), Role.FIXED
    ] = 1.05
    q2_distance: Annotated[
        float, Signal("m", "Q1 to Q2 along the tangent", 0.1, 10.0, GUO + ", Table 2"), Role.FIXED
    ] = 1.0
    q4_distance: Annotated[float, Signal("m", "Q3 to Q4 straight ahead", 0.1, 10.0, GUO + ", Table 2"), Role.FIXED] = (
        2.5
    )
    threshold: GuoThresholds = GuoThresholds()
    prompting: GuoPrompts = GuoPrompts()


class GuoSystem(IntEnum):
    """Its values of ``controller.system``."""

    NTBPTCWPT = 0
    """Path tracking combined with point tracking (Guo 2015, section 4)."""
    NTBPT = 1
    """Path tracking only (Guo 2015, section 3)."""


class GuoSystemParams(NamedTuple):
    """All that can be set of it."""

    system: Annotated[int, Signal("1", "controller selection", states=GuoSystem)] = GuoSystem.NTBPTCWPT
    sample_time: SampleTime = 0.01
    car: Annotated[AssumedCar, Subset(SteeredCar)] = Car()
    target: Target = TARGET
    threshold: Thresholds = ThresholdParams()
    limit: Limits = LimitParams()
    guo2015: Annotated[GuoParams, Role.TUNABLE] = GuoParams()
