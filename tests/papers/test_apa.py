"""Every number that the reproduction of the APA source promises."""

import pytest

from orchestrator.studies.papers.apa import CARS, reproduce
from orchestrator.studies.papers.result import Drive, Reproduction


@pytest.fixture(scope="module")
def reproduction(by_default: Drive) -> Reproduction:
    return reproduce(by_default)


def test_every_check_is_as_stated(reproduction: Reproduction) -> None:
    assert not [row for row in reproduction.rows if row.as_expected is False]
    assert all(row.basis or row.limit is None for row in reproduction.rows)
    assert reproduction.tally == (6, 0, 6, 6, 6)


def test_iso_slots_are_shorter_than_l_min(reproduction: Reproduction) -> None:
    rows = {row.item: row.ours for row in reproduction.rows}
    for name in CARS:
        iso, closed = rows[f"{name}: shortest slot of ISO 16787"], rows[f"{name}: L_min, formula and search"]
        assert isinstance(iso, float)
        assert isinstance(closed, float)
        assert iso < closed
