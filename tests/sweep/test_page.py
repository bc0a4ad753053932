"""What a study's page and its numbers say."""

import json
import math
import re
from collections import Counter
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fmus.native.compilers import can_compile
from orchestrator.cli import main
from orchestrator.evaluation.verdict.confidence import wilson
from orchestrator.evaluation.verdict.limit_text import requirement_text
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.readable import readable
from orchestrator.presentation.log.read_log import read_info
from orchestrator.studies.parking.parking_world import study as parking_world
from orchestrator.studies.sweep import table as table_module
from orchestrator.studies.sweep.job import chunk_scenario
from orchestrator.studies.sweep.page.explorer import explorer_data
from orchestrator.studies.sweep.page.figures import SCALE, colour, histogram
from orchestrator.studies.sweep.page.page import study_page
from orchestrator.studies.sweep.page.picture import draw_maps
from orchestrator.studies.sweep.page.statistics import (
    axis,
    deciding_limit,
    influences,
    maps,
    outcome_counts,
    variance_share,
    varying_columns,
    worst,
)
from orchestrator.studies.sweep.table import Table

EVIL = "<script>window.evil = 1</script><img src=x onerror='window.evil = 1'>"
STUDY = """
name: trial
title: "<script>window.evil = 1</script><img src=x onerror='window.evil = 1'>"
scenario: guo2015-case4
runs:
  grid:
    controller.system: [ntbpt, ntbptcwpt]
    "vehicle.driver.profile[1].speed": [0.6, 1.2, 1.8]
    car.steering.rate_limit: [570 deg/s, 1995 deg/s]
  latin_hypercube: {n: 15, vehicle.start.y: {uniform: [-10 cm, 10 cm]}}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A finished study with its page and the replay of its worst run."""
    path = tmp_path_factory.mktemp("page")
    (path / "trial.yaml").write_text(STUDY)
    picture = ["--figure", str(path / "map.png")]
    assert main(["sweep", str(path / "trial.yaml"), "--out", str(path), "--replays", "1", *picture]) == 0
    return path


@pytest.fixture(scope="module")
def table(folder: Any) -> Any:
    return Table(folder / "trial.parquet")


class Page(HTMLParser):
    def __init__(self, text: Any) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, Any]]] = []
        self.feed(text)

    def handle_starttag(self, tag: Any, attrs: Any) -> None:
        self.tags.append((tag, dict(attrs)))


def test_the_page_needs_nothing_but_itself(folder: Any) -> None:
    text = (folder / "trial.html").read_text()
    tags = Page(text).tags
    assert [found.get("type") for tag, found in tags if tag == "script"] == ["application/json", None]
    assert all(not value.startswith(("http", "//")) for _, found in tags for value in found.values() if value)
    assert EVIL not in text
    assert len(text) < 300_000


@pytest.mark.skipif(not can_compile(), reason="no C compiler")
def test_runs_are_replayed_with_the_native_models(folder: Any) -> None:
    """In process a run of the parking controller takes some 25 times as long."""
    assert {fmu["kind"] for fmu in read_info(next(folder.glob("row-*/run.mcap")))["fmus"]} == {"native"}


def test_the_explorer_reads_each_part_of_a_table_and_its_scenario_once(
    folder: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    table, read = Table(folder / "trial.parquet"), Counter[Any]()

    def counted(made: Any, name: Any) -> Any:
        def call(*arguments: Any, **named: Any) -> Any:
            read[name or arguments] += 1
            return made(*arguments, **named)

        return call

    monkeypatch.setattr(table._file, "read_row_group", counted(table._file.read_row_group, None))
    monkeypatch.setattr(table_module, "Scenario", counted(Scenario, "scenario"))
    for number in range(table.count):
        deciding_limit(table, number)
    assert read == Counter(["scenario", *((group,) for group in range(table._file.num_row_groups))])
    assert table._file.num_row_groups > 1


def test_every_cell_of_the_map_tells_its_numbers(table: Any) -> None:
    text = study_page(table)
    assert text.count('class="cell"') == 2 * 3 * 2
    assert "of 15 parked (95 %:" in text


def test_the_page_lists_every_run_of_every_cell(table: Any) -> None:
    found = json.loads(explorer_data(table, maps(table), "trial-live.html"))
    rows = [row for item in found["maps"] for cell in item["cells"].values() for row in cell]
    assert sorted(rows) == list(range(table.count))
    for row in (0, table.count - 1):
        named = dict(zip(found["names"], found["values"][str(row)], strict=True))
        content = chunk_scenario(table.job, table.chunk(row), 0)
        for name, value in named.items():
            owner, _, parameter = name.partition(".")
            assert content.parameters_of(owner)[parameter] == value, name
        assert named["vehicle.ultrasonic.seed"] == table.row(row)["run_seed"]


@pytest.mark.slow
def test_cells_are_selected_and_zoomed_and_any_run_is_replayed(folder: Any, table: Any, show: Any) -> None:
    page, seen = show(folder / "trial.html", is_scripted=False, width=1440)
    cells = page.locator("figure[data-map] svg").first.locator("rect.cell")
    ends = [cells.nth(0).bounding_box(), cells.nth(4).bounding_box()]
    for number, box in enumerate(ends):
        page.mouse.move(box["x"] + 5, box["y"] + 5, steps=3)
        page.mouse.down() if number == 0 else page.mouse.up()
    assert page.locator("figure .runs tbody tr").count() == 4 * 15
    page.click("figure button:has-text('Zoom')")
    assert page.evaluate("() => window.study[0].cells.filter(({ node }) => node.style.display !== 'none').length") == 4
    page.click("figure button:has-text('Whole map')")
    assert page.evaluate("() => window.study[0].cells.filter(({ node }) => node.style.display !== 'none').length") == 6
    page.focus("figure[data-map] svg")
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Enter")
    assert page.locator("figure .runs tbody tr").count() == 15
    row = int(page.locator("figure .runs tbody td").first.inner_text())
    with page.context.expect_page() as opened:
        page.locator("figure .runs a").first.click()
    replay = opened.value
    replay.wait_for_selector("html[data-ready]")
    assert replay.evaluate("() => document.getElementById('notice').hidden && window.live.drive.isPlaying")
    whole = replay.evaluate("() => ({ outcome: window.live.whole.outcome, x: window.live.whole.numbers['final.x'] })")
    assert whole["outcome"] == table.row(row)["outcome"]
    assert whole["x"] == pytest.approx(table.row(row)["final.x"], abs=1e-9)
    assert seen.console == []


def test_the_worst_run_links_to_its_replay_and_every_one_has_its_command(folder: Any, table: Any) -> None:
    text = (folder / "trial.html").read_text()
    rows = worst(table, 12)
    assert f'href="row-{rows[0]}/report.html"' in text
    assert (folder / f"row-{rows[0]}" / "report.html").is_file()
    assert all(f"apa replay trial.parquet --row {row}<" in text for row in rows)
    assert table.row(rows[0])["limit_share"] == np.nanmax(table.column("limit_share"))


def test_no_unit_is_written_as_1(table: Any) -> None:
    text = re.sub(r"<script.*?</script>", "", study_page(table), flags=re.DOTALL)
    assert "shifts" in text
    assert not re.findall(r"[ >]\[1\]|\d 1[:,] ", text)


def test_maps_count_every_run_once(table: Any) -> None:
    shown = maps(table)
    assert [item.title for item in shown] == ["ntbptcwpt", "ntbpt"]
    assert sum(item.runs.sum() for item in shown) == table.count
    assert sum(item.done.sum() for item in shown) == (table.column("outcome") == "parked").sum()


def test_parameters_that_always_agree_are_shown_once(table: Any) -> None:
    assert "controller.car.steering.rate_limit" not in varying_columns(table)
    assert [item.name for item in influences(table)].count("vehicle.car.steering.rate_limit") == 1


def test_an_axis_with_many_values_is_cut_into_equal_bins(table: Any) -> None:
    cut = axis(table, "vehicle.driver.profile[1].speed")
    assert cut.labels == ["0.6", "1.2", "1.8"]
    np.testing.assert_allclose(cut.edges, [0.3, 0.9, 1.5, 2.1])
    assert axis(table, "vehicle.car.steering.rate_limit").unit == "deg/s"
    assert axis(table, "controller.system").labels == ["ntbptcwpt", "ntbpt"]


def test_the_picture_is_written(folder: Any) -> None:
    assert (folder / "map.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


@pytest.mark.parametrize(("name", "start"), [("map.svg", b"<?xml"), ("map.pdf", b"%PDF"), ("map.jpg", b"\xff\xd8")])
def test_the_picture_has_the_format_of_its_name_and_equal_bytes_each_time(
    name: str, start: bytes, table: Any, tmp_path: Path
) -> None:
    draw_maps(table, tmp_path / name)
    first = (tmp_path / name).read_bytes()
    assert first.startswith(start)
    if name == "map.pdf":
        draw_maps(table, tmp_path / name)
        assert (tmp_path / name).read_bytes() == first


def test_the_confidence_interval_is_wilsons() -> None:
    # Wilson 1927 as tabulated by Newcombe 1998, table I: 81 of 263, 15 of 148, 0 of 20, 1 of 29.
    for good, count, low, high in ((81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611)):
        np.testing.assert_allclose(wilson(good, count), (low, high), atol=5e-5)
    np.testing.assert_allclose(wilson(1, 29), (0.0061, 0.1718), atol=5e-5)


def test_the_share_of_variance_is_the_analytic_one() -> None:
    rng = np.random.default_rng(3)
    a, b = rng.integers(0, 5, 40_000), rng.integers(0, 5, 40_000)
    values = 3.0 * a + 1.0 * b
    assert abs(variance_share(values, a) - 0.9) < 0.01
    assert abs(variance_share(values, b) - 0.1) < 0.01
    assert variance_share(rng.random(40_000), a) < 0.001
    assert variance_share(np.ones(10), np.zeros(10, dtype=np.intp)) == 0.0
    assert math.isnan(variance_share(rng.random(10), np.arange(10)))


@pytest.fixture(scope="module")
def judged(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The table of a study that judges its runs itself, of few runs in which most factors differ."""
    path = tmp_path_factory.mktemp("judged")
    main(["sweep", "parking-world", "--runs", "40", "--seed", "5", "--out", str(path), "--no-page", "-q"])
    return Table(path / "parking-world.parquet")


def test_a_study_that_judges_its_runs_is_shown_by_its_own_judgement(judged: Table) -> None:
    ends, outcomes = (Counter(judged.column(name).tolist()) for name in ("end", "outcome"))
    assert ends["parked"] > outcomes["parked"] > 0
    counted: Counter[str] = Counter()
    for item in outcome_counts(judged):
        counted[item.outcome] += item.runs
        assert item.outcome != "parked" or not item.reason
    assert counted == ends
    page = study_page(judged)
    valid, parked = judged.column("valid") == 1.0, judged.column("end") == "parked"
    assert f"<dt>parked of valid</dt><dd>{(valid & parked).sum()} of {valid.sum()}</dd>" in page
    assert sum(int(item.done.sum()) for item in maps(judged)) == ends["parked"]
    assert [item.title for item in maps(judged)] == ["parallel", "perpendicular"]


def test_a_group_without_runs_has_no_share(judged: Table, monkeypatch: pytest.MonkeyPatch) -> None:
    everything = np.ones(judged.count, dtype=bool)
    monkeypatch.setattr(parking_world, "groups_of", lambda table: {"everything": everything, "nothing": ~everything})
    names = [line.split(":")[0] for line in parking_world.shares_of(judged)]
    assert "parked of valid, everything" in names
    assert "parked of valid, nothing" not in names


def test_factors_drawn_from_a_range_explain_no_run_by_itself(judged: Table) -> None:
    assert len(axis(judged, "heading").labels) < len(np.unique(judged.column("heading"))) == judged.count
    assert judged.note("extra")[0] == "m"
    assert all(item.share["parked"] < 0.99 for item in influences(judged))


def test_a_histogram_holds_every_run(table: Any) -> None:
    values = np.append(np.linspace(0.0, 1.0, 1000), [50.0, -50.0, np.nan])
    text = histogram(values, np.ones(len(values), dtype=bool), "x", "m", "parked")
    counts = [int(part.split(" parked")[0].rsplit(" ", 1)[-1]) for part in text.split("<title>")[1:]]
    assert sum(counts) == 1002


def test_colours_run_along_the_scale() -> None:
    assert (colour(0.0), colour(1.0), colour(-1.0), colour(2.0)) == (SCALE[0], SCALE[-1], SCALE[0], SCALE[-1])


@pytest.mark.parametrize("width", [1280, 390])
def test_the_page_in_a_browser(folder: Any, browser: Any, width: int) -> None:
    page = browser.new_page(viewport={"width": width, "height": 900})
    seen, requests = [], []
    page.on("console", lambda message: seen.append(message.text))
    page.on("request", lambda request: requests.append(request.url))
    page.goto((folder / "trial.html").as_uri())
    assert page.locator("svg rect.cell").first.bounding_box()["width"] > 20
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.evaluate("window.evil") is None
    assert seen == []
    assert requests == [(folder / "trial.html").as_uri()]
    page.close()


def test_the_outcomes_are_printed_with_their_share(folder: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", str(folder / "trial.yaml"), "--out", str(folder), "--resume", "--no-page"]) == 0
    lines = capsys.readouterr().out.splitlines()
    counts = outcome_counts(Table(folder / "trial.parquet"))
    assert sum(item.runs for item in counts) == Table(folder / "trial.parquet").count
    head = next(place for place, line in enumerate(lines) if line.split()[:2] == ["outcome", "reason"])
    first = lines[head + 1]
    assert first.startswith(counts[0].outcome)
    assert f" {counts[0].runs} " in first
    assert f"{100 * counts[0].share:.2f} %" in first


def test_the_deciding_limit_is_the_one_violated_most(table: Any) -> None:
    number = worst(table, 1)[0]
    row = table.row(number)
    found = deciding_limit(table, number)
    violations = {}
    for item in Scenario(**table.job.scenario).requirements:
        if item.required and row.get(item.signal) is not None and not isinstance(item.limit, str):
            beyond = item.limit - row[item.signal] if item.condition == "min" else abs(row[item.signal]) - item.limit
            violations[f"{item.id}: {readable(row[item.signal], 'm')} ({requirement_text(item)})"] = beyond / (
                abs(item.limit) or 1.0
            )
    assert found == max(violations, key=lambda key: violations[key])
    assert violations[found] > 0.0
