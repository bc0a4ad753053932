"""Chains of echoes: what a sensor measured of one body in a row, as far as ranges can tell bodies apart.

The range to a body at rest changes by at most sin(cone) per metre that the sensor moves across its axis; an echo that
differs by more comes from another body. A chain that ends in a farther echo, or in none, has passed the body's edge;
one that ends in a nearer echo was only hidden.
"""

import math
from enum import IntEnum
from typing import NamedTuple

from controller_fmu.parking.geometry.frames import planar_distance
from controller_fmu.parking.measurement.sensor import SensorPose

MAX_ECHOES = 96
"""Echoes of a chain; a longer one keeps every second of them and goes on at twice the spacing."""
ECHO_SPACING = 0.04
"""Least distance [m] between the sensor positions of two echoes."""
MAX_SLOPE = 0.7
"""Change of range per metre: sine of the widest half cone, and of a sensor that looks aside (34 + 8 deg)."""
SLOPE_ECHOES = 4
"""So many echoes back the slope is looked at: 0.16 m at 1 m/s, over which a face at the boundary falls by 0.3 m."""
JUMP_SIGMA = 5.0
"""Standard deviations of the difference of two echoes that noise may explain."""
LOST_DISTANCE = 0.25
"""Without an echo over this [m] and ``LOST_ECHOES`` cycles the edge is passed."""
LOST_ECHOES = 3
MAX_EDGE_RANGE = 4.5
"""A side whose outermost echo is farther [m] may go on beyond the range of the sensor."""
MAX_TURN_COS = 0.95
"""A chain ends when the sensor's axis has turned by 18 deg: it measures another side."""


class Ending(IntEnum):
    """How the echoes of a body go on beyond an end of what has been measured of it."""

    CONTINUES = 0
    """Without a jump: by echoes that may be of it, too."""
    EDGE = 1
    """To a farther echo, or to none: the body ends."""
    HIDDEN = 2
    """To a nearer echo, of a body that may hide more of it; or it is not known."""


class ChainEcho(NamedTuple):
    """Where the sensor was, and the range [m]; the unit vector of its axis."""

    x: float = 0.0
    y: float = 0.0
    range: float = 0.0
    axis_x: float = 1.0
    axis_y: float = 0.0


class EchoChain(NamedTuple):
    """Echoes in a row, oldest first; the first ``used`` are valid."""

    used: int = 0
    echoes: tuple[ChainEcho, ...] = (ChainEcho(),) * MAX_ECHOES
    spacing: float = ECHO_SPACING
    begins_at_edge: bool = False
    """Before its first echo there was a farther one, or none."""
    lost: int = 0
    """Cycles without an echo since the last."""
    landmark: int = -1
    """The landmark that it has made; -1: none."""
    fitted: int = 0
    """Echoes at the last fit."""


def continues(chain: EchoChain, sensor: SensorPose, measured: float, variance: float) -> bool:
    """Return whether an echo at ``measured`` [m], of ``variance`` [m2], can come from the body of the chain.

    The last ``SLOPE_ECHOES`` echoes are compared: on a slow pass the range at the cone's boundary changes too much per
    metre, but from one echo to the next by less than the noise.
    """
    first = chain.echoes[0]
    if sensor.axis_x * first.axis_x + sensor.axis_y * first.axis_y <= MAX_TURN_COS:
        return False
    for back in range(1, min(SLOPE_ECHOES, chain.used) + 1):
        before = chain.echoes[chain.used - back]
        step = planar_distance(sensor.x, sensor.y, before.x, before.y)
        jump = abs(measured - before.range) - MAX_SLOPE * step
        if jump >= JUMP_SIGMA * math.sqrt(2.0 * variance):
            return False
    return True


def is_turned_back(chain: EchoChain, sensor: SensorPose) -> bool:
    """Return whether the sensor moves back along the chain: it drives the other way now."""
    if chain.used < 2:
        return False
    last = chain.echoes[chain.used - 1]
    first = chain.echoes[0]
    dx = sensor.x - last.x
    dy = sensor.y - last.y
    back = dx * (last.x - first.x) + dy * (last.y - first.y)
    return back < 0.0 and dx * dx + dy * dy > chain.spacing * chain.spacing


def is_passed(chain: EchoChain, sensor: SensorPose) -> bool:
    """Return whether a sensor that measures no echo any more has passed the chain's body."""
    last = chain.echoes[max(chain.used - 1, 0)]
    return chain.lost >= LOST_ECHOES and planar_distance(sensor.x, sensor.y, last.x, last.y) > LOST_DISTANCE


def begin_chain(sensor: SensorPose, measured: float, begins_at_edge: bool) -> EchoChain:
    """Return a chain of one echo at ``measured`` [m]; ``begins_at_edge``: before it was a farther echo, or none."""
    first = ChainEcho(sensor.x, sensor.y, measured, sensor.axis_x, sensor.axis_y)
    return EchoChain(used=1, echoes=(first,) * MAX_ECHOES, begins_at_edge=begins_at_edge)


def append_echo(chain: EchoChain, sensor: SensorPose, measured: float) -> EchoChain:
    """Return the chain with an echo at ``measured`` [m], if the sensor has moved; a full one keeps every second."""
    last = chain.echoes[max(chain.used - 1, 0)]
    chain = chain._replace(lost=0)
    if planar_distance(sensor.x, sensor.y, last.x, last.y) < chain.spacing:
        return chain
    if chain.used >= MAX_ECHOES:
        echoes = tuple(chain.echoes[min(2 * number, MAX_ECHOES - 1)] for number in range(MAX_ECHOES))
        chain = chain._replace(used=MAX_ECHOES // 2, echoes=echoes, fitted=chain.fitted // 2)
        chain = chain._replace(spacing=2.0 * chain.spacing)
    echo = ChainEcho(sensor.x, sensor.y, measured, sensor.axis_x, sensor.axis_y)
    at = min(max(chain.used, 0), MAX_ECHOES - 1)
    return chain._replace(used=at + 1, echoes=chain.echoes[:at] + (echo,) + chain.echoes[at + 1 :])


def without_echoes_before(chain: EchoChain, first: int) -> EchoChain:
    """Return the chain without the echoes before ``first``: they were of another body, beyond an edge."""
    echoes = tuple(chain.echoes[min(number + first, MAX_ECHOES - 1)] for number in range(MAX_ECHOES))
    return chain._replace(used=chain.used - first, echoes=echoes, begins_at_edge=True, landmark=-1, fitted=0)
