"""One browser for all tests of pages that a process runs."""

import shutil
from collections.abc import Iterator
from typing import Any

import pytest

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
