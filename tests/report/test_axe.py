"""All pages against WCAG 2.2 AA: light, dark, and with forced colours."""

from pathlib import Path
from typing import Any

import pytest

from orchestrator.cli import main
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.studies.live.page import live_page
from orchestrator.testing.catalogue.entries import select_standards
from orchestrator.testing.catalogue.show import write_catalogue
from orchestrator.testing.catalogue.verdicts import ClauseRun, verdicts_of

RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]
NARROW = ["scrollable-region-focusable"]
"""What a phone's width may break."""
RUN = """async (rules) => (await axe.run({ runOnly: rules })).violations
  .map((found) => [found.id, found.nodes.map((node) => [node.target.join(" "), (node.any[0] || {}).message])])"""
OPEN = """() => { for (const node of document.querySelectorAll("details")) node.open = true;
  const many = ["tbody tr", ".signals li", "svg rect"].map((kind) => `${kind}:nth-of-type(n+9)`);
  const more = document.querySelectorAll(many.join());
  for (const node of more) node.remove(); }"""
"""Rows further down are of the same kind."""
LOOKS = {
    "light": {"color_scheme": "light"},
    "dark": {"color_scheme": "dark"},
    "forced": {"color_scheme": "dark", "forced_colors": "active"},
}
LOOKED_AT = pytest.mark.parametrize(
    "look", ["light", *(pytest.param(look, marks=pytest.mark.release) for look in ("dark", "forced"))]
)
STUDY = """
name: trial
title: Two systems, three speeds
scenario: guo2015-case4
runs:
  grid:
    controller.system: [ntbpt, ntbptcwpt]
    "vehicle.driver.profile[1].speed": [0.6, 1.2, 1.8]
    car.steering.rate_limit: [570 deg/s, 1995 deg/s]
"""


@pytest.fixture(scope="module")
def axe() -> Any:
    package = pytest.importorskip("axe_core_python")
    (file,) = Path(package.__file__).parent.rglob("axe*.js")
    return file.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Any:
    path = tmp_path_factory.mktemp("study")
    (path / "trial.yaml").write_text(STUDY)
    assert main(["sweep", str(path / "trial.yaml"), "--out", str(path), "--replays", "0"]) == 0
    return path / "trial.html"


@pytest.fixture(scope="module")
def index(tmp_path_factory: pytest.TempPathFactory) -> Any:
    path = tmp_path_factory.mktemp("suite")
    main(["test", "guo2015-case4", "guo2015-case2", "--out", str(path)])
    return path / "index.html"


@pytest.fixture(scope="module")
def catalogue(tmp_path_factory: pytest.TempPathFactory) -> Any:
    path = tmp_path_factory.mktemp("catalogue") / "index.html"
    verdicts = verdicts_of(select_standards(["catalogue/unr79"]))
    for item in verdicts[::2]:
        item.tried.extend(
            ClauseRun(name, "parked", ["too fast"] * (item is verdicts[0]), []) for name in item.entry.scenarios
        )
    write_catalogue(path, verdicts, {"command": "apa test catalogue"})
    return path


def wrong(page: Any, axe: Any) -> Any:
    page.evaluate(axe)
    return page.evaluate(RUN, RULES)


@LOOKED_AT
@pytest.mark.parametrize("which", ["replay", "overlay", "study", "index", "catalogue"])
def test_pages(which: str, look: Any, show: Any, axe: Any, request: pytest.FixtureRequest) -> None:
    scripted = which in ("replay", "overlay")
    page, _ = show(request.getfixturevalue(which), bypass_csp=True, is_scripted=scripted, **LOOKS[look])
    if scripted:
        page.evaluate("() => { window.replay.setMark(1); window.replay.plots.chooser.open(null); }")
    page.evaluate(OPEN)
    assert wrong(page, axe) == []
    if look == "light":
        page.set_viewport_size({"width": 390, "height": 844})
        assert page.evaluate(RUN, {"type": "rule", "values": NARROW}) == []


@LOOKED_AT
def test_every_panel_of_the_page_that_is_driven(look: Any, show: Any, axe: Any, tmp_path: Path) -> None:
    path = tmp_path / "live.html"
    path.write_text(live_page([load_scenario("fault-pose-noise")]), encoding="utf-8")
    page, _ = show(path, bypass_csp=True, **LOOKS[look])
    page.evaluate("() => { const { drive } = window.live; while (drive.t < 3.0) drive.go(); }")
    page.click("#chart-tab")
    page.wait_for_selector(".deciding li")
    assert wrong(page, axe) == [], "chart"
    page.evaluate("() => { const { drive } = window.live; while (!drive.isOver) drive.go(); }")
    page.wait_for_timeout(100)
    for tab in ("whatif", "map", "result", "share"):
        page.click(f"#{tab}-tab")
        assert wrong(page, axe) == [], tab
    page.goto(f"{path.as_uri()}#only=controller.guo2015.k1")
    page.reload()
    page.wait_for_selector("html[data-ready]")
    assert wrong(page, axe) == [], "in a page of another"


def test_ribbons_and_legend_keep_their_colours_where_colours_are_forced(show: Any, replay: Any) -> None:
    page, _ = show(replay, forced_colors="active")
    shown = "(selector) => getComputedStyle(document.querySelector(selector)).backgroundColor"
    chips = page.evaluate(
        "() => [...document.querySelectorAll('#legend .chip i')].map((node) => getComputedStyle(node).backgroundColor)"
    )
    assert len(set(chips)) == len(chips) > 5
    assert page.evaluate(shown, ".span[data-state=PATH_TRACKING]") in chips
