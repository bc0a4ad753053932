"""The slot of Zhang 2022 (Fig. 2: l_c, l_k, l_w), and whether a path keeps clear of its neighbours."""

import math

from controller_fmu.common.slot_clearance import Outline, SlotBounds, is_pose_clear
from controller_fmu.zhang2022.params import ZhangSlot
from controller_fmu.zhang2022.path import QuinticPath, at
from modelkit.car import Car
from modelkit.vocabulary import Pose

PATH_SAMPLES = 80
"""Poses looked at along a path."""


def slot_bounds(slot: ZhangSlot, car: Car) -> SlotBounds:
    """Return the slot's lines, ``margin`` nearer to the path; the parked car stands ``rear_gap`` ahead of one."""
    rear = -car.rear_overhang - slot.rear_gap
    opening = 0.5 * slot.width
    return SlotBounds(
        slot.length > 0.0,
        rear + slot.length - slot.margin,
        rear + slot.margin,
        opening + slot.margin,
        opening + slot.aisle - slot.margin,
    )


def is_path_clear(path: QuinticPath, car: Outline, slot: SlotBounds) -> bool:
    """Return whether the car keeps clear on the whole path; true where the slot is unknown."""
    if not slot.known:
        return True
    for number in range(PATH_SAMPLES + 1):
        x = path.start.x * number / PATH_SAMPLES
        point = at(path, x)
        if not is_pose_clear(Pose(x, point.y, math.atan(point.slope)), car, slot):
            return False
    return True
