"""What is true in a case of the grid study, and whether its result is parked: by the judge of all runs.

The limits are the shipped ones, of which those on the way past the slot (speed) are not asked here.
"""

import math
from collections.abc import Mapping
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from controller_fmu.apa.slot import Kind
from orchestrator.cosim.slave import Array
from orchestrator.scenario.requirements import shipped_requirements
from orchestrator.scenario.scenario import Scenario, Slot, Target
from orchestrator.verdict.judge import meets
from orchestrator.verdict.measures import Measure
from orchestrator.verdict.numbers import MEASURES, numbers
from orchestrator.verdict.outcome import Asked, Ends, outcomes
from orchestrator.verdict.truth import truth_of

PERPENDICULAR_DEPTH = 4.6
"""Of the neighbours of a perpendicular slot [m]."""
GBT = ("gbt41630", "no-contact")
GBT_PERPENDICULAR = ("gbt41630-perpendicular", "no-contact")
HOUSE, HOUSE_SHIFTS_AS_GBT = "apa", "apa-tight"
HAS = (None, "target", "slot")
"""No case has a kerb."""
LAST = tuple(item.signal for item in MEASURES if item.how == "last" and not item.signal.startswith("controller."))
"""Signals whose last values a verdict is made from."""


class Place(NamedTuple):
    """Where a slot is and which car shall stand in it [m]."""

    kind: int
    side: int
    """1 right, -1 left."""
    length: float
    """Along the road."""
    depth: float
    """Of a parallel slot."""
    wheelbase: float
    front_overhang: float
    rear_overhang: float
    width: float


@lru_cache
def scenario_of(place: Place) -> Scenario:
    """Return what is true: corner A of the slot at the origin, the car flush with its neighbours."""
    middle, turn = 0.5 * place.length, 0.5 * math.pi * place.side
    if place.kind == Kind.PARALLEL:
        return Scenario(
            name="parallel",
            target=Target(x=middle, y=-0.5 * place.side * place.width),
            slot=Slot(x=middle, y=-0.5 * place.side * place.depth, length=place.length, width=place.depth),
        )
    front, depth = place.wheelbase + place.front_overhang, PERPENDICULAR_DEPTH
    return Scenario(
        name="perpendicular",
        target=Target(x=middle, y=-place.side * front, heading=turn),
        slot=Slot(x=middle, y=-0.5 * place.side * depth, heading=turn, length=depth, width=place.length),
    )


def standing(place: Place, last: Mapping[str, float]) -> dict[str, float]:
    """Return the numbers of how the car stands in ``place`` after the signals ``last``."""
    found = {Measure("last", name): np.array([last[name]]) for name in LAST}
    car = {name: getattr(place, name) for name in ("wheelbase", "front_overhang", "rear_overhang", "width")}
    made = numbers(np.zeros(1), found, truth_of(scenario_of(place), car))
    return {name: float(values[0]) for name, values in made.items() if name.startswith("final.") and "kerb" not in name}


def is_parked(place: Place, phase: float, values: Mapping[str, float], sets: tuple[str, ...]) -> bool:
    """Return whether a run is parked by shipped sets of limits; ``values`` are its numbers and signals by name."""
    known = [item for name in sets for item in shipped_requirements(name) if item.signal in values]
    asked = [item for item in known if item.where in HAS]
    missed = [Asked(item.id, ~meets(item, _one(values[item.signal])), np.zeros(1, dtype=bool)) for item in asked]
    ends = Ends([""], _one(phase), _one(0.0), _one(values["final.speed"]))
    ((outcome, _),) = outcomes(scenario_of(place), ends, missed)
    return outcome == "parked"


def _one(value: float) -> Array:
    return np.array([value])
