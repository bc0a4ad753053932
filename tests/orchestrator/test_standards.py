"""A standard's numbers stand in orchestrator/limits; what a controller asks of itself by one is no laxer."""

import pytest

from controller_fmu import MODEL
from modelkit.variables import Variable, variables
from orchestrator.scenario.requirements import shipped_requirements

LIMITS = {item.id: item.limit for item in shipped_requirements("gbt41630")}
OF_STANDARD = [item for item in variables(MODEL.params) if item.signal.source == "GB/T 41630"]
SAME = {
    "miss_lateral": "final lateral position",
    "miss_heading": "final heading",
    "shifts": "shifts",
    "stand_out": "outline in the slot",
    "out": "outline in the slot",
}


@pytest.mark.parametrize("item", OF_STANDARD, ids=lambda item: item.name)
def test_a_controller_asks_no_less_of_itself_than_the_standard_it_names(item: Variable) -> None:
    limit = LIMITS[SAME[item.name.rsplit(".", 1)[-1]]]
    assert isinstance(limit, float)
    assert 0.0 < item.start <= abs(limit)


def test_there_are_such() -> None:
    assert len(OF_STANDARD) >= 7
