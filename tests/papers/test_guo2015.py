"""Every number that the reproduction of Guo 2015 promises, one test a row."""

from pathlib import Path

import pytest

from orchestrator.papers.drive import drive
from orchestrator.papers.guo2015 import reproduce
from orchestrator.papers.result import Drive, Reproduction

SCENARIOS = [
    *(f"guo2015-case{case}{rate}" for case in range(1, 6) for rate in ("", "-105")),
    "guo2015-case1-cwpt",
    "guo2015-case4-left",
    "guo2015-case4-far",
]


@pytest.fixture(scope="module")
def reproduction(tmp_path_factory: pytest.TempPathFactory) -> Reproduction:
    return reproduce(tmp_path_factory.mktemp("guo2015"), drive)


def test_every_stated_check_holds(reproduction: Reproduction) -> None:
    asked = [row for row in reproduction.rows if row.limit is not None]
    missed = [row for row in asked if not row.passed]
    assert not missed
    assert len(asked) == 12 + 1 + 9 + 2 * 5


def test_figures_are_written(reproduction: Reproduction) -> None:
    assert [figure.name for figure in reproduction.figures] == [f"guo2015-case{case}.png" for case in range(1, 6)]
    assert all(Path(figure).stat().st_size > 20_000 for figure in reproduction.figures)


@pytest.mark.parametrize("name", SCENARIOS)
def test_scenarios_end_as_they_say(name: str) -> None:
    driven = drive(name)
    assert driven.summary.outcome == driven.scenario.expect


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("fault-pose-frozen", "pose_frozen"),
        ("fault-pose-nan", "bad_input"),
        ("fault-steering-dropped", "steering_fault"),
        ("fault-driver-never-obeys", "not_stopping"),
        ("fault-driver-does-not-move", "not_moving"),
        ("fault-driver-takes-over", "takeover"),
        ("fault-no-path", "no_path"),
        ("fault-pose-noise", "all checks passed"),
    ],
)
def test_faults_end_with_a_reason_and_a_stopped_car(name: str, reason: str) -> None:
    driven = drive(name)
    assert driven.summary.outcome == driven.scenario.expect
    assert driven.summary.reason == reason
    assert driven.recording.signals["vehicle.speed"][-1] == 0.0


def test_native_fmus_give_the_same_numbers(reproduction: Reproduction, native: Drive, tmp_path: Path) -> None:
    assert reproduce(tmp_path, native).rows == reproduction.rows
