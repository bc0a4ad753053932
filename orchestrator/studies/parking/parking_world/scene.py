"""From factors to parameters: the scene of ``apa-world`` with rows of cars, hitches, pillars, bins and a far side.

Slots are as there: the ground truth is the free length between the neighbours, less what stands out into it.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.parking.parking_world.factors import NONE, PARKED_CARS, RACK, WALL
from orchestrator.studies.parking.world import scene as world
from orchestrator.studies.parking.world.factors import NO_SENSOR
from orchestrator.studies.sweep.study.space import Seeds

F = Mapping[str, Array]
ROWS = {"a": (5, 6, 7), "b": (8, 9, 10)}
"""Boxes of the cars beyond each neighbour."""
OVERHANG, OPPOSITE, PILLAR, BIN = 11, 12, 13, 14
NAMES = {
    **{number: "car beyond a neighbour" for numbers in ROWS.values() for number in numbers},
    OVERHANG: "hitch or rack",
    OPPOSITE: "across the road",
    PILLAR: "pillar",
    BIN: "bin",
}
HITCH_WIDTH, RACK_WIDTH = 0.08, 1.4
PILLAR_SIDE = 0.4
BIN_SIDE = 0.6
PAST, BESIDE = 12.0, 1.8
"""The driver passes the slot by so much, and half the car and some room are so wide [m]."""


def parameters(f: F, seeds: Seeds) -> dict[str, Array]:
    """Return what differs from run to run, by the names of a study's fields."""
    found = world.parameters(f, seeds)
    parallel = f["kind"] == 0
    sign = 1.0 - 2.0 * f["side"]
    slot = np.where(parallel, found["slot.length"], found["slot.width"])
    boxes = _rows(f, found, parallel, sign) | _things(f, found, slot, parallel, sign)
    for box, values in boxes.items():
        found |= {f"scene.boxes[{box}].{name}": value + 0.0 * slot for name, value in values.items()}
    return found | _silent(f, found)


def _rows(f: F, found: F, parallel: Array, sign: Array) -> dict[int, dict[str, Array]]:
    """Return the boxes of the cars beyond both neighbours."""
    boxes: dict[int, dict[str, Array]] = {}
    for which, towards in (("a", -1.0), ("b", 1.0)):
        number = 1 if which == "a" else 2
        along = np.where(parallel, f[f"length_{which}"], f[f"width_{which}"])
        across = np.where(parallel, f[f"width_{which}"], f[f"length_{which}"])
        x = found[f"scene.boxes[{number}].x"]
        for place, box in enumerate(ROWS[which]):
            x = x + towards * (along + f[f"gap_{which}"])
            there = f[f"cars_{which}"] > place
            boxes[box] = {
                "x": x,
                "y": sign * (f[f"stagger_{which}"] - 0.5 * across),
                "length": np.where(there, along, 0.0),
                "width": across,
            }
    return boxes


def _things(f: F, found: F, slot: Array, parallel: Array, sign: Array) -> dict[int, dict[str, Array]]:
    """Return the boxes of the hitch or rack, of what stands across the road, of pillar and bin."""
    boxes: dict[int, dict[str, Array]] = {}
    mouth = 0.5 * (f["stagger_a"] + f["stagger_b"])
    boxes[OVERHANG] = _overhang(f, parallel, sign)
    boxes[OPPOSITE] = {
        "x": 0.5 * slot,
        "y": sign * (np.maximum(mouth + f["street"], _passing_room(f, found, slot)) + 0.9),
        "length": np.where(f["opposite"] == NONE, 0.0, np.where(f["opposite"] == WALL, 60.0, 30.0)),
        "width": np.where(f["opposite"] == PARKED_CARS, 1.8, 1.0),
    }
    beside = np.where(f["pillar"] == 2, -0.5 * PILLAR_SIDE, slot + 0.5 * PILLAR_SIDE)
    boxes[PILLAR] = {
        "x": beside,
        "y": sign * (np.maximum(f["stagger_a"], f["stagger_b"]) - 0.5 * PILLAR_SIDE - np.where(parallel, 0.0, 0.6)),
        "length": np.where(f["pillar"] >= 2, PILLAR_SIDE, 0.0),
        "width": np.full_like(slot, PILLAR_SIDE),
    }
    boxes[BIN] = {
        "x": 0.5 * slot,
        "y": sign * (mouth - 1.0),
        "length": np.where(has_bin(f), BIN_SIDE, 0.0),
        "width": np.full_like(slot, BIN_SIDE),
    }
    return boxes


def has_bin(f: F) -> NDArray[np.bool_]:
    """Return whether a bin stands in the slot."""
    return np.asarray(f["bin"] == 9)


def overhang_of(f: F) -> Array:
    """Return by how much [m] a hitch or rack shortens the slot: beside a parallel slot it stands out into it."""
    return np.where((f["kind"] == 0) & (f["overhang"] != NONE), f["overhang_length"], 0.0)


def _passing_room(f: F, found: F, slot: Array) -> Array:
    """Return y [m] up to which the driver who passes needs the road to be free."""
    heading, start = np.radians(f["heading"]), np.abs(found["vehicle.start.y"])
    end = start + (slot + PAST - found["vehicle.start.x"]) * np.tan(heading)
    return np.asarray(np.maximum(start, end) + BESIDE)


def _overhang(f: F, parallel: Array, sign: Array) -> dict[str, Array]:
    """Return the hitch or rack at the first neighbour: into a parallel slot, or out into the road."""
    length = np.where(f["overhang"] == NONE, 0.0, f["overhang_length"])
    width = np.where(f["overhang"] == RACK, RACK_WIDTH, HITCH_WIDTH)
    into_road = f["stagger_a"] + 0.5 * f["overhang_length"]
    return {
        "x": np.where(parallel, 0.5 * f["overhang_length"], -0.5 * f["width_a"]),
        "y": sign * np.where(parallel, f["stagger_a"] - 0.5 * f["width_a"], into_road),
        "length": np.where(length > 0.0, np.where(parallel, length, width), 0.0),
        "width": np.where(parallel, width, f["overhang_length"]),
    }


def _silent(f: F, found: F) -> dict[str, Array]:
    """Return the faults of more than one sensor: those that follow the one that is drawn, around the car."""
    value = np.where(f["lost"] == NO_SENSOR, found["vehicle.car.ultrasonic.max_range"], np.nan)
    changed: dict[str, Array] = {}
    for number in range(world.SENSOR_COUNT):
        after = (number - f["lost_sensor"]) % world.SENSOR_COUNT
        lost = (f["lost"] >= NO_SENSOR) & (after <= f["lost_count"])
        changed[f"faults[{number + 1}].start"] = np.where(lost, f["lost_at"], world.NEVER_TIME)
        changed[f"faults[{number + 1}].value"] = np.where(lost, value, 0.0)
    return changed
