"""Every shipped car in every parking scenario of the assist: it parks, or the slot is too small for it, and why."""

import math
from pathlib import Path
from typing import Any, NamedTuple

from controller_fmu.interface import Reason
from modelkit.car import Car, car_length
from modelkit.variables import with_values
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario, scenario_names
from orchestrator.inputs.scenario.requirements import library_requirements
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.scenario.slot_sizes import ParkingType, shortest_slot
from orchestrator.session.session import run_scenario
from orchestrator.studies.parking.cases import ISO

POSES = ("final heading", "final lateral position", "outline in the slot")
"""What GB/T 41630 asks of where a car stands; the assist stands flush with its neighbours, wherever the kerb is."""
GEOMETRIC = frozenset(
    item.name.lower()
    for item in (
        *(Reason.SLOT_TOO_SHORT, Reason.SLOT_TOO_SHALLOW, Reason.NO_SLOT, Reason.NO_PATH, Reason.TOO_MANY_SHIFTS),
        *(Reason.MISSED_TARGET, Reason.BLOCKED),
    )
)
"""Reasons of the assist that speak of the slot and the car, not of a fault: it stands out, or before a wall, too."""


class CarInSlot(NamedTuple):
    """What became of one car in one scenario."""

    scenario: str
    car: str
    lacks: str
    """What the slot lacks of ISO 16787 for this car; empty if it fits."""
    outcome: str
    reason: str
    nearest: float
    """Least clearance [m] of the run."""


def parking_scenarios() -> list[str]:
    """Return the scenarios in which the assist is meant to find a slot and park the car they are written for."""
    found = {name: load_scenario(name) for name in scenario_names() if name.startswith("apa-")}
    return [name for name, item in found.items() if item.expected_outcome == "parked" and _finds_its_slot(item)]


def _finds_its_slot(scenario: Scenario) -> bool:
    """Return whether there is a slot to be found, without external slots and faults."""
    return scenario.slot is not None and scenario.system is None and not scenario.faults


def park(name: str, car: str, files: dict[str, Path]) -> CarInSlot:
    """Return what becomes of a shipped car in a scenario, judged by where GB/T 41630 wants it to stand."""
    own = load_scenario(name, [f"car={car}"])
    limits = [item for item in library_requirements("gbt41630") if item.id in POSES]
    scenario = own.with_requirements(limits)
    ran = run_scenario(scenario, files, kind="native")
    summary = summarize(ran.recording, scenario, ran.wall_time)
    nearest = float(ran.recording.signals["vehicle.clearance"].min())
    return CarInSlot(name, car, lacking(own), summary.outcome, summary.reason, nearest)


def lacking(scenario: Scenario) -> str:
    """Return what the slot of a scenario lacks of ISO 16787 for its car; empty if the car fits into it."""
    assert scenario.slot is not None
    own: dict[str, Any] = {name[4:]: value for name, value in scenario.vehicle.items() if name.startswith("car.")}
    car = with_values(Car, own)
    length = car_length(car)
    along, across = scenario.slot.length, scenario.slot.width
    if abs(math.sin(scenario.slot.heading)) > 0.5:
        asked = ((across, shortest_slot(ParkingType.PERPENDICULAR, car, ISO), "wide"), (along, length, "deep"))
    else:
        asked = (
            (along, shortest_slot(ParkingType.PARALLEL, car, ISO), "long"),
            (across, car.width + ISO.deeper, "deep"),
        )
    return ", ".join(f"{has:.2f} m {what}, {needs:.2f} m required" for has, needs, what in asked if has < needs - 1e-9)
