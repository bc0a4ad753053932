"""The page that is driven: size, start, whole runs a second against native ones, frames and processor share of a drive.

In a headless Chromium, if there is one. Case 4; the native runs are the batch on one thread.
"""

import tempfile
import time
from pathlib import Path
from typing import Any

from benchmarks.bench_sweep import bound
from benchmarks.results import SKIPPED, record, size
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.studies.live.map_code import map_code
from orchestrator.studies.live.page import live_page
from orchestrator.studies.live.situation import page_scenarios
from orchestrator.studies.sweep.batch import run_batch
from tests.conftest import FLAGS, chromium

RUNS, SECONDS = size((300, 6.0), (5, 0.2))
MANY = """async ([count, isComplete]) => {
  const lab = await startMapLab(window.live.map.parts);
  lab.load(window.live.lab.situation.data.name);
  const params = lab.situation.params(), { times } = lab.situation.data;
  const course = isComplete ? lab.whole : lab.openForMap();
  for (let i = 0; i < 20; i++) course.run(params, times, 1 << 30);
  const begun = performance.now();
  for (let i = 0; i < count; i++) course.run(params, times, 1 << 30);
  return (performance.now() - begun) / 1000;
}"""
FRAMES = """() => { window.frames_seen = 0; const one = () => { window.frames_seen++; requestAnimationFrame(one); };
  requestAnimationFrame(one); window.live.toggle(); }"""


def main() -> None:
    """Print what was measured."""
    program = chromium()
    if program is None:
        print("skipped: no Chromium is installed")
        raise SystemExit(SKIPPED)
    from playwright.sync_api import sync_playwright

    path = Path(tempfile.mkdtemp()) / "live.html"
    scenarios = page_scenarios()
    path.write_text(live_page(scenarios, map_code(scenarios)), encoding="utf-8")
    one = len(live_page([load_scenario("guo2015-case4")]).encode())
    print(f"page: {path.stat().st_size / 1e3:.0f} kB with all scenarios, {one / 1e3:.0f} kB with one")
    record("page with one scenario", one / 1e3, "kB")
    native = _native()
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=program, args=FLAGS)
        page = browser.new_page()
        begun = time.perf_counter()
        page.goto(path.as_uri())
        page.wait_for_selector("html[data-ready]")
        ready = time.perf_counter() - begun
        print(f"open to ready: {ready:.2f} s, of that {page.evaluate('live.took'):.0f} ms in its script")
        rate, complete = (RUNS / min(page.evaluate(MANY, [RUNS, whole]) for _ in range(3)) for whole in (False, True))
        print(f"case 4: {rate:.0f} runs/s of a map, {complete:.0f} of complete models in the page")
        print(f"{native:.0f} native on one thread, ratio {complete / native:.2f}")
        record("case-4 runs of a map in the page", rate, "1/s")
        record("case-4 runs of complete models in the page", complete, "1/s")
        record("rate in the page / native on one thread", complete / native, "1")
        _drive(page)
        browser.close()


def _native() -> float:
    job, chunk = bound(RUNS)
    run_batch(job, chunk)
    times = []
    for _ in range(3):
        begun = time.perf_counter()
        run_batch(job, chunk)
        times.append(time.perf_counter() - begun)
    return RUNS / min(times)


def _drive(page: Any) -> None:
    session = page.context.new_cdp_session(page)
    session.send("Performance.setTimeDomain", {"timeDomain": "threadTicks"})  # processor time, not the wall's
    session.send("Performance.enable")
    page.evaluate(FRAMES)
    before, begun = _metrics(session), time.perf_counter()
    page.wait_for_timeout(SECONDS * 1000)
    after, took = _metrics(session), time.perf_counter() - begun
    frames = page.evaluate("window.frames_seen") / took
    share = (after["TaskDuration"] - before["TaskDuration"]) / took
    record("share of one core, driven at 1x", 100.0 * share, "%")
    print(f"driven at 1x: {frames:.0f} frames/s, {share:.0%} of one core in the page's own thread")


def _metrics(session: Any) -> dict[str, float]:
    return {item["name"]: item["value"] for item in session.send("Performance.getMetrics")["metrics"]}


if __name__ == "__main__":
    main()
