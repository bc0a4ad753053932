"""The way out of a parallel slot, driven in thought from the parked pose; backwards it is the way in.

At full lock, forward to the left and back to the right in turn, each as far as nothing is near, until
the arc forward leads out. What has to be driven then from the road is one reverse to the pose found.
"""

import math
from typing import NamedTuple

from controller_fmu.apa.outline import Shape, clearance, free_way
from controller_fmu.apa.slot import Site
from controller_fmu.common.curve import advance
from modelkit.vocabulary import Pose

VARIANTS = 10
RESERVE = 0.95
"""Share of the lock that the moves in the slot are thought with: the rest is for what the real ones miss."""
SHORTER = 0.03
"""They are also ended this much [m] earlier."""


class Exit(NamedTuple):
    """The pose from which the way out is free along an arc, and how many moves lie between it and parked."""

    found: bool = False
    pose: Pose = Pose()
    moves: int = 0


def exit_of(variant: int, site: Site, car: Shape) -> Exit:
    """Return the exit of this variant: 0, 1, 2 with no move in the slot (parked in its middle, a little
    back, at its rear end), 3 to 9 with 1 to 7 moves (odd: parked at the front end, even: at the rear end).
    """
    moves = variant - 2 if variant > 2 else 0
    x = site.x_high if moves % 2 == 1 else site.x_low
    x = 0.5 * variant * site.x_low if moves == 0 else x
    pose = Pose(x, 0.0, 0.0)
    if clearance(pose, car, site.obstacles, 0.0) <= 0.0:
        return Exit(False, pose, moves)
    for number in range(moves):
        left = moves - number
        direction = 1.0 if left % 2 == 0 else -1.0
        c = direction * RESERVE * car.curvature
        way = free_way(pose, direction, c, 3.0, car, site.obstacles) - SHORTER
        if way < 0.05:
            return Exit(False, pose, moves)
        pose = advance(pose, direction, way, c, c)
    out = way_out(pose, car)
    free = free_way(pose, 1.0, car.curvature, out, car, site.obstacles)
    return Exit(free >= out, pose, moves)


def way_out(pose: Pose, car: Shape) -> float:
    """Return the way [m] along the arc to the left until the rear axle has risen by 1.2 half widths, at most 78 deg."""
    c = car.curvature
    cosine = math.cos(pose.heading) - c * (1.2 * car.half_width - pose.y)
    turned = math.acos(cosine if 0.2 < cosine < 1.0 else 0.2)
    way = (turned - pose.heading) / c
    return way if way > 0.0 else 0.0
