"""A road that bends at the slots: what was placed beside a straight road, brought onto arcs about the slot's middle.

Arc length takes the place of x, and the distance to the row that of y. Rows in bends have no lines, and no wall or
kerb behind or across the road, which would be straight, and no pillars, which stand in garages. The driver keeps to the
bend, and nobody walks between cars.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.parking.parking_world.bays import in_bays
from orchestrator.studies.parking.parking_world.factors import FIRST_BEND, NONE
from orchestrator.studies.parking.world import scene as world
from orchestrator.studies.sweep.study.space import Seeds

F = Mapping[str, Array]


def bend_curvature(f: F) -> Array:
    """Return the curvature [1/m] of the row, left positive, for a slot on the right; 0: straight."""
    sense = np.where(f["bend"] == FIRST_BEND, -1.0, 1.0)
    return np.where((f["bend"] >= FIRST_BEND) & ~in_bays(f), sense / f["bend_radius"], 0.0)


def limit_in_bends(f: F) -> dict[str, Array]:
    """Return the factors with nothing straight along the road where that bends."""
    bends = bend_curvature(f) != 0.0
    without = {"opposite": bends, "heading": bends, "pillar": bends, "behind": bends & (np.asarray(f["kind"]) == 0)}
    without["person"] = bends & ~world.crosses_slot(f["person_place"])
    return {**f, **{name: np.where(rows, NONE, f[name]) for name, rows in without.items()}}


class Moved(NamedTuple):
    """Numbers of the boxes that a bend moves."""

    row: tuple[int, ...]
    """Cars beyond the neighbours: on the inner side so far apart that their inner ends keep their distance."""
    walkers: tuple[int, ...]
    overhang: int
    """At the first neighbour."""


class _Bend(NamedTuple):
    """Arcs about one centre; the one on which the slot's corners lie has this ``curvature`` [1/m]."""

    curvature: Array
    half: Array
    """Half of the slot along the road [m]."""

    def pose(self, owner: str, found: F, stretch: Array | float = 1.0) -> dict[str, Array]:
        """Return x, y and heading of what stood beside the straight road, ``stretch`` times as far from the slot."""
        s, y = stretch * (found[f"{owner}.x"] - self.half), found[f"{owner}.y"]
        angle = self.curvature * s
        return {
            f"{owner}.x": self.half + s * np.sinc(angle / np.pi) - y * np.sin(angle),
            f"{owner}.y": self._rise(s) - self._rise(self.half) + y * np.cos(angle),
            f"{owner}.heading": found.get(f"{owner}.heading", 0.0) + angle,
        }

    def velocity(self, owner: str, found: F) -> dict[str, Array]:
        """Return the velocity of what walked beside the straight road."""
        angle = self.curvature * (found[f"{owner}.x"] - self.half)
        x, y = (found.get(f"{owner}.speed_{axis}", 0.0) for axis in "xy")
        return {
            f"{owner}.speed_x": x * np.cos(angle) - y * np.sin(angle),
            f"{owner}.speed_y": x * np.sin(angle) + y * np.cos(angle),
        }

    def _rise(self, s: Array) -> Array:
        angle = 0.5 * self.curvature * s
        return np.asarray(s * np.sin(angle) * np.sinc(angle / np.pi))


def onto_bend(f: F, straight: F, found: F, seeds: Seeds, moved: Moved) -> dict[str, Array]:
    """Return the parameters on the bend: neighbours turned about their corners at the slot, boxes ``moved`` carried.

    ``straight``: the scene of ``apa-world``; ``found``: with all that this study adds.
    """
    curvature, parallel = bend_curvature(f), np.asarray(f["kind"]) == 0
    slot = np.where(parallel, straight["slot.length"], straight["slot.width"])
    turned, depth = dict(f), np.zeros_like(slot)
    for which, towards in (("a", -1.0), ("b", 1.0)):
        along = np.where(parallel, f[f"length_{which}"], f[f"width_{which}"])
        depth = np.maximum(depth, np.where(parallel, f[f"width_{which}"], f[f"length_{which}"]))
        turned[f"turn_{which}"] = f[f"turn_{which}"] + np.degrees(towards * 0.5 * curvature * (slot + along))
    bent = world.parameters(turned, seeds)
    owners = ("scene.boxes[1]", "scene.boxes[2]", "target", "slot")
    shifted = [f"{owner}.{axis}" for owner in owners for axis in ("x", "y", "heading")]
    result = {**found, **{name: found[name] + bent[name] - straight[name] for name in shifted}}
    result |= pose_with_car(f"scene.boxes[{moved.overhang}]", "scene.boxes[1]", found, result)
    bend = _Bend(curvature * (1.0 - 2.0 * f["side"]), 0.5 * slot)
    stretch = 1.0 / (1.0 - depth * np.maximum(-curvature, 0.0))
    for number in moved.row:
        result |= bend.pose(f"scene.boxes[{number}]", found, stretch)
    for number in moved.walkers:
        result |= bend.pose(f"scene.boxes[{number}]", found) | bend.velocity(f"scene.boxes[{number}]", found)
    result |= bend.pose("vehicle.start", found)
    to_centre = 1.0 - bend.curvature * found["vehicle.start.y"]
    return {**result, "vehicle.driver.road_curvature": bend.curvature / to_centre}


def pose_with_car(box: str, car: str, before: F, after: F) -> dict[str, Array]:
    """Return the pose of a ``box`` that moves with a ``car`` from where both are ``before``."""
    x, y = before[f"{box}.x"] - before[f"{car}.x"], before[f"{box}.y"] - before[f"{car}.y"]
    angle = after[f"{car}.heading"] - before[f"{car}.heading"]
    return {
        f"{box}.x": after[f"{car}.x"] + x * np.cos(angle) - y * np.sin(angle),
        f"{box}.y": after[f"{car}.y"] + x * np.sin(angle) + y * np.cos(angle),
        f"{box}.heading": angle,
    }
