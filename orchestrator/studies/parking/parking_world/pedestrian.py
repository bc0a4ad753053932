"""Pedestrians of the study: across the road into the slot, out of it or between cars, straight on or with a turn.

A pedestrian walks where there is room, and comes from what stands across the road, not through it. He lets the driver
pass whom he would meet. After a turn a second box continues where the first ends.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.parking.parking_world.driver_pass import (
    LET_PASS,
    DriverPass,
    far_edge,
    first_time_at,
    last_time_at,
    near_edge,
)
from orchestrator.studies.parking.world.factors import NOBODY
from orchestrator.studies.parking.world.scene import (
    BETWEEN,
    FAR_SIDE,
    FROM_BEHIND,
    NEVER_TIME,
    PERSON_WIDTH,
    WALLED,
    crosses_slot,
)

F = Mapping[str, Array]
FIRST_LEG, SECOND_LEG = 4, 15
"""Boxes of a pedestrian before and after the turn."""
FORWARDS, BACKWARDS = 2, 3
"""Choices of the factor ``person_turn``: along the road with the driver, or against him."""
HALF_ROOM = 0.3
"""A pedestrian's middle keeps this far [m] from what stands still: half of the width and 5 cm."""
SECOND_LEG_LENGTH = 6.0
"""How far [m] a pedestrian goes along the road."""


class WalkingSpace(NamedTuple):
    """Where a pedestrian may walk: x beside each neighbour, the slot's length, y of its end and across the road [m]."""

    beside_a: Array
    beside_b: Array
    slot: Array
    slot_end: Array
    opposite: Array
    is_open: NDArray[np.bool_]
    """Whether the slot is free to walk through."""


def pedestrian_boxes(f: F, space: WalkingSpace, swept: DriverPass) -> dict[int, dict[str, Array]]:
    """Return the boxes of both legs, for a slot on the right."""
    place, speed = f["person_place"], f["person_speed"]
    through = crosses_slot(place)
    walks = (f["person"] >= NOBODY) & (space.is_open | ~through)
    beside = np.where(place < 0.5, space.beside_a, space.beside_b)
    x = np.where(through, np.clip(place * space.slot, HALF_ROOM, space.slot - HALF_ROOM), beside)
    walled = through & (f["behind"] == WALLED)
    outward = (f["person"] > NOBODY) & ~walled
    far = np.minimum(FAR_SIDE, space.opposite - HALF_ROOM)
    inner = np.where(through, space.slot_end + np.where(walled, HALF_ROOM, -PERSON_WIDTH), BETWEEN)
    begin = np.where(outward, np.where(through, space.slot_end - FROM_BEHIND, BETWEEN), far)
    end = np.where(outward, far, inner)
    turns = walks & (f["person_turn"] >= FORWARDS)
    corner = np.where(turns, np.minimum(f["person_turn_at"], far), end)
    at = _set_out_time(f, swept, x, begin, end)
    reached = at + np.abs(corner - begin) / speed
    along = np.where(f["person_turn"] == BACKWARDS, -speed, speed)
    person = {"width": np.full_like(x, PERSON_WIDTH)}
    first = {
        **person,
        "x": x,
        "y": begin,
        "length": np.where(walks, PERSON_WIDTH, 0.0),
        "appear_at": np.where((begin == far) & (far < FAR_SIDE), 0.0, at),
        "disappear_at": reached,
        "speed_y": speed * np.sign(end - begin),
        "moves_at": at,
    }
    second = {
        **person,
        "x": x,
        "y": corner,
        "length": np.where(turns, PERSON_WIDTH, 0.0),
        "appear_at": reached,
        "disappear_at": np.where(turns, reached + SECOND_LEG_LENGTH / speed, NEVER_TIME),
        "speed_x": along,
        "moves_at": reached,
    }
    return {FIRST_LEG: first, SECOND_LEG: second}


def _set_out_time(f: F, swept: DriverPass, x: Array, begin: Array, end: Array) -> Array:
    """Return when [s] a pedestrian sets out: as drawn, or once the driver has passed whom he would meet at ``x``."""
    low, high = x - HALF_ROOM, x + HALF_ROOM
    near, far = near_edge(swept, low, high) - HALF_ROOM, far_edge(swept, low, high) + HALF_ROOM
    inward = end < begin
    first, last = np.where(inward, far, near), np.where(inward, near, far)
    enters = f["person_at"] + np.abs(first - begin) / f["person_speed"]
    leaves = f["person_at"] + np.abs(last - begin) / f["person_speed"]
    comes = first_time_at(swept, low - swept.front)
    passed = last_time_at(swept, high + swept.rear)
    turns = f["person_turn"] >= FORWARDS
    meets = (enters < passed + LET_PASS) & ((leaves > comes - LET_PASS) | turns)
    reached = (low - swept.front < swept.end) & (high + swept.rear > swept.x)
    return np.where(meets & reached, f["person_at"] + passed + LET_PASS - enters, f["person_at"])
