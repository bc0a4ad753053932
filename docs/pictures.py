"""Writes docs/images: the pages of this project as a headless Chromium shows them. ``python -m docs.pictures``.

Needs Chromium (or Chrome) and the package playwright; the pictures are kept in the repository.
"""

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright

from orchestrator.cli import main as apa
from tests.conftest import FLAGS, chromium

IMAGES = Path(__file__).parent / "images"
RESULTS_TOP = 195
"""Where the results of `apa test` begin on their page; what stands above names folders of this machine."""
GENTLE = ["--set", "vehicle.driver.profile=[[0, 0.8]]", "--set", "vehicle.driver.complies_with_slow_down=true"]


def main() -> None:
    """Run, open, photograph."""
    IMAGES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as play:
        runs = make_runs(Path(folder))
        program = chromium() or sys.exit("no Chromium found")
        browser = play.chromium.launch(executable_path=program, args=FLAGS)
        wide = {"viewport": {"width": 1440, "height": 900}}
        photograph(browser, runs["report"], "report", "#t=14.5", wide)
        photograph(browser, runs["report"], "report-dark", "#t=14.5", {**wide, "color_scheme": "dark"})
        photograph(browser, runs["apa"], "report-apa", "#t=22", wide)
        photograph(browser, runs["compare"], "compare", "#t=9", wide)
        photograph(browser, runs["tests"], "tests", "", {"viewport": {"width": 1300, "height": 800}}, top=RESULTS_TOP)
        live_pictures(browser, runs["live"], wide)
        browser.close()


def live_pictures(browser: Any, path: Path, wide: dict[str, Any]) -> None:
    """Write the pictures of the live page: with a changed parameter, and its chart."""

    def slower(page: Any) -> None:
        page.fill('[id="p-vehicle.driver.profile[1].speed"]', "1.1")
        page.keyboard.press("Tab")

    def charted(page: Any) -> None:
        page.click("#chart-tab")
        page.evaluate(
            "() => { const { drive } = window.live; while (drive.state('controller.phase') !== 'TO_Q2') drive.go(); }"
        )

    photograph(browser, path, "live", "#s=guo2015-case4-105", wide, slower)
    photograph(browser, path, "live-chart", "#s=guo2015-case4-105", wide, charted)


def make_runs(folder: Path) -> dict[str, Path]:
    """Return the pages to photograph, made by the commands a user would give."""
    case4, gentle = folder / "case4", folder / "gentle"
    apa(["run", "guo2015-case4", "--fmus", "none", "--out", str(case4)])
    apa(["run", "guo2015-case4", "--fmus", "none", "--no-page", "--out", str(gentle), *GENTLE])
    apa(["run", "apa-parallel", "--fmus", "none", "--out", str(folder / "apa")])
    overlay = folder / "overlay.html"
    limits = ["--abs", "0.01", "--time", "0.2"]
    apa(["compare", str(case4 / "run.mcap"), str(gentle / "run.mcap"), "--html", str(overlay), *limits])
    apa(["test", "guo2015-*", "fault-*", "--fmus", "none", "--out", str(folder / "tests")])
    apa(["live", "--out", str(folder / "live.html")])
    return {
        "live": folder / "live.html",
        "report": case4 / "report.html",
        "apa": folder / "apa" / "report.html",
        "compare": overlay,
        "tests": folder / "tests" / "index.html",
    }


def photograph(
    browser: Any,
    path: Path,
    name: str,
    fragment: str,
    options: dict[str, Any],
    act: Callable[[Any], None] | None = None,
    top: int = 0,
) -> None:
    """Write docs/images/``name``.png of a page at a moment, or after ``act``; ``top``: pixels left out above."""
    context = browser.new_context(**options)
    page = context.new_page()
    page.goto(path.as_uri() + fragment)
    if fragment:
        page.wait_for_selector("html[data-ready]")
        if act is not None:
            act(page)
        page.wait_for_timeout(300 if act is None else 1000)
    size = options["viewport"]
    part = {"x": 0, "y": top, "width": size["width"], "height": size["height"] - top}
    page.screenshot(path=IMAGES / f"{name}.png", clip=part)
    context.close()
    print(f"docs/images/{name}.png")


if __name__ == "__main__":
    main()
