"""How the car rolls from one piece of its path to the next: the wheel turns on the move where that is near enough.

Where the curvature jumps by dk it changes linearly over a ramp of length r instead, half of it before the joint. The
heading behind it is the path's, and the car is beside it by dk r^2 / 24. The wheel needs a time T for it, so the car
may go r / T. Where that would be slower than ``SLOWEST`` it stands, and the wheel turns at rest.
"""

import math
from typing import NamedTuple

from controller_fmu.planning.plan import PATH, Path
from controller_fmu.valet.params import ValetParams
from modelkit.maths import sign

SLOWEST = 0.12
"""[m/s]"""
RATE_SHARE = 0.85
"""Of the wheel's rate that a ramp asks for; the rest is for tracking."""
OF_MARGIN = 0.2
"""Share of the clearance planned that a ramp may use."""
SAME = 1e-6
"""Curvatures nearer than this [1/m] are one."""


class Joint(NamedTuple):
    """The end of a piece."""

    ramp: float = 0.0
    """Way [m] over which the curvature changes there; 0: the car has to stand."""
    speed: float = 0.0
    """Largest speed [m/s] on that way."""


class Aim(NamedTuple):
    """How to drive at a place of the path."""

    curvature: float = 0.0
    """[1/m]"""
    lateral: float = 0.0
    """Beside the path, to the left [m]."""
    heading: float = 0.0
    """Off its direction, to the left [rad]."""


class Ahead(NamedTuple):
    """What the pieces ahead ask for."""

    left: float = 0.0
    """Way to the next standstill [m]."""
    speed: float = 0.0
    """Largest speed [m/s] here, that the joints behind and ahead allow."""


def joint_of(path: Path, piece: int, params: ValetParams) -> Joint:
    """Return the joint at the end of ``piece``."""
    here = path.pieces[piece]
    after = path.pieces[piece + 1 if piece + 1 < PATH else piece]
    law = params.drive
    off = min(law.rolling, OF_MARGIN * path.margin)
    if piece + 1 >= path.used or here.way * after.way <= 0.0 or off <= 0.0:
        return Joint()
    jump = abs(after.k0 - here.k0)
    shorter = min(abs(here.way), abs(after.way))
    if jump < SAME:
        return Joint(shorter, law.speed)
    ramp = min(shorter, math.sqrt(24.0 * off / jump))
    base = params.car.wheelbase
    swing = abs(math.atan(base * after.k0) - math.atan(base * here.k0))
    speed = RATE_SHARE * ramp * params.car.steering.rate_limit / (params.car.steering.ratio * swing)
    return Joint(ramp, speed) if speed >= SLOWEST else Joint()


def aim_at(path: Path, piece: int, left: float, params: ValetParams) -> Aim:
    """Return how to drive ``left`` [m] before the end of ``piece``, ramps counted."""
    here = path.pieces[piece]
    direction = sign(here.way)
    ramp = joint_of(path, piece, params).ramp
    if ramp > 0.0 and left < 0.5 * ramp:
        jump = path.pieces[piece + 1 if piece + 1 < PATH else piece].k0 - here.k0
        on = 0.5 * ramp - left
        share = on / ramp
        return Aim(here.k0 + jump * share, jump * on * on * share / 6.0, direction * 0.5 * jump * on * share)
    if piece > 0:
        before = joint_of(path, piece - 1, params).ramp
        rest = 0.5 * before - abs(here.way) + left
        if before > 0.0 and rest > 0.0:
            jump = here.k0 - path.pieces[piece - 1].k0
            share = rest / before
            beside = jump * (before * before / 24.0 - rest * rest * share / 6.0)
            return Aim(here.k0 - jump * share, beside, direction * 0.5 * jump * rest * share)
    return Aim(here.k0)


def ahead_of(path: Path, piece: int, left: float, params: ValetParams) -> Ahead:
    """Return what lies ahead of a car ``left`` [m] before the end of ``piece``."""
    law = params.drive
    speed = law.speed
    if piece > 0:
        behind = joint_of(path, piece - 1, params)
        if abs(path.pieces[piece].way) - left < 0.5 * behind.ramp:
            speed = min(speed, behind.speed)
    way = left
    for number in range(PATH - 1):
        at = piece + number
        if at < PATH - 1:
            joint = joint_of(path, at, params)
            if joint.ramp <= 0.0:
                return Ahead(way, speed)
            there = way - 0.5 * joint.ramp
            fast = math.sqrt(joint.speed * joint.speed + 2.0 * law.deceleration * (there if there > 0.0 else 0.0))
            speed = min(speed, fast)
            way = way + abs(path.pieces[at + 1].way)
    return Ahead(way, speed)
