"""Curvature and speed of each control mode."""

from typing import NamedTuple

from controller_fmu.hsic.characteristic_states import Errors, HsicStage
from controller_fmu.hsic.params import HsicGains
from controller_fmu.hsic.rules import SpeedMode, SteerMode
from modelkit.maths import clamp

SWITCHING_SLOPE = 10.0
"""Slope of the bang-bang's edge, so that it does not chatter on its switching line."""


class Situation(NamedTuple):
    """What a rule is applied to."""

    stage: int
    direction: int
    """1 forward, -1 in reverse."""
    found: Errors
    integral: float
    """Of the lateral error over the travelled distance [m2]."""


def curvature(mode: int, now: Situation, arc: float, lock: float, gain: HsicGains) -> float:
    """Return the curvature [1/m] asked for, left positive, held to the car's ``lock``.

    With s the travelled distance, y' = d theta and theta' = d kappa (d = +1 forward, -1 in reverse), so
    kappa = -kp y - kd y' gives y'' + kd y' + kp y = 0 in either direction. Bang-bang is the same
    switching line with a steep slope. Extremum hold keeps the planned ``arc``: to the right while
    turning in, to the left while counter-steering (in reverse). On the way to the ready point the lateral
    term is bounded, so that its line is approached no steeper than ``steepest``: cars stand beside it.
    """
    if mode == SteerMode.STRAIGHT:
        return 0.0
    if mode == SteerMode.EXTREMUM_HOLD and now.stage == HsicStage.TURN_IN:
        return -arc
    if mode == SteerMode.EXTREMUM_HOLD and now.stage == HsicStage.COUNTER:
        return arc
    lateral = gain.lateral * now.found.lateral
    if now.stage == HsicStage.READY:
        lateral = clamp(lateral, -gain.heading * gain.max_approach_heading, gain.heading * gain.max_approach_heading)
    line = lateral + gain.heading * now.direction * now.found.heading
    if mode in (SteerMode.BANG_BANG, SteerMode.EXTREMUM_HOLD):
        line = SWITCHING_SLOPE * line
    if mode == SteerMode.STRONG_PD:
        line = gain.gain_boost * line
    if mode == SteerMode.PID:
        line = line + gain.integral * now.integral
    return clamp(-line, -lock, lock)


def speed(mode: int, found: Errors, gain: HsicGains) -> float:
    """Return the speed [m/s] without its sign."""
    if mode == SpeedMode.STAND:
        return 0.0
    if mode == SpeedMode.FAST:
        return gain.max_speed
    if mode == SpeedMode.APPROACH:
        return clamp(gain.approach * abs(found.ahead), gain.min_speed, gain.max_speed)
    return gain.corrective_speed
