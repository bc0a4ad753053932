"""The vehicle as one step: driver, steering, drive, body."""

from typing import NamedTuple

from modelkit.vocabulary import Pose
from vehicle_fmu.interface import VehicleInput, VehicleOutput, VehicleParams


class VehicleState(NamedTuple):
    time_ns: int = 0
    pose: Pose = Pose()


def initialize(params: VehicleParams) -> tuple[VehicleState, VehicleOutput]:
    return VehicleState(0, params.start), VehicleOutput(params.start, params.start)


def step(state: VehicleState, inputs: VehicleInput, params: VehicleParams, dt_ns: int) -> tuple[VehicleState, VehicleOutput]:
    return VehicleState(state.time_ns + dt_ns, state.pose), VehicleOutput(state.pose, state.pose)
