"""The charts in docs/apa.md are those that run."""

from pathlib import Path

from controller_fmu.apa import chart, manoeuvre_chart

PAGE = (Path(__file__).parents[2] / "docs" / "apa.md").read_text(encoding="utf-8")


def test_the_page_shows_every_row_of_both_charts() -> None:
    outer = [f"{chart.Mode(a).name} --> {chart.Mode(b).name}: {chart.Guard(g).name}" for a, g, b in chart.TRANSITIONS]
    steps, guards = manoeuvre_chart.Step, manoeuvre_chart.Guard
    inner = [f"{steps(a).name} --> {steps(b).name}: {guards(g).name}" for a, g, b in manoeuvre_chart.TRANSITIONS]
    shown = [line.strip() for line in PAGE.splitlines() if "-->" in line and not line.startswith("<!--")]
    assert shown == outer + inner
