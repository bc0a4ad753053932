"""The controller as one step: sample, choose the system, hold its outputs."""

from typing import NamedTuple

from controller_fmu.interface import ControllerInput, ControllerOutput, ControllerParams


class ControllerState(NamedTuple):
    time_ns: int = 0


def initialize(params: ControllerParams) -> tuple[ControllerState, ControllerOutput]:
    return ControllerState(), ControllerOutput()


def step(
    state: ControllerState, inputs: ControllerInput, params: ControllerParams, dt_ns: int
) -> tuple[ControllerState, ControllerOutput]:
    return ControllerState(state.time_ns + dt_ns), ControllerOutput()
