"""What can be set in the quintic, MPC and PID system."""

from enum import IntEnum
from typing import Annotated, NamedTuple

from controller_fmu.common.params import LimitParams, ThresholdParams
from controller_fmu.interface import (
    TARGET,
    AssumedCar,
    Limits,
    OutlinedCar,
    SampleTime,
    Target,
    Thresholds,
)
from modelkit.car import Car
from modelkit.signal import Role, Signal, Subset

PAPER = "Zhang 2022, Table 1"
HOUSE = "project default; the source states none"


class QuinticParams(NamedTuple):
    """The path: arc, line, arc for the key points, quintics through them."""

    radius: Annotated[
        float, Signal("m", "desired radius of both arcs; larger if the quintics need it", 0.5, 100.0, HOUSE)
    ] = 5.0
    curvature_share: Annotated[
        float, Signal("1", "fraction of the maximum curvature and steering rate that the path may use", 0.1, 1.0, HOUSE)
    ] = 0.95


class ZhangSlot(NamedTuple):
    """The slot of Fig. 2: the planner keeps the car out of both neighbours."""

    length: Annotated[float, Signal("m", "l_c, from neighbour to neighbour; 0: unknown, ignored", 0.0, 30.0, HOUSE)] = (
        0.0
    )
    width: Annotated[float, Signal("m", "l_k, from kerb to the neighbours' side", 0.1, 10.0, HOUSE)] = 2.2
    aisle: Annotated[float, Signal("m", "l_w, width of the aisle beside the slot", 0.1, 100.0, HOUSE)] = 7.0
    rear_gap: Annotated[float, Signal("m", "gap to the slot's rear end when parked", 0.0, 10.0, HOUSE)] = 0.4
    margin: Annotated[float, Signal("m", "clearance of the planned path to both neighbours", 0.0, 1.0, HOUSE)] = 0.11


class MpcParams(NamedTuple):
    """Horizon, weights, limits and solver of the steering MPC."""

    period: Annotated[float, Signal("s", "control interval of the MPC", 1e-3, 1.0, HOUSE), Role.FIXED] = 0.05
    step_time: Annotated[float, Signal("s", "length of one prediction step", 1e-3, 1.0, HOUSE), Role.FIXED] = 0.1
    horizon: Annotated[int, Signal("1", "prediction horizon in steps, at most 12", 1, 12, HOUSE), Role.FIXED] = 12
    lateral: Annotated[float, Signal("1", "weight on lateral error [1/m2]", 0.0, 1e6, HOUSE)] = 100.0
    heading: Annotated[float, Signal("1", "weight on heading error [1/rad2]", 0.0, 1e6, HOUSE)] = 20.0
    angle: Annotated[float, Signal("1", "weight on front-wheel angle off the path's [1/rad2]", 0.0, 1e6, HOUSE)] = 0.1
    increment: Annotated[float, Signal("1", "weight on an angle increment [1/rad2]", 1e-9, 1e6, HOUSE)] = 1.0
    corridor: Annotated[float, Signal("m", "soft limit on lateral error", 1e-3, 10.0, HOUSE)] = 0.05
    slack_weight: Annotated[float, Signal("1", "weight of the slack on the lateral limit [1/m2]", 1e-3, 1e6, HOUSE)] = (
        1000.0
    )
    tolerance: Annotated[
        float, Signal("1", "complementarity gap at which the solver stops", 1e-15, 1e-2, HOUSE), Role.FIXED
    ] = 1e-10
    max_iterations: Annotated[int, Signal("1", "maximum iterations of the solver", 1, 200, HOUSE), Role.FIXED] = 40


class PidParams(NamedTuple):
    """Speed controller, equation (8), with conditional integration against wind-up."""

    proportional: Annotated[float, Signal("N.s/m", "Kp", 0.0, 1e6, HOUSE)] = 6000.0
    integral: Annotated[float, Signal("N/m", "Ki", 0.0, 1e6, HOUSE)] = 1000.0
    derivative: Annotated[float, Signal("kg", "Kd", 0.0, 1e5, HOUSE)] = 0.0
    limit: Annotated[float, Signal("N", "largest force", 1.0, 1e5, HOUSE)] = 2000.0


class ZhangParams(NamedTuple):
    """Path, steering, speed."""

    speed: Annotated[float, Signal("m/s", "speed driven in reverse, magnitude", 0.05, 3.0, PAPER), Role.TUNABLE] = 1.0
    ramp: Annotated[
        float, Signal("m/s2", "change of the set speed at start and end", 0.05, 5.0, HOUSE), Role.TUNABLE
    ] = 0.5
    stop_distance: Annotated[
        float, Signal("m", "distance to the target at which the brake holds", 1e-4, 0.5, HOUSE), Role.TUNABLE
    ] = 0.01
    quintic: QuinticParams = QuinticParams()
    slot: ZhangSlot = ZhangSlot()
    mpc: Annotated[MpcParams, Role.TUNABLE] = MpcParams()
    pid: Annotated[PidParams, Role.TUNABLE] = PidParams()


class ZhangSystem(IntEnum):
    """Its value of ``controller.system``."""

    ZHANG2022 = 2
    """Quintic path, MPC steering, PID speed (Zhang 2022)."""


class ZhangSystemParams(NamedTuple):
    """All that can be set of it."""

    sample_time: SampleTime = 0.01
    car: Annotated[AssumedCar, Subset(OutlinedCar)] = Car()
    target: Target = TARGET
    threshold: Thresholds = ThresholdParams()
    limit: Limits = LimitParams()
    zhang2022: ZhangParams = ZhangParams()
