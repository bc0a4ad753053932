"""Curves in reverse onto the x axis, closed or from one root: what every route is made of.

A clothoid of length w from curvature k to 0 leaves a circle of radius R = 1/k as if the circle touched the line
further out: effective radius rho = R + p, touched a way t before the clothoid ends; it turns by w k / 2. Two circles
that leave each other by clothoids are joined by a line as two circles of radius rho are, the line shorter by both t.
With C1 and C2 the centres, D = C1 - C2, the line between is l = sqrt(|D|^2 - (rho1 + rho2)^2) and its heading
h1 = atan2(Dy, Dx) - atan2(-(rho1 + rho2), l): Guo 2015's two arcs, with radii of their own and the wheel's swing.

All poses here have the target at the origin, x ahead; curves turn right, then left; others are their mirror image.
"""

import math
from typing import NamedTuple

from controller_fmu.adaptive.route import MAX_PIECES, Piece, Route
from controller_fmu.common.curve import advance
from modelkit.vocabulary import Pose

MAX_HEADING = 80.0 * math.pi / 180.0
NO_PIECE = Piece()
NO_ROUTE = Route()
BISECTION_STEPS = 24
LARGEST_RADIUS = 200.0


class SteeringLimits(NamedTuple):
    """What the steering can do, as planned with."""

    wheelbase: float
    rate: float
    """Of the front wheels [rad/s]."""
    radius: float
    """Smallest planned [m]."""


class Bend(NamedTuple):
    """A circle that is left or entered by a clothoid."""

    radius: float
    ramp: float
    """Length of the clothoid [m]; 0: the wheel turns at standstill."""
    angle: float
    """Turned on the clothoid [rad]."""
    rho: float
    """Effective radius [m]."""
    tangent: float
    """From the effective circle's touching point to the end of the clothoid [m]."""


def bend_of(radius: float, ramp: float) -> Bend:
    """Return the bend of ``radius`` [m] with a clothoid of length ``ramp`` [m]."""
    if ramp <= 0.0:
        return Bend(radius, 0.0, 0.0, radius, 0.0)
    end = advance(Pose(0.0, 0.0, 0.0), 1.0, ramp, 0.0, 1.0 / radius)
    rho = end.y + radius * math.cos(end.heading)
    return Bend(radius, ramp, end.heading, rho, end.x - radius * math.sin(end.heading))


def swing_distance(speed: float, radius: float, wheel: SteeringLimits) -> float:
    """Return the way [m] driven at ``speed`` [m/s] while the wheel swings from straight to ``radius`` [m]."""
    return speed * math.atan(wheel.wheelbase / radius) / wheel.rate


def s_curve(start: Pose, lead: float, first: Bend, second: Bend, rest: float) -> Route:
    """Return the route: a line, clothoid, right arc, clothoid, line, clothoid, left arc, clothoid, line.

    The first line is ``lead`` [m] long, the last one ``rest``. Without a first line the right arc begins at once: the
    wheel turns at standstill. No direction: there is none.
    """
    enter = first.ramp if lead > 0.0 else 0.0
    k1 = -1.0 / first.radius
    k2 = 1.0 / second.radius
    gone = advance(start, -1.0, lead, 0.0, 0.0)
    on_arc = advance(gone, -1.0, enter, 0.0, k1) if enter > 0.0 else gone
    dx = on_arc.x + first.radius * math.sin(on_arc.heading) - (rest + second.tangent)
    dy = on_arc.y - first.radius * math.cos(on_arc.heading) - second.rho
    both = first.rho + second.rho
    squared = dx * dx + dy * dy - both * both
    if squared < 0.0:
        return NO_ROUTE
    between = math.sqrt(squared)
    h1 = math.atan2(dy, dx) - math.atan2(-both, between)
    line = between - first.tangent - second.tangent
    arc1 = h1 - first.angle - on_arc.heading
    arc2 = h1 - second.angle - second.angle
    if line < 0.0 or arc1 < 0.0 or arc2 < 0.0 or h1 > MAX_HEADING:
        return NO_ROUTE
    pieces = (
        Piece(lead, 0.0, 0.0),
        Piece(enter, 0.0, k1),
        Piece(arc1 * first.radius, k1, k1),
        Piece(first.ramp, k1, 0.0),
        Piece(line, 0.0, 0.0),
        Piece(second.ramp, 0.0, k2),
        Piece(arc2 * second.radius, k2, k2),
        Piece(second.ramp, k2, 0.0),
        Piece(rest, 0.0, 0.0),
    )
    return Route(start, -1, pieces)


def arc_in(start: Pose, speed: float, wheel: SteeringLimits, rest: float) -> Route:
    """Return the route: left arc, clothoid, line of at least ``rest`` [m] to the target, the radius as it fits."""
    h = start.heading
    none = NO_ROUTE
    if h <= 0.0 or h > MAX_HEADING or _above(start, wheel.radius, speed, wheel) < 0.0:
        return none
    if _above(start, LARGEST_RADIUS, speed, wheel) > 0.0:
        return none
    low = wheel.radius
    high = LARGEST_RADIUS
    for _ in range(BISECTION_STEPS):
        middle = 0.5 * (low + high)
        if _above(start, middle, speed, wheel) >= 0.0:
            low = middle
        else:
            high = middle
    bend = bend_of(low, swing_distance(speed, low, wheel))
    arc = h - bend.angle
    left = start.x - low * math.sin(h) - bend.tangent
    if arc < 0.0 or left < rest:
        return none
    k = 1.0 / low
    return _route(start, Piece(arc * low, k, k), Piece(bend.ramp, k, 0.0), Piece(left, 0.0, 0.0), NO_PIECE, NO_PIECE)


def _above(start: Pose, radius: float, speed: float, wheel: SteeringLimits) -> float:
    """Return how far [m] above the axis a left arc of ``radius`` and its clothoid end."""
    return start.y + radius * math.cos(start.heading) - bend_of(radius, swing_distance(speed, radius, wheel)).rho


def line_in(start: Pose, bend: Bend, rest: float) -> Route:
    """Return the route: line, clothoid, left arc, clothoid, line of at least ``rest`` [m] to the target."""
    h = start.heading
    if h < 2.0 * bend.angle or h <= 0.0 or h > MAX_HEADING or start.y <= 0.0:
        return NO_ROUTE
    crossing = start.y / math.sin(h)
    needed = bend.tangent + bend.rho * math.tan(0.5 * h)
    first = crossing - needed
    left = start.x - crossing * math.cos(h) - needed
    if first < 0.0 or left < rest:
        return NO_ROUTE
    k = 1.0 / bend.radius
    arc = Piece((h - 2.0 * bend.angle) * bend.radius, k, k)
    return _route(
        start, Piece(first, 0.0, 0.0), Piece(bend.ramp, 0.0, k), arc, Piece(bend.ramp, k, 0.0), Piece(left, 0.0, 0.0)
    )


def straight(start: Pose, direction: int, length: float) -> Route:
    """Return a straight route of ``length`` [m]."""
    return Route(start, direction, (Piece(length, 0.0, 0.0),) + (NO_PIECE,) * (MAX_PIECES - 1))


def arc(start: Pose, direction: int, length: float, curvature: float) -> Route:
    """Return an arc of ``length`` [m]."""
    return Route(start, direction, (Piece(length, curvature, curvature),) + (NO_PIECE,) * (MAX_PIECES - 1))


def _route(start: Pose, a: Piece, b: Piece, c: Piece, d: Piece, e: Piece) -> Route:
    return Route(start, -1, (a, b, c, d, e) + (NO_PIECE,) * (MAX_PIECES - 5))
