"""What is true in runs, as arrays with a row for each: targets, slots, kerbs, cars."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from orchestrator.evaluation.verdict.geometry import CarOutline, Kerb, kerbs
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.simulation.cosim.fmu_instance import Array

ALONG = math.cos(math.radians(45.0))
AT_THE_SLOT = 0.5
"""A kerb is the slot's if it runs along it, at most 45 deg off, and passes its side within this distance [m]."""
NONE = math.nan
CAR_KEYS = tuple(f"vehicle.car.{name}" for name in ("wheelbase", "front_overhang", "rear_overhang", "width"))
TRUE_KEYS = ("target.", "slot.", "vehicle.scene.kerbs[", *CAR_KEYS)
"""Names of what can differ from run to run of a study and is part of the truth."""


Bools = NDArray[np.bool_]


class GroundTruth(NamedTuple):
    """Numbers [m, rad] of runs, NaN for what a scenario does not have."""

    targets: Array
    """(n, 3) x, y, heading."""
    slots: Array
    """(n, 5) x, y, heading of the middle, length, width."""
    kerbs: Array
    """(n, k, 4) x1, y1, x2, y2 of the kerbs that bound the slot."""
    cars: Array
    """(n, 4) front, rear, half width, wheelbase."""

    def repeat(self, count: int) -> "GroundTruth":
        """Return the truth of ``count`` runs in which all is as in this one."""
        return GroundTruth(*(np.repeat(part, count, axis=0) for part in self))

    def select(self, rows: NDArray[np.int64]) -> "GroundTruth":
        """Return the truth of the runs ``rows``."""
        return GroundTruth(*(part[rows] for part in self))

    def has(self) -> dict[str, Bools]:
        """Return for each run whether its scenario has a target, a slot, a kerb at the slot."""
        return {
            "target": np.isfinite(self.targets).all(axis=1),
            "slot": np.isfinite(self.slots).all(axis=1),
            "kerb": np.any(np.isfinite(self.kerbs).all(axis=2), axis=1),
        }


def truth_of(scenario: Scenario, vehicle: Mapping[str, float]) -> GroundTruth:
    """Return the truth of one run, whose car has the parameters ``vehicle``."""
    target = scenario.target.pose if scenario.target is not None else (NONE,) * 3
    slot = tuple(scenario.slot.model_dump().values()) if scenario.slot is not None else (NONE,) * 5
    car = CarOutline.of(vehicle)
    beside = [(kerb.x1, kerb.y1, kerb.x2, kerb.y2) for kerb in _at_the_slot(scenario, car, kerbs(vehicle))]
    return GroundTruth(np.array([target]), np.array([slot]), np.array(beside).reshape(1, -1, 4), np.array([car]))


def join_truths(parts: list[GroundTruth]) -> GroundTruth:
    """Return the truths of several runs as one."""
    most = max((part.kerbs.shape[1] for part in parts), default=0)
    missing = [((0, 0), (0, most - part.kerbs.shape[1]), (0, 0)) for part in parts]
    lanes = [np.pad(part.kerbs, room, constant_values=NONE) for part, room in zip(parts, missing, strict=True)]
    columns = zip(*((part.targets, part.slots, part.cars) for part in parts), strict=True)
    targets, slots, cars = (np.concatenate(column) for column in columns)
    return GroundTruth(targets, slots, np.concatenate(lanes), cars)


def _at_the_slot(scenario: Scenario, car: CarOutline, around: list[Kerb]) -> list[Kerb]:
    """Return the kerbs that bound the slot; without a slot those beside the car where it shall stand."""
    place = scenario.slot or scenario.target
    if place is None:
        return []
    half = 0.5 * scenario.slot.width if scenario.slot is not None else car.half_width
    found = []
    for kerb in around:
        dx, dy = kerb.x2 - kerb.x1, kerb.y2 - kerb.y1
        length = math.hypot(dx, dy)
        if length == 0.0 or abs(dx * math.cos(place.heading) + dy * math.sin(place.heading)) < ALONG * length:
            continue
        share = min(max(((place.x - kerb.x1) * dx + (place.y - kerb.y1) * dy) / length**2, 0.0), 1.0)
        if math.hypot(place.x - kerb.x1 - share * dx, place.y - kerb.y1 - share * dy) <= half + AT_THE_SLOT:
            found.append(kerb)
    return found
