"""Every number that the reproduction of the preview paper promises. The sweep of the set speed has its own test."""

import numpy as np
import pytest

from orchestrator.studies.papers import preview
from orchestrator.studies.papers.result import Drive, Reproduction


@pytest.fixture(scope="module")
def reproduction(by_default: Drive) -> Reproduction:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(preview, "can_compile", lambda: False)
        return preview.reproduce(by_default)


def test_every_check_is_as_stated(reproduction: Reproduction) -> None:
    assert not [row for row in reproduction.rows if row.as_expected is False]
    assert all(row.basis or row.limit is None for row in reproduction.rows)
    assert reproduction.tally == (17, 9, 5, 1, 1)


def test_the_friction_that_gives_the_fitted_acceleration_is_stated_for_each_form() -> None:
    stated = [str(row.ours) for row in preview.friction_rows() if row.paper is None]
    assert stated == ["0.18 to 0.93", "0.13 to 0.65", "0.10 to 0.23"]


def test_both_definitions_of_eps_are_shown(reproduction: Reproduction) -> None:
    steady = [row.ours for row in reproduction.rows if row.item.endswith("by (2), ours")]
    chord = [row.ours for row in reproduction.rows if row.item.endswith("as the chord")]
    assert np.allclose(steady, (-2.39, 4.54, -7.14, 7.57), atol=0.05)
    assert np.allclose(chord, (-1.15, 2.01, -2.86, 2.86), atol=0.05)


def test_the_single_point_steers_earlier_and_is_too_fast(reproduction: Reproduction) -> None:
    for curve in (2, 3):
        before = {
            row.run: float(row.ours) for row in reproduction.rows if row.item.endswith(f"before curve {curve} by")
        }
        assert before["preview-single"] > before["preview"] + 1.5
        share = {row.run: float(row.ours) for row in reproduction.rows if row.item.endswith(f"there, curve {curve}")}
        assert share["preview-single"] > 1.4 > 1.03 > share["preview"]


def test_steering_rises_in_time_and_swings_where_l1_jumps(reproduction: Reproduction) -> None:
    found = {row.item: row for row in reproduction.rows if row.run == "preview"}
    assert found["longest rise or fall of the angle, to 90 %"].passed
    assert 2.0 < float(found["longest until it stays within 8 %"].ours) < 2.05
    assert found["swing back on the way into curves 3 and 4"].passed
    assert found["swing back after curves 3 and 4"].passed is False
