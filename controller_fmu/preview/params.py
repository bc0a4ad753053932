"""What can be set in the dual-point preview system, with the paper's values."""

from enum import IntEnum
from math import pi
from typing import Annotated, NamedTuple, Protocol

from controller_fmu.common.params import ThresholdParams
from controller_fmu.interface import (
    AssumedCar,
    SampleTime,
    SteeredCar,
    Thresholds,
)
from modelkit.car import Car
from modelkit.signal import Role, Signal, Subset

PAPER = "preview paper"
HOUSE = "project default; the source states none"


class Method(IntEnum):
    """How many preview points."""

    DUAL = 0
    """The paper's two points and its sequence."""
    SINGLE = 1
    """The conventional one: L1 by (5) everywhere, no slowing."""


class Camera(IntEnum):
    """Where yL and epsL come from."""

    KINEMATICS = 0
    """Equation (2), integrated from the odometry, as the paper simulates it."""
    GEOMETRY = 1
    """The road ahead seen from the measured pose."""


class RuleTable(IntEnum):
    """Which steering rules."""

    SYMMETRIC = 0
    PRINTED = 1


class RoadPiece(NamedTuple):
    """A piece of road of constant curvature."""

    length: Annotated[float, Signal("m", "length along the road, >= 0; 0: unused", 0.0, 1e6)] = 0.0
    curvature: Annotated[float, Signal("1/m", "curvature, left positive", -10.0, 10.0)] = 0.0


DEFAULT_ROAD = (
    RoadPiece(100.0, 0.0),
    RoadPiece(50.0 * pi, -0.01),
    RoadPiece(100.0, 0.0),
    RoadPiece(50.0 * pi, 0.02),
    RoadPiece(102.0, 0.0),
    RoadPiece(25.0 * pi, -0.04),
    RoadPiece(102.0, 0.0),
    RoadPiece(20.0 * pi, 0.05),
    RoadPiece(100.0, 0.0),
) + (RoadPiece(),) * 3
"""Fig. 7 is lost. Printed: the curvatures, and points C and E, which put curve 2 from s = 357.1 to 514.2 m, a half
circle. 100 m straights and a quarter circle as curve 1 put it there to the decimetre. Chosen: half circles for curves 3
and 4, 102 m before each (which decides where in its period the alternation meets the curve, see README.md)."""


class PreviewParams(NamedTuple):
    """Road, preview distances, sequence, speeds and fuzzy sets."""

    method: Annotated[int, Signal("1", "one or two preview points", states=Method), Role.FIXED] = Method.DUAL
    camera: Annotated[int, Signal("1", "where yL and epsL come from", states=Camera), Role.FIXED] = Camera.KINEMATICS
    rules: Annotated[int, Signal("1", "steering rule table", states=RuleTable), Role.FIXED] = RuleTable.SYMMETRIC
    road: Annotated[tuple[RoadPiece, ...], Role.FIXED] = DEFAULT_ROAD
    set_speed: Annotated[float, Signal("m/s", "speed on straights", 0.1, 40.0, PAPER)] = 8.3
    safe_acceleration: Annotated[
        float, Signal("m/s2", "a in the safe speed sqrt(a / |kappa|)", 0.01, 10.0, PAPER + ", (3)")
    ] = 0.578
    straight_slope: Annotated[float, Signal("s", "a1 of L1 = a1 v + a2", 0.0, 10.0, PAPER + ", (5)")] = 1.22
    straight_offset: Annotated[float, Signal("m", "a2 of L1 = a1 v + a2", -50.0, 50.0, PAPER + ", (5)")] = -4.04
    straight_shortest: Annotated[float, Signal("m", "smallest L1 on straights", 0.1, 50.0, PAPER + ", (5)")] = 4.5
    straight_longest: Annotated[float, Signal("m", "largest L1 on straights", 0.1, 100.0, PAPER + ", (5)")] = 15.5
    curve_slope: Annotated[float, Signal("m2", "b1 of L1 = b1 |kappa2| + b2", -1e4, 0.0, PAPER + ", (6)")] = -50.0
    curve_offset: Annotated[float, Signal("m", "b2 of L1 = b1 |kappa2| + b2", 0.1, 50.0, PAPER + ", (6)")] = 4.5
    curve_shortest: Annotated[float, Signal("m", "smallest L1 on curves", 0.1, 50.0, PAPER + ", (6)")] = 2.0
    curve_longest: Annotated[float, Signal("m", "largest L1 on curves", 0.1, 50.0, PAPER + ", (6)")] = 4.0
    near_gap: Annotated[float, Signal("m", "L2 - L1, near", 0.1, 50.0, PAPER + ", (4)")] = 2.0
    far_gap: Annotated[
        float, Signal("m", "L2 - L1, far: 2 + 18 as the printed 25.7 m at 5.7 m", 0.1, 100.0, PAPER + ", (4)")
    ] = 20.0
    period: Annotated[float, Signal("s", "T, period of the alternation", 0.01, 100.0, PAPER)] = 1.0
    far_time: Annotated[float, Signal("s", "td, far part of the period", 0.0, 100.0, PAPER)] = 0.2
    lateral_range: Annotated[float, Signal("m", "yL that maps to 3", 1e-3, 10.0, PAPER)] = 0.2
    heading_range: Annotated[float, Signal("rad", "epsL that maps to 3", 1e-3, 3.0, PAPER)] = 30.0 * pi / 180.0
    steering_range: Annotated[float, Signal("rad", "front-wheel angle at 3", 1e-3, 1.5, PAPER)] = 34.5 * pi / 180.0
    speed_range: Annotated[float, Signal("m/s", "speed error that maps to 3", 1e-3, 100.0, PAPER)] = 6.0
    rate_range: Annotated[float, Signal("m/s2", "speed-error rate that maps to 3", 1e-3, 1e6, PAPER)] = 1000.0
    force_range: Annotated[float, Signal("N", "force at 3", 1.0, 1e5, PAPER)] = 750.0
    lateral_gain: Annotated[float, Signal("1", "factor on the mapped yL", 0.01, 100.0, HOUSE)] = 2.0
    heading_gain: Annotated[float, Signal("1", "factor on the mapped epsL", 0.01, 100.0, HOUSE)] = 1.0
    lateral_peaks: Annotated[
        tuple[float, ...], Signal("1", "peaks of the sets of yL, on [-3, 3]", -10.0, 10.0, HOUSE), Role.FIXED
    ] = (-3.0, -1.5, 0.0, 1.5, 3.0)
    heading_peaks: Annotated[
        tuple[float, ...], Signal("1", "peaks of the sets of epsL, on [-3, 3]", -10.0, 10.0, HOUSE), Role.FIXED
    ] = (-3.0, -1.5, 0.0, 1.5, 3.0)
    steering_peaks: Annotated[
        tuple[float, ...],
        Signal("1", "peaks of the sets of the steering angle, on [-3, 3]", -10.0, 10.0, HOUSE),
        Role.FIXED,
    ] = (-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0)
    speed_peaks: Annotated[
        tuple[float, ...],
        Signal("1", "peaks of the sets of the speed error, on [-3, 3]", -10.0, 10.0, HOUSE),
        Role.FIXED,
    ] = (-0.3, -0.1, 0.0, 0.1, 0.3)
    rate_peaks: Annotated[
        tuple[float, ...], Signal("1", "peaks of the sets of its rate, on [-3, 3]", -10.0, 10.0, HOUSE), Role.FIXED
    ] = (-3.0, -1.5, 0.0, 1.5, 3.0)
    force_peaks: Annotated[
        tuple[float, ...], Signal("1", "peaks of the sets of the force, on [-3, 3]", -10.0, 10.0, HOUSE), Role.FIXED
    ] = (-3.5, -2.0, -1.0, 0.0, 1.0, 2.0, 3.5)


class PreviewSystem(IntEnum):
    """Its value of ``controller.system``."""

    PREVIEW = 4
    """Dual-point preview with fuzzy steering and speed on a road (does not park)."""


class PreviewCar(SteeredCar, Protocol):
    """What it has of the car."""

    cg_to_rear: float


class PreviewThresholds(Protocol):
    """What it has of the thresholds."""

    abort_lateral_error: float
    standstill: float


class PreviewSystemParams(NamedTuple):
    """All that can be set of it."""

    sample_time: SampleTime = 0.01
    car: Annotated[AssumedCar, Subset(PreviewCar)] = Car()
    threshold: Annotated[Thresholds, Subset(PreviewThresholds)] = ThresholdParams()
    preview: Annotated[PreviewParams, Role.TUNABLE] = PreviewParams()
