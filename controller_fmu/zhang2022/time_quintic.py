"""A quintic over time that ends at zero, and the path y(x) of two of them: x(t), y(t), t from 0 to 1."""

from typing import NamedTuple

from controller_fmu.zhang2022.quintic import Knot


class TimeQuintic(NamedTuple):
    """p(t) = p0 + v0 t + a t^2 + c3 t^3 + c4 t^4 + c5 t^5."""

    p0: float
    v0: float
    a: float
    c3: float
    c4: float
    c5: float


class TimedValue(NamedTuple):
    """Value of a quintic at one time, and its first two derivatives."""

    p: float
    v: float
    a: float


def time_quintic(p0: float, v0: float, a0: float, v1: float, a1: float) -> TimeQuintic:
    """Return the quintic from ``p0`` to 0 with speeds and accelerations at both ends."""
    d = -p0 - v0 - 0.5 * a0
    e = v1 - v0 - a0
    f = a1 - a0
    return TimeQuintic(
        p0,
        v0,
        0.5 * a0,
        10.0 * d - 4.0 * e + 0.5 * f,
        -15.0 * d + 7.0 * e - f,
        6.0 * d - 3.0 * e + 0.5 * f,
    )


def motion_at(q: TimeQuintic, t: float) -> TimedValue:
    """Return the motion at ``t``."""
    return TimedValue(
        q.p0 + t * (q.v0 + t * (q.a + t * (q.c3 + t * (q.c4 + t * q.c5)))),
        q.v0 + t * (2.0 * q.a + t * (3.0 * q.c3 + t * (4.0 * q.c4 + t * 5.0 * q.c5))),
        2.0 * q.a + t * (6.0 * q.c3 + t * (12.0 * q.c4 + t * 20.0 * q.c5)),
    )


def knot_at(x: TimeQuintic, y: TimeQuintic, t: float) -> Knot:
    """Return the point of the path at ``t``, driven towards falling x: y' = vy / vx, y'' = (vx ay - vy ax) / vx^3."""
    along = motion_at(x, t)
    aside = motion_at(y, t)
    v = min(along.v, -1e-6)
    return Knot(along.p, aside.p, aside.v / v, (v * aside.a - aside.v * along.a) / (v * v * v))
