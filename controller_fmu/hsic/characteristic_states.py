"""The 12 characteristic states, recognised from the errors to the current key point and their rates."""

import math
from enum import IntEnum
from typing import NamedTuple

from controller_fmu.hsic.params import HsicThresholds
from modelkit.vocabulary import Pose


class HsicStage(IntEnum):
    """Which way is being driven."""

    READY = 0
    """To the ready point P1."""
    TURN_IN = 1
    """P1 to P2: towards the slot."""
    TANGENT = 2
    """P2 to P3: along the common tangent."""
    COUNTER = 3
    """P3 to P4: counter-steer."""
    SHUFFLE = 4
    """Forward and back inside the slot."""


class Characteristic(IntEnum):
    """What an experienced driver would call the situation, in the paper's order and numbering."""

    NONE = 0
    READY_AWAY = 1
    READY_TURNED = 2
    READY_FAR = 3
    READY_NEAR = 4
    SLOT_AWAY = 5
    SLOT_TURNED = 6
    SLOT_FAR = 7
    SLOT_NEAR = 8
    SHUFFLE_AWAY = 9
    SHUFFLE_TURNED = 10
    SHUFFLE_FAR = 11
    SHUFFLE_NEAR = 12


STANDSTILL_SPEED = 0.005
"""Below this speed [m/s] the car stands."""
GROUP_OF_STAGE = (0, 1, 1, 1, 2)
"""Ready point, slot, in-slot shuffle: one for each HsicStage, in its order."""


class Errors(NamedTuple):
    """Errors to the key point: along and across its heading, heading, and the rate of the distance."""

    ahead: float
    """How far the car stands ahead of the key point [m]."""
    lateral: float
    """How far it stands to the left of the key point's axis [m]."""
    heading: float
    """Heading of the car minus heading of the key point [rad]."""
    distance: float
    """To the key point [m]."""
    rate: float
    """Rate of the distance [m/s]; at standstill its sign is that of the direction last driven."""


def errors(pose: Pose, key: Pose, speed: float, direction: int) -> Errors:
    """Return the errors of ``pose`` to the key point, driven at ``speed`` [m/s], signed."""
    c = math.cos(key.heading)
    s = math.sin(key.heading)
    dx = pose.x - key.x
    dy = pose.y - key.y
    ahead = dx * c + dy * s
    way = speed if abs(speed) > STANDSTILL_SPEED else STANDSTILL_SPEED * direction
    turned = pose.heading - key.heading
    along = way * math.cos(turned)
    return Errors(ahead, dy * c - dx * s, turned, math.sqrt(dx * dx + dy * dy), along if ahead >= 0.0 else -along)


def recognise(stage: int, found: Errors, threshold: HsicThresholds) -> int:
    """Return the Characteristic: the stage's group of four, then away, turned, far or near."""
    base = 4 * GROUP_OF_STAGE[stage] + 1
    if found.rate > 0.0:
        return base
    if abs(found.heading) > threshold.aligned:
        return base + 1
    if found.distance > threshold.near:
        return base + 2
    return base + 3
