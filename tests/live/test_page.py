"""The page in a real browser: its judge agrees with the judge in Python, people drive it, sliders move the ghost."""

import pytest

from orchestrator.cosim.fmu_files import fmu_files
from orchestrator.live.page import live_page
from orchestrator.scenario.load_scenario import load_scenario, scenario_names
from orchestrator.session.session import run_scenario
from orchestrator.verdict.summary import summarize

WITHOUT_FAULTS = [name for name in scenario_names() if not load_scenario(name).faults]
LARGEST_PAGE = 400_000
WHOLE = """(name) => {
  const page = window.live, { lab } = page;
  page.load(name);
  const run = lab.whole.run(lab.situation.params(), lab.situation.data.times, 1);
  const { outcome, reason, numbers, checks } = judged(run.row, lab.situation, lab.table);
  const phase = 1 + lab.seen.indexOf("controller.phase"), at = (i, place) => run.trace[i * run.width + place];
  const events = [];
  for (let i = 1; i < run.lines; i++) if (at(i, phase) !== at(i - 1, phase)) events.push(at(i, 0));
  return { outcome, reason, numbers, events, checks: checks.map((check) => [check.id, check.passed]) };
}"""


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("live") / "live.html"
    path.write_text(live_page([load_scenario(name) for name in scenario_names()]), encoding="utf-8")
    assert path.stat().st_size < LARGEST_PAGE
    return path


@pytest.fixture
def page(file, show):
    shown, seen = show(file, "#s=guo2015-case4", 1440, 900)
    yield shown
    assert seen.console == []
    assert [url for url in seen.requests if not url.startswith(("file:", "data:", "blob:"))] == []


def test_the_judge_of_the_page_says_what_the_judge_in_python_says(page):
    files = fmu_files("native")
    for name in WITHOUT_FAULTS:
        scenario = load_scenario(name)
        ran = run_scenario(scenario, files, kind="native")
        summary, found = summarize(ran.recording, scenario, ran.wall_time), page.evaluate(WHOLE, name)
        assert (found["outcome"], found["reason"]) == (summary.outcome, summary.reason), name
        assert found["checks"] == [[check.id, check.passed] for check in summary.checks], name
        assert found["events"] == [event.t for event in summary.events], name
        assert (found["numbers"]["shifts"] or 0) == (summary.shifts or 0), name
        for key, value in summary.final.model_dump().items():
            told = found["numbers"][f"final.{key}"]
            assert told == pytest.approx(value, rel=0.0, abs=1e-6, nan_ok=True), (name, key)
