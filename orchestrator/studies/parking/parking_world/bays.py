"""Rows of bays with lines: cars stand in the middle of their bays, however turned; one to three between are empty.

The ground truth is the lines: the vehicle is parked in one bay, whichever, and not along the road across several.
"""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from orchestrator.evaluation.verdict.standing import in_frames, outline_margin
from orchestrator.evaluation.verdict.truth import CAR_KEYS
from orchestrator.inputs.scenario.slot_sizes import ParkingType, shortest_slot
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.parking.cases import CARS, ISO
from orchestrator.studies.parking.parking_world.factors import NO_BAYS
from orchestrator.studies.parking.world.ends import claim_limits

F = Mapping[str, Array]
MAX_BAYS = 3
POSE = ("x", "y", "heading")


def bay_count(f: F) -> Array:
    """Return how many bays are empty; 0: there are no lines."""
    return np.where(f["kind"] == 0, 0.0, np.maximum(np.asarray(f["bays"]) - NO_BAYS, 0.0))


def in_bays(f: F) -> NDArray[np.bool_]:
    """Return whether the row has bays with lines."""
    return np.asarray(bay_count(f) > 0.0)


def side_room(f: F, which: str) -> Array:
    """Return the distance [m] from neighbour ``which``'s nearest corner to the line beside it, negative beyond it."""
    turn = np.radians(f[f"turn_{which}"])
    half = 0.5 * (f[f"width_{which}"] * np.cos(turn) + f[f"length_{which}"] * np.abs(np.sin(turn)))
    return np.asarray(0.5 * np.asarray(f["bay"]) - half)


def with_bays(f: F) -> dict[str, Array]:
    """Return the factors with slot and gaps as bays make them; without a pillar, and a bin only in a single bay."""
    bays, count = in_bays(f), bay_count(f)
    length = count * f["bay"] + side_room(f, "a") + side_room(f, "b")
    shortest = np.array([shortest_slot(ParkingType.PERPENDICULAR, car, ISO) for car in CARS.values()])
    changed = {"extra": length - shortest[np.asarray(f["car"]).astype(int)], "pillar": 0.0 * length}
    changed |= {f"gap_{which}": f["bay"] - f[f"width_{which}"] for which in "ab"}
    changed["bin"] = np.where(count > 1.0, 0.0, f["bin"])
    return {**f, **{name: np.where(bays, value, f[name]) for name, value in changed.items()}}


def first_bay(f: F, found: F) -> dict[str, Array]:
    """Return target and slot of the bay beside the first neighbour, where there are bays: the others follow along x."""
    bays = in_bays(f)
    middle = side_room(f, "a") + 0.5 * f["bay"]
    upright = (1.0 - 2.0 * f["side"]) * 0.5 * math.pi
    placed = {"target.x": middle, "slot.x": middle, "target.heading": upright, "slot.heading": upright}
    placed["slot.width"] = np.asarray(f["bay"])
    return {name: np.where(bays, value, found[name]) for name, value in placed.items()}


def stands_in_a_bay(columns: Mapping[str, Array]) -> NDArray[np.bool_]:
    """Return whether each vehicle stands in one of its empty bays, within GB/T 41630; False where there are none."""
    turned, aside, out, manoeuvres = claim_limits(ParkingType.PERPENDICULAR)
    poses = np.column_stack([columns[f"final.{axis}"] for axis in POSE])
    wheelbase, front, rear, width = (np.asarray(columns[key]) for key in CAR_KEYS)
    cars = np.column_stack([wheelbase + front, rear, 0.5 * width, wheelbase])
    stands = np.full(len(poses), False)
    for bay in range(MAX_BAYS):
        shift = bay * np.asarray(columns["bay"])
        target = np.column_stack([columns[f"target.{axis}"] for axis in POSE])
        slot = np.column_stack([columns[f"slot.{name}"] for name in (*POSE, "length", "width")])
        target[:, 0] += shift
        slot[:, 0] += shift
        _, lateral, heading = in_frames(poses, target).T
        near = (np.abs(heading) <= turned) & (np.abs(lateral) <= aside) & (outline_margin(poses, slot, cars) >= -out)
        stands |= near & (bay < bay_count(columns))
    return np.asarray(stands & (np.asarray(columns["manoeuvres"]) <= manoeuvres))
