"""Rows of cars at an angle to the road: a perpendicular row turned, each car slid along itself to the edge of the road.

So the slot keeps its width, and the cars stand out into the road as far as before. The vehicle parks rear end first
where the row opens to one who reverses, and front end first, by the driver's choice, where it opens to one who passes.
Angled rows have no lines, no bend, no pillars, and nothing straight behind them; the driver passes along the road, and
nobody walks between the cars.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controller_fmu.common.external_slot import SlotKind
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.parking.parking_world.bays import in_bays
from orchestrator.studies.parking.parking_world.bend import pose_with_car
from orchestrator.studies.parking.parking_world.factors import FIRST_ANGLED, FIRST_BEND, NONE

F = Mapping[str, Array]
WANTED = "controller.slot.wanted"


def is_angled(f: F) -> NDArray[np.bool_]:
    """Return whether the row stands at an angle to the road."""
    return np.asarray((f["kind"] == 1) & (f["angled"] >= FIRST_ANGLED) & (f["bend"] < FIRST_BEND) & ~in_bays(f))


def limit_in_angled_rows(f: F) -> dict[str, Array]:
    """Return the factors with nothing that crosses an angled row or ends it."""
    names = ("heading", "behind", "pillar", "person")
    return {**f, **{name: np.where(is_angled(f), NONE, f[name]) for name in names}}


class Turned(NamedTuple):
    """Numbers of the boxes that an angle turns."""

    cars: tuple[int, ...]
    """The neighbours, and the cars beyond them."""
    overhang: int
    """At the first of them."""
    bin: int
    """In the slot."""


def onto_angle(f: F, found: F, turned: Turned) -> dict[str, Array]:
    """Return the parameters of the straight scene ``found`` with row, slot and target at their angle."""
    angled, is_nose_in = is_angled(f), f["angled"] == FIRST_ANGLED
    row = _AngledRow(
        np.where(angled, np.radians(np.where(is_nose_in, f["lean"], -f["lean"])), 0.0),
        1.0 - 2.0 * f["side"],
        0.5 * np.asarray(found["slot.width"]),
    )
    result = dict(found)
    for number in turned.cars:
        box = f"scene.boxes[{number}]"
        result |= row.slid(box, found, found[f"{box}.length"], found[f"{box}.width"])
        result |= row.velocity(box, found)
    first = f"scene.boxes[{turned.cars[0]}]"
    result |= pose_with_car(f"scene.boxes[{turned.overhang}]", first, found, result)
    result |= row.velocity(f"scene.boxes[{turned.overhang}]", found)
    result |= _standing(found, row, turned.bin)
    front_first = angled & is_nose_in
    result |= _front_first(result, front_first)
    chosen = {name: np.where(angled, value, found.get(name, 0.0 * row.angle)) for name, value in result.items()}
    return {**chosen, WANTED: np.where(front_first, float(SlotKind.NOSE_IN), float(SlotKind.NONE))}


class _AngledRow(NamedTuple):
    angle: Array
    """By which the row is turned, for a slot on the right [rad]."""
    sign: Array
    """1 for a slot on the right, -1 for its mirror image."""
    middle: Array
    """x of the slot's middle [m]."""

    def slid(self, owner: str, found: F, along: Array, across: Array) -> dict[str, Array]:
        """Return the pose of a rectangle whose outermost corner stays as far out, and which keeps its place in the row.

        ``along``, ``across``: its lengths along and across the road before it is turned [m].
        """
        before = self.sign * found.get(f"{owner}.heading", 0.0)
        outer = self.sign * found[f"{owner}.y"] + _reach(before, along, across)
        y = outer - _reach(before + self.angle, along, across)
        x = self.middle + (found[f"{owner}.x"] - self.middle - y * np.sin(self.angle)) / np.cos(self.angle)
        return {f"{owner}.x": x, f"{owner}.y": self.sign * y, f"{owner}.heading": self.sign * (before + self.angle)}

    def velocity(self, owner: str, found: F) -> dict[str, Array]:
        """Return the velocity of what moves with the row."""
        x, y = (found.get(f"{owner}.speed_{axis}", 0.0) for axis in "xy")
        c, s = np.cos(self.angle), self.sign * np.sin(self.angle)
        return {f"{owner}.speed_x": c * x - s * y, f"{owner}.speed_y": s * x + c * y}


def _reach(heading: Array, along: Array, across: Array) -> Array:
    return np.asarray(0.5 * (across * np.cos(heading) + along * np.abs(np.sin(heading))))


def _standing(found: F, row: _AngledRow, bin_number: int) -> dict[str, Array]:
    """Return target, slot and bin, carried with the vehicle as it stands flush with the neighbours."""
    heading = found["target.heading"]
    middle = 0.5 * _ahead(found)
    vehicle = {
        "vehicle.x": found["target.x"] + middle * np.cos(heading),
        "vehicle.y": found["target.y"] + middle * np.sin(heading),
        "vehicle.heading": heading - row.sign * 0.5 * np.pi,
    }
    length = 2.0 * (middle + found["vehicle.car.rear_overhang"])
    after = row.slid("vehicle", vehicle, found["vehicle.car.width"], length)
    before, bin_box = {**found, **vehicle}, f"scene.boxes[{bin_number}]"
    result: dict[str, Array] = {}
    for owner in ("target", "slot", bin_box):
        result |= pose_with_car(owner, "vehicle", before, after)
        result[f"{owner}.heading"] = found.get(f"{owner}.heading", 0.0) + row.sign * row.angle
    return result


def _front_first(found: F, chosen: NDArray[np.bool_]) -> dict[str, Array]:
    """Return the target turned about the vehicle's middle where it parks front end first."""
    heading, middle = found["target.heading"], _ahead(found)
    return {
        "target.x": found["target.x"] + np.where(chosen, middle * np.cos(heading), 0.0),
        "target.y": found["target.y"] + np.where(chosen, middle * np.sin(heading), 0.0),
        "target.heading": heading + np.where(chosen, np.pi, 0.0),
    }


def _ahead(found: F) -> Array:
    """Return twice the distance from the rear axle to the vehicle's middle [m]."""
    ahead = found["vehicle.car.wheelbase"] + found["vehicle.car.front_overhang"] - found["vehicle.car.rear_overhang"]
    return np.asarray(ahead)
