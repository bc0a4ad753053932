"""Both pages against WCAG 2.2 AA, light and dark, by axe."""

from pathlib import Path

import pytest

from orchestrator.live.page import live_page
from orchestrator.scenario.load_scenario import load_scenario

RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]
RUN = """async (rules) => (await axe.run({ runOnly: rules })).violations
  .map((found) => [found.id, found.nodes.map((node) => [node.target.join(" "), (node.any[0] || {}).message])])"""


@pytest.fixture(scope="module")
def axe():
    package = pytest.importorskip("axe_core_python")
    (file,) = Path(package.__file__).parent.rglob("axe*.js")
    return file.read_text(encoding="utf-8")


def wrong(page, axe):
    page.evaluate(axe)
    return page.evaluate(RUN, RULES)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_replay_page(scheme, show, replay, axe):
    page, _ = show(replay, color_scheme=scheme, bypass_csp=True)
    assert wrong(page, axe) == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_panel_of_the_page_that_is_driven(scheme, show, axe, tmp_path):
    path = tmp_path / "live.html"
    path.write_text(live_page([load_scenario("guo2015-case4-105")]), encoding="utf-8")
    page, _ = show(path, color_scheme=scheme, bypass_csp=True)
    page.evaluate("() => { const { drive } = window.live; while (!drive.isOver) drive.go(); }")
    page.wait_for_timeout(100)
    for tab in ("whatif", "map", "chart", "result", "share"):
        page.click(f"#{tab}-tab")
        assert wrong(page, axe) == [], tab
