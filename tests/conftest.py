"""What all tests share: one browser a process, which files are slow, no clock over drawn examples, ``--update``."""

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

settings.register_profile("no clock", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("no clock")

SLOW = [
    "compiler/test_model_bits.py",
    "compiler/test_readable.py",
    "controller/test_apa_outline.py",
    "controller/test_apa_parking.py",
    "controller/test_apa_planner.py",
    "controller/test_apa_search.py",
    "controller/test_guo_parking.py",
    "controller/test_guo_prompts.py",
    "controller/test_preview_drive.py",
    "controller/test_preview_fuzzy.py",
    "controller/test_zhang_qp.py",
    "coverage/test_branches.py",
    "coverage/test_coverage.py",
    "coverage/test_every_transition.py",
    "docs/test_commands.py",
    "docs/test_docs.py",
    "docs/test_extend.py",
    "face/test_face.py",
    "fmi/test_c_library.py",
    "fmi/test_fmi3_fmu.py",
    "fmi/test_importers.py",
    "fmi/test_native_fmu.py",
    "fmi/test_native_host.py",
    "fmi/test_native_platforms.py",
    "fmi/test_own_model.py",
    "fmi/test_places.py",
    "fmi/test_python_fmu.py",
    "fmi/test_python_fmu_errors.py",
    "fmi/test_python_fmu_file.py",
    "fmi/test_python_fmu_isolation.py",
    "fmi/test_python_front.py",
    "fmi/test_sources.py",
    "fmi/test_system_fmus.py",
    "fmi/test_tunable.py",
    "fuzz/test_places.py",
    "golden/test_golden.py",
    "hunt/test_hunt.py",
    "live/test_module.py",
    "live/test_page.py",
    "modelkit/test_geometry.py",
    "mutants/test_mutants.py",
    "orchestrator/test_bad_fmus.py",
    "orchestrator/test_cars_park.py",
    "orchestrator/test_catalogue.py",
    "orchestrator/test_check_and_test.py",
    "orchestrator/test_cli.py",
    "orchestrator/test_ends.py",
    "orchestrator/test_export.py",
    "orchestrator/test_figure.py",
    "orchestrator/test_fmu_check.py",
    "orchestrator/test_fmu_slave.py",
    "orchestrator/test_folders.py",
    "orchestrator/test_foreign.py",
    "orchestrator/test_new.py",
    "orchestrator/test_new_ci.py",
    "orchestrator/test_recover.py",
    "orchestrator/test_ssp.py",
    "orchestrator/test_system.py",
    "papers/test_apa.py",
    "papers/test_apa_grid.py",
    "papers/test_apa_world.py",
    "papers/test_bakeoff.py",
    "papers/test_guo2015.py",
    "papers/test_hsic.py",
    "papers/test_kinds.py",
    "papers/test_preview.py",
    "papers/test_zhang2022.py",
    "planning/test_compiled.py",
    "report/test_axe.py",
    "report/test_browser.py",
    "report/test_scripts.py",
    "steptest/test_pytest_plugin.py",
    "stream/test_stream.py",
    "sweep/test_batch.py",
    "sweep/test_dask.py",
    "sweep/test_page.py",
    "sweep/test_resume.py",
    "test_benchmarks.py",
    "test_wheel.py",
    "twin/test_compiled_master.py",
    "twin/test_container.py",
    "twin/test_interop.py",
    "twin/test_same_bits.py",
    "valet/test_valet.py",
    "valet/test_valet_scenarios.py",
    "valet/test_valet_search.py",
    "valet/test_valet_state.py",
    "vehicle/test_double_track.py",
    "vehicle/test_scene.py",
    "vehicle/test_tires.py",
    "vehicle/test_vehicle.py",
]
"""Files of tests that take over 3 s of the processor; ``make quick`` leaves them out, and what is marked slow."""
LONGEST = [
    "docs/test_commands.py",
    "test_wheel.py",
    "fmi/test_native_platforms.py",
    "fmi/test_sources.py",
    "docs/test_extend.py",
    "twin/test_container.py",
    "twin/test_interop.py",
    "live/test_module.py",
    "coverage/test_every_transition.py",
    "orchestrator/test_catalogue.py",
    "golden/test_golden.py",
]
"""Run first, then the other slow ones: at the end no core waits long for another."""
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
    """Let the record of the shipped scenarios be written anew."""
    parser.addoption("--update", action="store_true", help="write tests/golden/scenarios.yaml anew")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the tests of slow files, and run them first."""
    here = Path(__file__).parent
    order = {name: place for place, name in enumerate([*LONGEST, *(name for name in SLOW if name not in LONGEST)])}

    def place_of(item: pytest.Item) -> int:
        name = item.path.relative_to(here).as_posix() if item.path.is_relative_to(here) else ""
        return order.get(name, len(order))

    for item in items:
        if place_of(item) < len(order) or item.get_closest_marker("release"):
            item.add_marker(pytest.mark.slow)
    items.sort(key=place_of)


class Seen:
    """What a page did that it should not have done."""

    def __init__(self, page: Any) -> None:
        self.console: list[str] = []
        self.requests: list[str] = []
        page.on("console", lambda message: self.console.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: self.console.append(f"error: {error}"))
        page.on("request", lambda request: self.requests.append(request.url))


@pytest.fixture
def show(browser: Any) -> Iterator[Any]:
    """Open a page file: returns (page, what it did); closed after the test."""
    contexts = []

    def opened(
        path: Path, fragment: str = "", width: int = 1280, height: int = 900, is_scripted: bool = True, **options: Any
    ) -> tuple[Any, Seen]:
        context = browser.new_context(viewport={"width": width, "height": height}, **options)
        contexts.append(context)
        page = context.new_page()
        seen = Seen(page)
        page.goto(path.as_uri() + fragment)
        if is_scripted:
            page.wait_for_selector("html[data-ready]", timeout=20_000)
        return page, seen

    yield opened
    for context in contexts:
        context.close()
