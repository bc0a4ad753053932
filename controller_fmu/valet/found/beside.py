"""What the side sensors of a car that stands in a slot hear: how far its neighbours, or the kerb, are."""

import math
from typing import NamedTuple

from controller_fmu.common.sensors import HEARD, sensor_at
from controller_fmu.interface import ControllerInput
from controller_fmu.planning.plan_store import SIDES, PlanStore
from controller_fmu.sensing.ear import SideEar
from controller_fmu.sensing.gap import GapLayout
from controller_fmu.sensing.heard_store import put_heard
from controller_fmu.valet.nearby import FRONT_EARS, REAR_EARS, Nearby
from controller_fmu.valet.params import ValetParams
from controller_fmu.valet.search import Search
from modelkit.vocabulary import Pose

CYCLES = 5
"""So many readings of each sensor are taken."""
SIDE_EARS = (1, 3)
"""Which of ``Nearby.ears`` are those of the sides, right and left."""
SENSORS = (REAR_EARS[1], FRONT_EARS[1], REAR_EARS[3], FRONT_EARS[3])
"""Rear and front one, right then left."""
KERB_STEPS = 10
"""A kerb goes on between what both of a side hear: in so many steps, places of one thing."""


class Beside(NamedTuple):
    """Readings of ``SENSORS`` added up [m], how many of them heard something, and of how many cycles."""

    sums: tuple[float, ...] = (0.0,) * 4
    heard: tuple[int, ...] = (0,) * 4
    cycles: int = 0


def hear_beside(state: Beside, inputs: ControllerInput, params: ValetParams) -> Beside:
    """Return what was heard beside a standing car with the readings of one more cycle."""
    far = HEARD * params.car.ultrasonic.max_range
    readings = tuple(inputs.ultrasonic[sensor] for sensor in SENSORS)
    sums = tuple(state.sums[n] + (readings[n] if readings[n] < far else 0.0) for n in range(4))
    heard = tuple(state.heard[n] + (1 if readings[n] < far else 0) for n in range(4))
    return Beside(sums, heard, state.cycles + 1)


def put_beside(
    store: PlanStore, nearby: Nearby, beside: Beside, pose: Pose, sought: Search, params: ValetParams
) -> Nearby:
    """Return the ears with what stands beside a car at ``pose``: two places a side, along the road a kerb's line."""
    ears = nearby.ears
    along = sought.gap.layout == GapLayout.ALONG
    for side in range(2):
        if beside.heard[2 * side] > 0 and beside.heard[2 * side + 1] > 0 and (not along or side == sought.side):
            rear = _echo(beside, 2 * side, pose, params)
            front = _echo(beside, 2 * side + 1, pose, params)
            which = SIDE_EARS[side]
            for number in range(4):
                if number == which:
                    ear = _with_line(store, ears[number], number, rear, front, KERB_STEPS if along else 1)
                    ears = ears[:number] + (ear,) + ears[number + 1 :]
    return nearby._replace(ears=ears)


def _echo(beside: Beside, number: int, pose: Pose, params: ValetParams) -> Pose:
    """Return where a sensor's echoes came from, if straight ahead of it."""
    at = sensor_at(params.car.ultrasonic.mounts[SENSORS[number]], pose)
    reading = beside.sums[number] / max(beside.heard[number], 1)
    return Pose(at.x + reading * math.cos(at.heading), at.y + reading * math.sin(at.heading), at.heading)


def _with_line(store: PlanStore, ear: SideEar, number: int, rear: Pose, front: Pose, steps: int) -> SideEar:
    """Return an ear with the places from one to another; each is certain, as if heard twice."""
    places = ear.places
    for step in range(KERB_STEPS + 1):
        if step <= steps:
            x = rear.x + step / steps * (front.x - rear.x)
            y = rear.y + step / steps * (front.y - rear.y)
            places = put_heard(store, SIDES + number, places, x, y, step == 0)
            places = put_heard(store, SIDES + number, places, x, y, False)
    return ear._replace(places=places)
