"""What charts decide on is seen while models run, and counted as the table says."""

import json
import sys
from collections import Counter
from enum import IntEnum
from pathlib import Path
from typing import Any

import pytest

import controller_fmu
from modelkit.model import Chart
from orchestrator.cli import main
from orchestrator.inputs.scenario.wiring.modes import ModeList
from orchestrator.testing.coverage.covered import chart_coverage, share
from orchestrator.testing.coverage.tracer import decider, name_of, tracing
from tests.orchestrator import c_fmus

CHARTS = controller_fmu.MODEL.all_charts()


class Lamp(IntEnum):
    OFF = 0
    ON = 1
    BROKEN = 2


class Guard(IntEnum):
    BREAKS = 0
    SWITCHED = 1


LAMP = Chart("lamp", Lamp, Guard, ((-1, 0, 2), (0, 1, 1), (1, 1, 0)))


def counts(*decided: Any) -> Any:
    return chart_coverage(LAMP, Counter(decided))


def test_a_row_decides_unless_one_above_it_was_taken() -> None:
    both, switched = 0b11, 0b10
    found = counts((0, both), (0, switched), (0, 0), (1, 0))
    assert [(row.source, row.taken, row.refused) for row in found.rows] == [
        ("any state", 1, 3),
        ("OFF", 1, 1),
        ("ON", 0, 1),
    ]
    assert (found.count_visited, found.count_taken, found.outcomes) == (3, 2, 5)
    assert share([found]) == pytest.approx(2 / 3)


def test_a_row_for_any_state_does_not_leave_an_end() -> None:
    assert [row.taken + row.refused for row in counts((2, 0b11)).rows] == [0, 0, 0]


def test_every_chart_has_one_function_that_decides() -> None:
    assert len(CHARTS) >= 2
    for chart in CHARTS:
        names = list(decider(chart).__code__.co_varnames)
        assert "guards" in names


def test_looking_on_changes_nothing_and_ends() -> None:
    before = {name_of(chart): decider(chart) for chart in CHARTS}
    with tracing(CHARTS) as seen:
        guo = sys.modules["controller_fmu.guo2015.system"]
        assert guo.transition is not before["controller_fmu.guo2015.chart"]
        assert guo.transition(0, 2, 1 << 2) == before["controller_fmu.guo2015.chart"](0, 2, 1 << 2)
    assert seen["controller_fmu.guo2015.chart"] == {(0, 1 << 2): 1}
    assert guo.transition is before["controller_fmu.guo2015.chart"]


def test_a_run_covers_what_it_went_through(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["test", "guo2015-case4", "--coverage", "--min-transition-coverage", "5", "--out", str(tmp_path)]
    assert main(words) == 0
    printed = capsys.readouterr()
    assert "11 of 21" in printed.out
    assert "required" not in printed.err
    data = json.loads((tmp_path / "coverage.json").read_text(encoding="utf-8"))
    guo = next(chart for chart in data["charts"] if chart["name"] == "controller_fmu.guo2015.chart")
    taken = {(row["source"], row["guard"]): row["taken"] for row in guo["rows"]}
    assert taken["PATH_TRACKING", "OFF_PATH"] == 1
    assert taken["TO_Q4", "PAST_Q4"] == 0
    assert guo["states"]["TO_Q4"] == 0
    page = (tmp_path / "coverage.html").read_text(encoding="utf-8")
    assert 'color="#d1343a"' in page
    assert f">{100.0 * data['transition_coverage']:.0f} % of the transitions<" in page


def test_too_little_fails(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["test", "fault-driver-takes-over", "--min-transition-coverage", "90", "--out", str(tmp_path)]
    assert main(words) == 1
    assert "required 90 %" in capsys.readouterr().err


STATES = "{idle: 1, first arc: 2, second arc: 3, there: 4, lost: 5}"
LISTED = "[idle -> first arc, first arc -> second arc, any state -> lost]"


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Somebody's FMU, a scenario that connects it, and one that lists its mode."""
    folder = tmp_path_factory.mktemp("desk")
    c_fmus.two_arcs(folder)
    text = (c_fmus.THEIR / "two_arcs.yaml").read_text(encoding="utf-8")
    (folder / "plain.yaml").write_text(text.replace("their-case4", "plain"), encoding="utf-8")
    (folder / "short.yaml").write_text(f"stop_time: 0.5\n{text}", encoding="utf-8")
    modes = f"  modes:\n    controller.State: {{states: {STATES}, transitions: {LISTED}}}\n"
    (folder / "listed.yaml").write_text(text + modes, encoding="utf-8")
    return folder


def test_of_the_fmu_of_others_a_mode_is_seen(desk: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    both = [str(desk / "plain.yaml"), str(desk / "listed.yaml")]
    assert main(["test", *both, "--min-transition-coverage", "66", "--out", str(tmp_path)]) == 0
    assert "not listed: second arc to there" in capsys.readouterr().out
    data = json.loads((tmp_path / "coverage.json").read_text(encoding="utf-8"))
    (chart,) = data["charts"]
    assert (chart["name"], chart["signal"]) == ("two_arcs.fmu", "State")
    assert [(row["source"], row["target"], row["taken"]) for row in chart["rows"]] == [
        ("idle", "first arc", 2),
        ("first arc", "second arc", 2),
        ("any state", "lost", 0),
    ]
    assert [name for name, count in chart["states"].items() if not count] == ["lost"]
    assert data["transition_coverage"] == pytest.approx(2 / 3)
    assert {branch["file"].split("/")[0] for branch in data["branches"]} == {"vehicle_fmu"}
    page = (tmp_path / "coverage.html").read_text(encoding="utf-8")
    assert "any state to lost" in page
    assert "decided against" not in page


def test_what_nobody_lists_has_no_threshold(desk: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["test", str(desk / "short.yaml"), "--min-transition-coverage", "1", "--out", str(tmp_path)]) == 2
    assert "nothing says which transitions there are" in capsys.readouterr().err


@pytest.mark.release
def test_what_nobody_lists_is_told(desk: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["test", str(desk / "plain.yaml"), "--coverage", "--out", str(tmp_path)]) == 0
    assert "3 seen, none listed" in capsys.readouterr().out
    data = json.loads((tmp_path / "coverage.json").read_text(encoding="utf-8"))
    assert list(data["charts"][0]["states"]) == ["standby", "path tracking", "straighten", "parked"]


@pytest.mark.parametrize(
    ("modes", "says"),
    [
        ({"transitions": ["idle to driving"]}, "is no transition; expected the like of idle -> driving"),
        ({"states": {"idle": 1}, "transitions": ["idel -> idle"]}, "did you mean idle"),
    ],
)
def test_a_list_that_means_nothing_is_refused(modes: Any, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        ModeList(**modes)


def test_a_mode_that_is_no_output_is_told_before_the_run(
    desk: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = desk / "wrong.yaml"
    text = (desk / "listed.yaml").read_text(encoding="utf-8")
    file.write_text(text.replace("controller.State: {states", "controller.Stat: {states"), encoding="utf-8")
    assert main(["run", str(file), "--out", str(tmp_path), "--no-page"]) == 2
    assert "did you mean controller.State" in capsys.readouterr().err
