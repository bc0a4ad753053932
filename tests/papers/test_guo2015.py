"""Every number that the reproduction of Guo 2015 promises, one test a row."""

import pytest

from controller_fmu.guo2015.params import GuoParams
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.studies.papers.guo2015 import case_rows, reproduce
from orchestrator.studies.papers.guo2015_drivers import NEAR_Q3, PARK_LONGITUDINAL, obey
from orchestrator.studies.papers.result import CONCLUSION, OWN, PRINTED, Drive, Driven, Reproduction, Row
from tests.native_runs import native_recording

SCENARIOS = [
    *(f"guo2015-case{case}{rate}" for case in range(1, 6) for rate in ("", "-105")),
    "guo2015-case1-cwpt",
    "guo2015-case4-left",
    "guo2015-case4-far",
]


@pytest.fixture(scope="module")
def reproduction(by_default: Drive) -> Reproduction:
    return reproduce(by_default)


def test_every_check_is_as_stated(reproduction: Reproduction) -> None:
    assert not [row for row in reproduction.rows if row.as_expected is False]
    assert reproduction.passed
    assert reproduction.tally == (45, 11, 9, 29, 29)


def test_every_check_says_what_it_is_of_and_every_number_of_the_paper_has_a_limit(reproduction: Reproduction) -> None:
    for row in reproduction.rows:
        assert (row.limit is not None) == (row.basis in (PRINTED, CONCLUSION, OWN))
        assert row.paper is None or row.limit is not None or row.untestable


def test_what_differs_is_said_and_nothing_else_is_beyond_its_limit(reproduction: Reproduction) -> None:
    differs = {(row.run, row.item) for row in reproduction.rows if row.passed is False}
    assert {run for run, _ in differs} == {
        *("guo2015-case1", "guo2015-case2", "guo2015-case2-105", "guo2015-case3", "guo2015-case3-105", "guo2015-case4"),
    }
    assert all(row.differs for row in reproduction.rows if row.passed is False)


def test_a_known_difference_that_is_gone_is_news() -> None:
    row = Row("run", "outcome", "", "parked", "parked", 0.0, basis=CONCLUSION, differs="it was not")
    assert row.passed
    assert row.as_expected is False
    assert not Reproduction("paper", "", [row], []).passed


def test_the_gains_are_the_paper_s() -> None:
    gains = GuoParams()
    assert (gains.k1, gains.k2, gains.k3, gains.k4) == (1.0, 0.8, 1.0, 4.0)


@pytest.mark.parametrize(("gain", "factor"), [("k1", 0.5), ("k2", 0.5), ("k3", 2.0), ("k4", 2.0), ("k4", 0.5)])
def test_a_gain_doubled_or_halved_misses_a_check(gain: str, factor: float) -> None:
    value = factor * getattr(GuoParams(), gain)
    change = f"controller.guo2015.{gain}={value}"
    scenario, recording = load_scenario("guo2015-case4-105", [change]), native_recording("guo2015-case4-105", change)
    rows = case_rows(4, Driven(scenario, recording, summarize(recording, scenario, 1.0)))
    assert [row for row in rows if row.basis == PRINTED and row.as_expected is False]


def test_windows_of_what_is_fitted_are_shown(reproduction: Reproduction) -> None:
    shown = {row.item.rpartition(": ")[2] for row in reproduction.rows if row.item.startswith("fits within")}
    assert shown == {"steering rate", "threshold to leave the path", "driver's speed"}


@pytest.mark.parametrize("rate", ["", "-105"])
def test_drivers_who_obey_stay_on_the_path(rate: str) -> None:
    found = obey(f"guo2015-case3{rate}", (0.3, 1.5), (0.0, 0.25, 0.5))
    assert found[:4] == (6, 6, 6, 6)
    assert 0 < found.near < found.parked


def test_all_drivers_who_obey_end_near_q3_where_they_are_asked_back_to_it() -> None:
    back = obey("guo2015-case3", (0.3, 1.5), (0.0, 0.5), (f"{PARK_LONGITUDINAL}={NEAR_Q3}",))
    assert back.near == back.parked == back.drivers == 4


def test_two_speeds_of_case_5_fit_four_printed_numbers(reproduction: Reproduction) -> None:
    for run in ("guo2015-case5", "guo2015-case5-105"):
        rows = [row for row in reproduction.rows if row.run == run and row.basis == PRINTED]
        assert [row.paper for row in rows] == [0.065, 22.0, -3.058, 0.002]
        assert all(row.passed for row in rows)


def test_what_the_paper_calls_a_success_stands_beside_our_outcome(reproduction: Reproduction) -> None:
    said = {(row.run, row.item.partition(",")[0]): row.ours for row in reproduction.rows}
    for run in ("guo2015-case3", "guo2015-case3-105", "guo2015-case5-105"):
        assert said[run, "outcome"] == "parked"
        assert said[run, "outcome by our limits"] == "not_parked: beyond its limit: final longitudinal position"
    assert said["guo2015-case4", "outcome"] == said["guo2015-case4", "outcome by our limits"] == "parked"


@pytest.mark.parametrize("name", SCENARIOS)
def test_scenarios_end_as_they_say(name: str, by_default: Drive) -> None:
    driven = by_default(name)
    assert driven.summary.outcome == driven.scenario.expected_outcome


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
def test_faults_end_with_a_reason_and_a_stopped_car(name: str, reason: str, by_default: Drive) -> None:
    driven = by_default(name)
    assert driven.summary.outcome == driven.scenario.expected_outcome
    assert driven.summary.reason == reason
    assert driven.recording.signals["vehicle.speed"][-1] == 0.0
