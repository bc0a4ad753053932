"""Where the car drives if nobody turns the wheel."""

from typing import NamedTuple

from controller_fmu.apa.outline import Shape
from controller_fmu.common.curve import advance
from modelkit.vocabulary import Pose


class HeldCourse(NamedTuple):
    """The arc of the front wheels as they are."""

    pose: Pose
    """In the frame of the obstacles."""
    direction: int
    curvature: float
    """Of the front wheels as they are [1/m]."""
    speed: float
    car: Shape


def after(course: HeldCourse, way: float) -> Pose:
    """Return where the car is ``way`` [m] further on its course."""
    return advance(course.pose, float(course.direction), way, course.curvature, course.curvature)
