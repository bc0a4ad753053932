"""What charts decide on is seen while models run, and counted as the table says."""

import json
import sys
from collections import Counter
from enum import IntEnum

import pytest

import controller_fmu
from modelkit.model import Chart
from orchestrator.cli import main
from orchestrator.coverage.covered import covered, share
from orchestrator.coverage.tracer import charts_of, decider, name_of, tracing

CHARTS = charts_of(controller_fmu.MODEL)


class Lamp(IntEnum):
    OFF = 0
    ON = 1
    BROKEN = 2


class Guard(IntEnum):
    BREAKS = 0
    SWITCHED = 1


LAMP = Chart("lamp", Lamp, Guard, ((-1, 0, 2), (0, 1, 1), (1, 1, 0)))


def counts(*decided):
    return covered(LAMP, Counter(decided))


def test_a_row_decides_unless_one_above_it_was_taken():
    both, switched = 0b11, 0b10
    found = counts((0, both), (0, switched), (0, 0), (1, 0))
    assert [(row.source, row.taken, row.refused) for row in found.rows] == [
        ("any state", 1, 3),
        ("OFF", 1, 1),
        ("ON", 0, 1),
    ]
    assert (found.visited, found.taken, found.outcomes) == (3, 2, 5)
    assert share([found]) == pytest.approx(2 / 3)


def test_a_row_for_any_state_does_not_leave_an_end():
    assert [row.taken + row.refused for row in counts((2, 0b11)).rows] == [0, 0, 0]


def test_every_chart_has_one_function_that_decides():
    assert len(CHARTS) >= 3
    for chart in CHARTS:
        names = list(decider(chart).__code__.co_varnames)
        assert "guards" in names


def test_looking_on_changes_nothing_and_ends():
    before = {name_of(chart): decider(chart) for chart in CHARTS}
    with tracing(CHARTS) as seen:
        guo = sys.modules["controller_fmu.guo2015.system"]
        assert guo.transition is not before["controller_fmu.guo2015.chart"]
        assert guo.transition(0, 2, 1 << 2) == before["controller_fmu.guo2015.chart"](0, 2, 1 << 2)
    assert seen["controller_fmu.guo2015.chart"] == {(0, 1 << 2): 1}
    assert guo.transition is before["controller_fmu.guo2015.chart"]


def test_a_run_covers_what_it_went_through(tmp_path, capsys):
    assert main(["test", "guo2015-case4", "--coverage", "--out", str(tmp_path)]) == 0
    assert "11 of 20" in capsys.readouterr().out
    data = json.loads((tmp_path / "coverage.json").read_text(encoding="utf-8"))
    guo = next(chart for chart in data["charts"] if chart["name"] == "controller_fmu.guo2015.chart")
    taken = {(row["source"], row["guard"]): row["taken"] for row in guo["rows"]}
    assert taken["PATH_TRACKING", "OFF_PATH"] == 1
    assert taken["TO_Q4", "PAST_Q4"] == 0
    assert guo["states"]["TO_Q4"] == 0
    page = (tmp_path / "coverage.html").read_text(encoding="utf-8")
    assert 'color="#d1343a"' in page


@pytest.mark.parametrize(("least", "code"), [("5", 0), ("90", 1)])
def test_too_little_fails(tmp_path, capsys, least, code):
    words = ["test", "guo2015-case4", "--min-transition-coverage", least, "--out", str(tmp_path)]
    assert main(words) == code
    assert ("asked 90 %" in capsys.readouterr().err) == (code == 1)


def test_the_charts_of_others_cannot_be_looked_into(tmp_path, capsys):
    fmu = tmp_path / "their.fmu"
    fmu.write_bytes(b"PK")
    assert main(["test", "guo2015-case4", "--coverage", "--controller", str(fmu), "--out", str(tmp_path / "out")]) == 2
    assert "looked into" in capsys.readouterr().err
