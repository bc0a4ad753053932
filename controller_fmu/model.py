"""What the systems of the controller share: the clock and the state of all.

A sampled controller: the chosen system acts at the instants k * sample_time with the inputs that hold
then, whatever the communication step, and holds its outputs in between. ``controller_fmu.SYSTEMS``
names the systems, each with how it starts, what it does at a sample and what it puts out.
"""

import math
from typing import NamedTuple

from controller_fmu.adaptive.system import AdaptiveState
from controller_fmu.apa.system import ApaState
from controller_fmu.common.phases import CommonPhase
from controller_fmu.guo2015.system import GuoState
from controller_fmu.hsic.system import HsicState
from controller_fmu.interface import ControllerOutput, ControllerParams, Reason
from controller_fmu.preview.driving import DrivingState
from controller_fmu.zhang2022.system import ZhangState
from modelkit.maths import is_finite
from modelkit.vocabulary import Prompt


class Clock(NamedTuple):
    """When the controller acts next."""

    time_ns: int = 0
    next_sample_ns: int = 0
    usable: bool = True
    """False: the parameters make no sense, and it never acts."""


class ControllerState(NamedTuple):
    """Everything the controller remembers: its clock, and the memory of each system."""

    clock: Clock = Clock()
    guo2015: GuoState = GuoState()
    zhang2022: ZhangState = ZhangState()
    hsic: HsicState = HsicState()
    preview: DrivingState = DrivingState()
    apa: ApaState = ApaState()
    adaptive: AdaptiveState = AdaptiveState()


def begin(params: ControllerParams) -> Clock:
    """Return the clock at time zero; not usable if the parameters make no sense."""
    return Clock(usable=_is_usable(params))


def tick(clock: Clock, params: ControllerParams, dt_ns: int) -> tuple[Clock, int, int]:
    """Return the clock ``dt_ns`` later, and how many samples of which length [ns] were due before."""
    end_ns = clock.time_ns + dt_ns
    if not clock.usable:
        return Clock(end_ns, clock.next_sample_ns, False), 0, 0
    period_ns = math.floor(params.sample_time * 1e9 + 0.5)
    samples = 0
    if clock.next_sample_ns < end_ns:
        samples = (end_ns - clock.next_sample_ns + period_ns - 1) // period_ns
    return Clock(end_ns, clock.next_sample_ns + samples * period_ns, True), samples, period_ns


def refused() -> ControllerOutput:
    """Return the outputs of a controller that cannot work with its parameters: it stops the car."""
    return ControllerOutput(
        prompt=Prompt.STOP, brake_request=True, phase=CommonPhase.FAILED, reason=Reason.BAD_PARAMETER
    )


def _is_usable(params: ControllerParams) -> bool:
    target = params.target
    steering = params.car.steering
    lock = steering.angle_limit / steering.ratio if steering.ratio > 0.0 else 0.0
    return (
        is_finite(target.x + target.y + target.heading)
        and is_finite(params.car.wheelbase + params.sample_time + steering.rate_limit)
        and params.car.wheelbase > 0.0
        and params.sample_time >= 1e-4
        and steering.rate_limit > 0.0
        and params.guo2015.prompting.deceleration > 0.0
        and 0.0 < lock < 1.5
    )
