"""Every number that the reproduction of Zhang 2022 promises."""

import pytest

from orchestrator.studies.papers.result import Drive, Reproduction
from orchestrator.studies.papers.zhang2022 import reproduce


@pytest.fixture(scope="module")
def reproduction(by_default: Drive) -> Reproduction:
    return reproduce(by_default)


def test_every_check_is_as_stated(reproduction: Reproduction) -> None:
    assert not [row for row in reproduction.rows if row.as_expected is False]
    assert all(row.basis or row.limit is None for row in reproduction.rows)
    assert reproduction.tally == (6, 0, 3, 22, 22)


def test_the_refusal_says_by_how_much(reproduction: Reproduction) -> None:
    found = {row.item: row.ours for row in reproduction.rows if row.run == "zhang2022-refused"}
    assert float(found["curvature of the best path"]) > float(found["curvature limit of the path"])
