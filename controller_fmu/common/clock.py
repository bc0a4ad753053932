"""When the systems of a controller act: at the instants k * sample_time, with the inputs that hold then.

Whatever the communication step; the outputs are held in between.
"""

import math
from typing import NamedTuple

from controller_fmu.common.phases import CommonPhase
from controller_fmu.interface import Clocked, Reason, RefusedOutput
from modelkit.maths import is_finite
from modelkit.vocabulary import Prompt


class Clock(NamedTuple):
    """When the controller acts next."""

    time_ns: int = 0
    next_sample_ns: int = 0
    usable: bool = True
    """False: the parameters make no sense, and it never acts."""


def begin(params: Clocked) -> Clock:
    """Return the clock at time zero; not usable if the parameters make no sense."""
    return Clock(usable=_is_usable(params))


def tick(clock: Clock, params: Clocked, dt_ns: int) -> tuple[Clock, int, int]:
    """Return the clock ``dt_ns`` later, and how many samples of which length [ns] were due before."""
    end_ns = clock.time_ns + dt_ns
    if not clock.usable:
        return Clock(end_ns, clock.next_sample_ns, False), 0, 0
    period_ns = math.floor(params.sample_time * 1e9 + 0.5)
    samples = 0
    if clock.next_sample_ns < end_ns:
        samples = (end_ns - clock.next_sample_ns + period_ns - 1) // period_ns
    return Clock(end_ns, clock.next_sample_ns + samples * period_ns, True), samples, period_ns


def refusal_output() -> RefusedOutput:
    """Return the outputs of a controller that cannot work with its parameters: it stops the car."""
    return RefusedOutput(prompt=Prompt.STOP, brake_request=True, phase=CommonPhase.FAILED, reason=Reason.BAD_PARAMETER)


def _is_usable(params: Clocked) -> bool:
    target = params.target
    steering = params.car.steering
    lock = steering.angle_limit / steering.ratio if steering.ratio > 0.0 else 0.0
    return (
        is_finite(target.x + target.y + target.heading)
        and is_finite(params.car.wheelbase + params.sample_time + steering.rate_limit)
        and params.car.wheelbase > 0.0
        and params.sample_time >= 1e-4
        and steering.rate_limit > 0.0
        and 0.0 < lock < 1.5
    )
