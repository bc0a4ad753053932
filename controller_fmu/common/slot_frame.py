"""The slot's frame: origin at the target pose, x along the parked direction, start pose at y >= 0.

The laws are written for a slot on the right-hand side. A left-hand slot is their mirror image:
y, headings and steering angles change sign.
"""

import math
from typing import NamedTuple

from modelkit.maths import wrap_angle
from modelkit.vocabulary import Pose


class SlotFrame(NamedTuple):
    """Where the slot's frame lies in the world."""

    target: Pose = Pose()
    mirror: float = 1.0
    """1 for a slot on the right-hand side, -1 on the left."""


def frame_at(target: Pose, start: Pose) -> SlotFrame:
    """Return the frame of a slot at ``target``, on the side on which it is seen from ``start`` (world poses)."""
    right = SlotFrame(target)
    return right if to_slot(start, right).y >= 0.0 else SlotFrame(target, -1.0)


def to_slot(pose: Pose, frame: SlotFrame) -> Pose:
    """Return a world pose in the slot's frame, heading in (-pi, pi]."""
    c = math.cos(frame.target.heading)
    s = math.sin(frame.target.heading)
    dx = pose.x - frame.target.x
    dy = pose.y - frame.target.y
    return Pose(
        dx * c + dy * s,
        frame.mirror * (dy * c - dx * s),
        frame.mirror * wrap_angle(pose.heading - frame.target.heading),
    )


def to_world(pose: Pose, frame: SlotFrame) -> Pose:
    """Return a pose of the slot's frame in the world, heading in (-pi, pi]."""
    c = math.cos(frame.target.heading)
    s = math.sin(frame.target.heading)
    y = frame.mirror * pose.y
    return Pose(
        frame.target.x + pose.x * c - y * s,
        frame.target.y + pose.x * s + y * c,
        wrap_angle(frame.target.heading + frame.mirror * pose.heading),
    )
