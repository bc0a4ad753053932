"""A standard's numbers stand in orchestrator/library/requirements alone; other places are checked against it."""

import pytest

from controller_fmu import APA, MODEL
from modelkit.car import Car
from modelkit.variables import Variable, variables, with_values
from orchestrator.inputs.scenario.files import library_names
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.requirements import library_requirements
from orchestrator.inputs.scenario.slot_sizes import ParkingType, library_slot_sizes, shortest_slot

LIMITS = {item.id: item.limit for item in library_requirements("gbt41630")}
SAME = {
    "final_lateral_error": "final lateral position",
    "final_heading_error": "final heading",
    "manoeuvres": "manoeuvres",
    "stand_out": "outline in the slot",
    "accepted_heading": "final heading",
}
OF_STANDARD = [
    item
    for model in (MODEL, APA)
    for item in variables(model.params)
    if item.signal.source == "GB/T 41630" and item.name.rsplit(".", 1)[-1] in SAME
]


@pytest.mark.parametrize("item", OF_STANDARD, ids=lambda item: item.name)
def test_a_controller_asks_no_less_of_itself_than_the_standard_it_names(item: Variable) -> None:
    limit = LIMITS[SAME[item.name.rsplit(".", 1)[-1]]]
    assert isinstance(limit, float)
    assert 0.0 < item.start <= abs(limit)


@pytest.mark.parametrize(("name", "kind"), [("apa-parallel-tight", 1), ("apa-perpendicular-tight", 2)])
def test_the_tight_slots_are_the_shortest_but_for_centimetres(name: str, kind: int) -> None:
    scenario = load_scenario(name)
    own = {key[4:]: value for key, value in scenario.vehicle.items() if key.startswith("car.")}
    car = with_values(Car, own)
    assert scenario.slot is not None
    along, across = scenario.slot.length, scenario.slot.width
    shortest = shortest_slot(kind, car, library_slot_sizes("iso16787"))
    assert 0.0 <= (along if kind == ParkingType.PARALLEL else across) - shortest < 0.05


def test_a_limit_of_a_standard_is_the_same_in_every_set_that_has_it() -> None:
    """Shifts into a parallel and into a perpendicular slot are two."""
    found: dict[tuple[str, str], set[float | str]] = {}
    for name in library_names("requirements"):
        for item in library_requirements(name):
            if item.source.startswith(("GB/T", "ISO", "UN")):
                found.setdefault((item.source, item.signal), set()).add(item.limit)
    twice = {key: limits for key, limits in found.items() if len(limits) > 1}
    assert twice == {("GB/T 41630", "manoeuvres"): {8.0, 7.0}}


def test_there_are_such() -> None:
    assert len(OF_STANDARD) >= 7
