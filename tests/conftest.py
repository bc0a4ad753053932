"""What all tests share: one browser a process, order and marks by cost, no clock over drawn examples, ``--update``."""

import gc
import os
import shutil
from collections.abc import Generator, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

from tests.costs import CostMeter, CostTable, cost_of_files, function_of, is_slow, read_costs

settings.register_profile("no clock", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("no clock")

COST_IN_BROWSER = 1.0
"""Of a test in a browser at least [s]."""
FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


def chromium() -> str | None:
    """Return the path of an installed Chromium or Chrome."""
    names = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
    return next((path for path in map(shutil.which, names) if path), None)


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """A headless Chromium; without one the tests that need it are skipped."""
    program = chromium()
    if program is None:
        pytest.skip("no Chromium found (Debian: apt-get install chromium)")
    api = pytest.importorskip("playwright.sync_api", reason="the package playwright is not installed")
    with api.sync_playwright() as play:
        session = play.chromium.launch(executable_path=program, args=FLAGS)
        yield session
        session.close()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let the records of the shipped scenarios and of the tests' cost be written anew."""
    parser.addoption("--update", action="store_true", help="write tests/golden/scenarios.yaml anew")
    parser.addoption("--costs", action="store_true", help="measure the tests and write tests/costs.tsv anew")


def pytest_configure(config: pytest.Config) -> None:
    """Measure cost where tests run, add it up where they were started; trust the files that tests write."""
    os.environ["APA_TRUST"] = "all"
    _share_rewriting(config)
    if config.getoption("costs"):
        config.pluginmanager.register(CostMeter())
        if not hasattr(config, "workerinput"):
            config.pluginmanager.register(CostTable())


@pytest.hookimpl(wrapper=True, optionalhook=True)
def pytest_xdist_auto_num_workers() -> Generator[None, int, int]:
    """Return one worker more than processors: a fifth of its time it waits, for browsers, locks and killed commands."""
    return (yield) + 1


def _share_rewriting(config: pytest.Config) -> None:
    """Have each worker begin to collect at another folder, so that it finds what others have compiled.

    In a fresh clone pytest takes ten seconds to rewrite the asserts of all files; else each worker would do it.
    """
    if not hasattr(config, "workerinput") or config.args != ["tests"]:
        return
    number, count = int(config.workerinput["workerid"].removeprefix("gw")), config.workerinput["workercount"]
    folder = Path(config.rootpath, "tests")
    paths = sorted(str(path) for path in (*folder.glob("test_*.py"), *folder.glob("[a-z]*/")))
    begin = len(paths) * number // count
    config.args[:] = paths[begin:] + paths[:begin]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the slow tests by their recorded cost, and run the files that cost most first, in the same order everywhere.

    What only a release runs comes last. A browser takes time of processes that nobody waits for, so that no cost is
    recorded for it.
    """
    costs = read_costs()
    run_costs: dict[str, float] = {}
    for item in items:
        name, is_in_browser = function_of(item.nodeid), "browser" in getattr(item, "fixturenames", ())
        if item.get_closest_marker("release"):
            item.add_marker(pytest.mark.slow)
            continue
        if is_in_browser or is_slow(item.nodeid, costs):
            item.add_marker(pytest.mark.slow)
        run_costs[name] = max(run_costs.get(name, 0.0), costs.get(name, 0.0), COST_IN_BROWSER * is_in_browser)
    files, with_release = cost_of_files(run_costs), cost_of_files(costs)

    def order(item: pytest.Item) -> tuple[float, float, str]:
        file = _file_of(item).removeprefix("tests/")
        return -files.get(file, 0.0), -with_release.get(file, 0.0), file

    items.sort(key=order)


def _file_of(item: pytest.Item) -> str:
    return item.nodeid.split("::")[0]


def pytest_collection_finish() -> None:
    """Search for garbage seldom, and not in what was imported and collected: half a million objects that stay."""
    gc.freeze()
    gc.set_threshold(50_000)


class Seen:
    """What a page did that it should not have done."""

    def __init__(self, page: Any) -> None:
        self.console: list[str] = []
        self.requests: list[str] = []
        self.listeners = {
            "console": lambda message: self.console.append(f"{message.type}: {message.text}"),
            "pageerror": lambda error: self.console.append(f"error: {error}"),
            "request": lambda request: self.requests.append(request.url),
        }
        for event, listener in self.listeners.items():
            page.on(event, listener)


class BrowserPages:
    """Empty pages of a browser, kept between tests: making one takes longer than loading most files."""

    def __init__(self, browser: Any) -> None:
        self.browser = browser
        self.free: dict[str, list[Any]] = {}
        """Options of the context, as text -> its pages that no test has now."""

    def borrow(self, options: dict[str, Any], is_own: bool) -> Any:
        """Return a page; ``is_own``: of a context that nobody had before."""
        free = self.free.get(repr(options))
        return free.pop() if free and not is_own else self.browser.new_context(**options).new_page()

    def give_back(self, page: Any, options: dict[str, Any], seen: Seen) -> None:
        """Leave the file, put size and pointer back, and keep the page for another test."""
        for event, listener in seen.listeners.items():
            page.remove_listener(event, listener)
        page.set_viewport_size(options["viewport"])
        page.mouse.move(0, 0)
        page.goto("about:blank")
        self.free.setdefault(repr(options), []).append(page)


@pytest.fixture(scope="session")
def browser_pages(browser: Any) -> BrowserPages:
    return BrowserPages(browser)


@pytest.fixture
def show(browser_pages: BrowserPages) -> Iterator[Any]:
    """Open a page file: returns (page, what it did); left after the test.

    ``is_own``: in a context that no other test has, for one that changes the clock of its pages.
    """
    borrowed: list[tuple[Any, dict[str, Any], Seen, bool]] = []

    def opened(
        path: Path,
        fragment: str = "",
        width: int = 1280,
        height: int = 900,
        is_scripted: bool = True,
        is_own: bool = False,
        **options: Any,
    ) -> tuple[Any, Seen]:
        options["viewport"] = {"width": width, "height": height}
        page = browser_pages.borrow(options, is_own)
        seen = Seen(page)
        borrowed.append((page, options, seen, is_own))
        page.goto(path.as_uri() + fragment)
        if is_scripted:
            page.wait_for_selector("html[data-ready]", timeout=120_000)
        return page, seen

    yield opened
    for page, options, seen, is_own in borrowed:
        if is_own:
            page.context.close()
        else:
            browser_pages.give_back(page, options, seen)
