"""What the side sensors of a car that stands in a slot hear: how far its neighbours, or the kerb, are."""

import math
from typing import NamedTuple

from controller_fmu.common.sensors import VALID_RANGE_FRACTION, sensor_at
from controller_fmu.planning.plan_store import SIDES, PlanStore
from controller_fmu.sensing.ear import SideEar
from controller_fmu.sensing.gap import GapLayout
from controller_fmu.sensing.heard_store import put_heard
from controller_fmu.valet.found.nearby import FRONT_EARS, REAR_EARS, Nearby, is_in_gap
from controller_fmu.valet.found.search import Search
from controller_fmu.valet.params import ValetParams
from controller_fmu.valet.signals import ValetInput
from modelkit.geometry import Point
from modelkit.vocabulary import Pose

CYCLES = 5
"""So many readings of each sensor are taken."""
SIDE_EARS = (1, 3)
"""Which of ``Nearby.ears`` are those of the sides, right and left."""
SENSORS = (REAR_EARS[1], FRONT_EARS[1], REAR_EARS[3], FRONT_EARS[3])
"""Rear and front one, right then left."""
KERB_STEPS = 10
"""A kerb goes on between what both of a side hear: in so many steps, places of one thing."""

PART = 0.15
"""What one sensor hears of a neighbour is seen over so much [m] to either side of its axis."""


class SideEchoes(NamedTuple):
    """Readings of ``SENSORS`` added up [m], how many of them heard something, and of how many cycles."""

    sums: tuple[float, ...] = (0.0,) * 4
    heard: tuple[int, ...] = (0,) * 4
    cycles: int = 0


def hear_beside(state: SideEchoes, inputs: ValetInput, params: ValetParams) -> SideEchoes:
    """Return what was heard beside a standing car with the readings of one more cycle."""
    far = VALID_RANGE_FRACTION * params.car.ultrasonic.max_range
    readings = tuple(inputs.ultrasonic[sensor] for sensor in SENSORS)
    sums = tuple(state.sums[n] + (readings[n] if readings[n] < far else 0.0) for n in range(4))
    heard = tuple(state.heard[n] + (1 if readings[n] < far else 0) for n in range(4))
    return SideEchoes(sums, heard, state.cycles + 1)


def put_beside(
    store: PlanStore, nearby: Nearby, beside: SideEchoes, pose: Pose, sought: Search, params: ValetParams
) -> Nearby:
    """Return the ears with what stands beside a car at ``pose``: along the road the kerb.

    Across it what is nearer than a slot's sides were thought to be: a sensor that hears nothing so near may miss it.
    """
    ears = nearby.ears
    along = sought.gap.layout == GapLayout.ALONG
    for side in range(2):
        rear = 2 * side
        front = 2 * side + 1
        both = beside.heard[rear] > 0 and beside.heard[front] > 0
        for number in range(4):
            if number == SIDE_EARS[side]:
                ear = ears[number]
                if along and both and side == sought.side:
                    ends = (echo_at(beside, rear, 0.0, pose, params), echo_at(beside, front, 0.0, pose, params))
                    ear = _with_line(store, ear, number, ends, KERB_STEPS)
                for which in (rear, front):
                    at = echo_at(beside, which, 0.0, pose, params)
                    if not along and beside.heard[which] > 0 and is_in_gap(at.x, at.y, sought.gap):
                        ends = (
                            echo_at(beside, which, -PART, pose, params),
                            echo_at(beside, which, PART, pose, params),
                        )
                        ear = _with_line(store, ear, number, ends, 1)
                ears = ears[:number] + (ear,) + ears[number + 1 :]
    return nearby._replace(ears=ears)


def echo_at(beside: SideEchoes, number: int, on: float, pose: Pose, params: ValetParams) -> Point:
    """Return where a sensor's echoes came from, straight ahead of it, or so far [m] on along the car."""
    at = sensor_at(params.car.ultrasonic.mounts[SENSORS[number]], pose)
    reading = beside.sums[number] / max(beside.heard[number], 1)
    x = at.x + reading * math.cos(at.heading) + on * math.cos(pose.heading)
    return Point(x, at.y + reading * math.sin(at.heading) + on * math.sin(pose.heading))


def _with_line(store: PlanStore, ear: SideEar, number: int, ends: tuple[Point, Point], steps: int) -> SideEar:
    """Return an ear with the places from one end to another; each is certain, as if heard twice."""
    places = ear.places
    for step in range(KERB_STEPS + 1):
        if step <= steps:
            x = ends[0].x + step / steps * (ends[1].x - ends[0].x)
            y = ends[0].y + step / steps * (ends[1].y - ends[0].y)
            places = put_heard(store, SIDES + number, places, x, y, step == 0)
            places = put_heard(store, SIDES + number, places, x, y, False)
    return ear._replace(places=places)
