"""The built site: opened from a folder it searches, sets its formulas, and asks nothing of any other host."""

import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import pytest

from tests.docs.scripts import script

ROOT = Path(__file__).parents[2]
BUILT = ROOT / "site"
LIMIT = 30_000
PLACES = ("vehicle", "controller")
"""What the pages of the reference are called that say what a parameter is."""
SEEN = (
    "[...document.querySelectorAll('.md-search-result__article')].map((node) => node.textContent.trim().toLowerCase())"
)


FORMULAS = script("formulas")


def is_built() -> bool:
    """Return whether `make docs` has built the site from what the pages are now, as CI has before the tests."""
    index = BUILT / "index.html"
    pages = [
        ROOT / "mkdocs.yml",
        *(path for path in (ROOT / "docs").rglob("*") if path.suffix in (".md", ".py", ".js")),
    ]
    return index.exists() and index.stat().st_mtime > max(path.stat().st_mtime for path in pages)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Any:
    pytest.importorskip("material", reason="the theme of the site is not installed")
    if is_built():
        return BUILT
    folder = tmp_path_factory.mktemp("site")
    if not (ROOT / "docs" / "reference" / "vehicle.md").exists():
        subprocess.run([sys.executable, "docs/generate.py"], cwd=ROOT, check=True, capture_output=True)
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    return folder


SERIOUS = """async () => (await axe.run({ runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"] }))
  .violations
  .filter(({ impact }) => impact === "serious" || impact === "critical")
  .map(({ id, nodes }) => [id, nodes.map((node) => node.target.join(" "))])"""


def opened(browser: Any, path: Any) -> Any:
    page = browser.new_page()
    asked, said = [], []
    page.on("request", lambda request: asked.append(request.url))
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.goto(path.as_uri())
    return page, asked, said


def test_the_search_finds_parameters_by_their_names_from_a_folder(site: Any, browser: Any) -> None:
    page, asked, said = opened(browser, site / "guo2015.html")
    page.keyboard.press("f")
    for name in ("rate_limit", "reaction_delay", "complies_with_slow_down", "k4"):
        page.locator("input.md-search__input").fill("")
        page.locator("input.md-search__input").press_sequentially(name, delay=20)
        for _ in range(LIMIT // 100):
            found = page.evaluate(SEEN)
            if any(name in text for text in found) and any(text.startswith(PLACES) for text in found):
                break
            page.wait_for_timeout(100)
        assert any(name in text for text in found), name
        assert any(text.startswith(PLACES) for text in found), name
    assert [url for url in asked if not url.startswith(("file:", "data:", "blob:"))] == []
    assert said == []
    page.close()


TERMS = {
    "occupancy": "parking",
    "innovation": "parking",
    "covariance": "parking",
    "dead time": "vehicle",
    "turning circle": "vehicle",
    "wheelbase": "vehicle",
    "slip angle": "vehicle",
    "bicycle model": "vehicle",
    "falsification": "falsification",
    "Reeds-Shepp": "parking-planning",
    "collision check": "parking-planning",
    "look-ahead": "preview",
    "tracking error": "guo2015",
    "hysteresis": "guo2015",
    "clothoid": "adaptive",
    "SSP": "third-party-fmus",
    "regression test": "test-in-ci",
    "kerb": "scenario",
    "communication step": "use-in-your-tool",
    "Monte Carlo": "studies",
}
"""Term of the field -> the page that the search shows first."""
FIRST = "document.querySelector('.md-search-result__link')?.getAttribute('href') ?? ''"


def test_the_search_shows_the_page_of_each_term_first(site: Any, browser: Any) -> None:
    page, _, _ = opened(browser, site / "guo2015.html")
    page.keyboard.press("f")
    wrong = {}
    for term, name in TERMS.items():
        page.locator("input.md-search__input").fill("")
        page.locator("input.md-search__input").press_sequentially(term, delay=20)
        for _ in range(20):
            page.wait_for_timeout(100)
            found = page.evaluate(FIRST)
            if f"/{name}.html" in f"/{found}":
                break
        else:
            wrong[term] = found
    page.close()
    assert wrong == {}


def test_pages_load_nothing_from_elsewhere_and_formulas_are_formulas(site: Any, browser: Any) -> None:
    for name in ("index", "guo2015", "vehicle", "parking", "see-and-drive", "reference/controller"):
        page, asked, said = opened(browser, site / f"{name}.html")
        page.wait_for_timeout(300)
        assert [url for url in asked if not url.startswith(("file:", "data:", "blob:"))] == [], name
        assert said == [], name
        if name == "guo2015":
            assert page.locator("math").count() == 7
            assert page.locator("math mfrac").first.bounding_box()["height"] > 15
        page.close()


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_code_and_search_have_contrast(scheme: Any, site: Any, browser: Any) -> None:
    package = pytest.importorskip("axe_core_python")
    (file,) = Path(package.__file__).parent.rglob("axe*.js")
    context = browser.new_context(viewport={"width": 390, "height": 844}, bypass_csp=True, color_scheme=scheme)
    for name in ("index", "studies"):
        page = context.new_page()
        page.goto((site / f"{name}.html").as_uri())
        if name == "index":
            page.click("label[for=__search]")
            page.locator("input.md-search__input").press_sequentially("steering", delay=20)
            page.wait_for_selector(".md-search-result__item")
        page.evaluate("() => document.querySelectorAll('iframe').forEach((node) => node.remove())")
        page.evaluate(file.read_text(encoding="utf-8"))
        found = page.evaluate(SERIOUS)
        assert found == [], name
    context.close()


def test_pages_of_laws_have_the_page_that_is_driven(site: Any) -> None:
    if not (ROOT / "docs" / "reference" / "live.html").exists():
        pytest.skip("no compiler made the page that is driven")
    for name in ("guo2015", "parking-use", "preview", "hsic", "zhang2022", "adaptive"):
        frames = (site / f"{name}.html").read_text(encoding="utf-8").count('<iframe class="live" loading="lazy"')
        assert frames == (2 if name == "parking-use" else 1), name


def test_the_reference_has_a_heading_for_each_group(site: Any) -> None:
    text = (ROOT / "docs" / "reference" / "vehicle.md").read_text(encoding="utf-8")
    for group in ("### driver", "### steering", "### ultrasonic", "### manual"):
        assert f"\n{group}\n" in text, group


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("k1 = 2", "k1=2"),
        ("dx1/ds = -x2", "dx1ds=\u2212x2"),
        ("u' = V_s - (c V / S) u", "u\u2032=Vs\u2212(cVS)u"),
        ("e+ = e + a g / 2 (delta+ - delta_r)", "e+=e+ag2(\u03b4+\u2212\u03b4r)"),
    ],
)
def test_formulas_are_read_as_they_are_meant(text: str, shown: str) -> None:
    found = ElementTree.fromstring(f"<math>{FORMULAS.mathml(text)}</math>")
    assert "".join(found.itertext()) == shown


def test_a_power_an_index_a_root_and_a_fraction() -> None:
    found = FORMULAS.mathml("sqrt(cos^3 h_r / 2)")
    assert "<msup><mrow><mi>cos</mi></mrow><mn>3</mn></msup>" in found
    assert "<msub><mi>h</mi><mi>r</mi></msub>" in found
    assert found.count("<mfrac>") == 1
    assert found.count("<msqrt>") == 1


@pytest.mark.parametrize("text", ["apa run guo2015-case4", "x = (a", "a = 3 +", "phase: int = 1", "x = y # why"])
def test_what_is_no_formula_stays_text(text: str) -> None:
    assert FORMULAS.formulas(f"    {text}\n") == ""
