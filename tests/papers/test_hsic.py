"""Every number that the reproduction of the HSIC paper promises."""

import pytest

from controller_fmu.hsic.characteristic_states import Characteristic
from orchestrator.studies.papers.hsic import SCENARIOS, reproduce
from orchestrator.studies.papers.result import Drive, Reproduction


@pytest.fixture(scope="module")
def reproduction(by_default: Drive) -> Reproduction:
    return reproduce(by_default)


def test_every_check_is_as_stated(reproduction: Reproduction) -> None:
    assert not [row for row in reproduction.rows if row.as_expected is False]
    assert all(row.basis or row.limit is None for row in reproduction.rows)
    assert reproduction.tally == (4, 0, 4, 13, 13)


def test_each_of_the_twelve_states_is_reached_by_a_shipped_scenario(reproduction: Reproduction) -> None:
    reached = {row.item.split()[2]: row.ours for row in reproduction.rows if row.item.startswith("state ")}
    assert set(reached) == {state.name for state in Characteristic} - {"NONE"}
    assert len(reached) == 12
    assert set(reached.values()) <= set(SCENARIOS)
