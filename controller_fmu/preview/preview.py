"""What the camera sees at the first preview point: lateral error yL and heading error epsL."""

import math
from typing import NamedTuple

from controller_fmu.preview.params import PreviewParams
from controller_fmu.preview.road import ahead, lateral_offset, longitudinal_offset, road_at
from modelkit.maths import wrap_angle
from modelkit.vocabulary import Pose


class PreviewErrors(NamedTuple):
    """Errors at the preview point, positive if the road lies or turns to the left."""

    y_l: float = 0.0
    eps_l: float = 0.0


class Displacement(NamedTuple):
    """Displacement of the centre of gravity over one sample, in the car's own axes."""

    forward: float = 0.0
    left: float = 0.0
    turned: float = 0.0


def centre_of_gravity(rear: Pose, cg_to_rear: float) -> Pose:
    """Return the pose of the centre of gravity from that of the rear-axle midpoint."""
    return Pose(
        rear.x + cg_to_rear * math.cos(rear.heading),
        rear.y + cg_to_rear * math.sin(rear.heading),
        rear.heading,
    )


def motion(before: Pose, now: Pose) -> Displacement:
    """Return the displacement from ``before`` to ``now``, seen along the mean heading."""
    turned = wrap_angle(now.heading - before.heading)
    middle = before._replace(heading=before.heading + 0.5 * turned)
    return Displacement(longitudinal_offset(middle, now.x, now.y), lateral_offset(middle, now.x, now.y), turned)


def integrate_sight(sight: PreviewErrors, moved: Displacement, kappa1: float, l1: float) -> PreviewErrors:
    """Return yL and epsL one sample on by equation (2): yL' = vx epsL - vy - r L1, epsL' = vx kappa1 - r.

    The equation is not in the print; this is its standard form, true for constant L1: when L1 jumps
    by d, the road at the new point lies epsL d further aside, and (2) does not see it. Midpoint rule.
    """
    eps = sight.eps_l + moved.forward * kappa1 - moved.turned
    mean = 0.5 * (sight.eps_l + eps)
    return PreviewErrors(sight.y_l + moved.forward * mean - moved.left - moved.turned * l1, eps)


def look(road_s: float, centre: Pose, l1: float, params: PreviewParams) -> PreviewErrors:
    """Return yL and epsL measured from the pose: the road where it crosses the line L1 ahead of the car."""
    point = road_at(params.road, ahead(params.road, road_s + l1, centre, l1)).pose
    return PreviewErrors(lateral_offset(centre, point.x, point.y), wrap_angle(point.heading - centre.heading))
