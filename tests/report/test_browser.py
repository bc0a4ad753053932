"""The replay page in a real browser: it renders, plays, obeys the keyboard, asks nothing of any network."""

import csv
import math
import re
from pathlib import Path
from typing import Any

import pytest
from matplotlib.image import imread

from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.presentation.report.replay import replay_page
from tests.native_runs import native_recording

CIRCLES = Path(__file__).with_name("circles.yaml")
CLOCK = "window.replay.t"


def until(page: Any, condition: str) -> None:
    """Wait for a condition; the page's policy forbids Playwright's own way, which is eval."""
    for _ in range(400):
        if page.evaluate(condition):
            return
        page.wait_for_timeout(25)
    raise AssertionError(f"never true: {condition}")


def pick(page: Any, name: str) -> None:
    """Choose a signal from the list."""
    page.fill(".chooser input", name)
    page.locator(".signals button", has=page.get_by_text(name, exact=True)).click()


def shades(page: Any) -> int:
    """Return how many different colours the top view has."""
    return page.evaluate(
        """() => { const c = document.getElementById('view'), g = c.getContext('2d');
        return new Set(new Uint32Array(g.getImageData(0, 0, c.width, c.height).data.buffer)).size; }"""
    )


def test_page_renders_without_a_request_or_a_complaint(show: Any, replay: Any) -> None:
    page, seen = show(replay)
    assert shades(page) > 20
    assert page.locator(".plot canvas").count() >= 5
    assert page.locator(".pill.good").count() >= 6
    assert page.locator("#verdict").inner_text() == "parked"
    assert {"pre steer", "to Q2", "to Q1", "parked"} <= set(page.locator("#legend .chip").all_inner_texts())
    page.wait_for_timeout(300)
    assert seen.console == []
    assert seen.requests == [replay.as_uri()]


def test_plays_moves_the_car_and_stops_at_the_end(show: Any, replay: Any) -> None:
    page, seen = show(replay)
    start = page.evaluate("document.getElementById('view').toDataURL()")
    page.select_option("#speed", "16")
    page.click("#play")
    until(page, "window.replay.playing && window.replay.t > 3")
    assert page.locator("#play").inner_text() == "Pause"
    assert page.evaluate("document.getElementById('view').toDataURL()") != start
    until(page, "!window.replay.playing")
    assert page.evaluate(f"{CLOCK} === window.replay.duration")
    assert page.locator("#play").inner_text() == "Play"
    assert seen.console == []


def test_keyboard(show: Any, replay: Any) -> None:
    page, _ = show(replay)
    page.keyboard.press("End")
    assert page.evaluate(f"{CLOCK} === window.replay.duration")
    page.keyboard.press("Home")
    assert page.evaluate(CLOCK) == 0
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Shift+ArrowRight")
    assert page.evaluate(CLOCK) == pytest.approx(1.1)
    page.keyboard.press("ArrowLeft")
    assert page.evaluate(CLOCK) == pytest.approx(1.0)
    page.keyboard.press(">")
    assert page.input_value("#speed") == "2"
    page.keyboard.press("<")
    page.keyboard.press("<")
    assert page.input_value("#speed") == "0.5"
    page.keyboard.press(" ")
    assert page.evaluate("window.replay.playing")
    page.keyboard.press(" ")
    assert not page.evaluate("window.replay.playing")


def test_links_lead_to_the_moment_of_the_worst_value(show: Any, replay: Any, case4: Any) -> None:
    page, _ = show(replay)
    speed = next(check for check in case4[1].checks if check.signal == "vehicle.speed")
    page.locator("#checks tr", has_text="speed").locator("a.moment").click()
    assert page.evaluate(CLOCK) == pytest.approx(speed.t, abs=1e-3)
    assert page.evaluate("window.replay.page.runs[0].at('vehicle.speed', window.replay.t)") == pytest.approx(
        speed.value
    )


def test_fragment_opens_at_a_moment(show: Any, replay: Any) -> None:
    page, _ = show(replay, "#t=9.25")
    assert page.evaluate(CLOCK) == 9.25
    assert page.locator("#clock").inner_text().startswith("9.25")


def test_timeline_and_plots_are_scrubbers(show: Any, replay: Any) -> None:
    page, _ = show(replay)
    box = page.locator(".lane:first-child .track").bounding_box()
    page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 5)
    assert page.evaluate(f"{CLOCK} / window.replay.duration") == pytest.approx(0.5, abs=0.01)
    over = page.locator(".u-over").first.bounding_box()
    page.mouse.click(over["x"] + 0.25 * over["width"], over["y"] + 20)
    assert page.evaluate(f"{CLOCK} / window.replay.duration") == pytest.approx(0.25, abs=0.01)


def test_zoom_of_one_plot_is_the_zoom_of_all(show: Any, replay: Any) -> None:
    page, _ = show(replay)
    over = page.locator(".u-over").first.bounding_box()
    y = over["y"] + 30
    page.mouse.move(over["x"] + 0.2 * over["width"], y)
    page.mouse.down()
    page.mouse.move(over["x"] + 0.6 * over["width"], y, steps=4)
    page.mouse.up()
    ranges = page.evaluate("window.replay.plots.all.map((item) => [item.u.scales.x.min, item.u.scales.x.max])")
    duration = page.evaluate("window.replay.duration")
    assert all(pair == ranges[0] for pair in ranges)
    assert ranges[0][0] == pytest.approx(0.2 * duration, rel=0.03)
    assert ranges[0][1] == pytest.approx(0.6 * duration, rel=0.03)


def test_any_signal_can_be_plotted_and_removed(show: Any, replay: Any) -> None:
    page, seen = show(replay)
    before = page.locator(".plot").count()
    pick(page, "vehicle.distance")
    assert page.locator(".plot").count() == before + 1
    page.locator(".plot .close").last.click()
    assert page.locator(".plot").count() == before
    assert seen.console == []


def test_the_list_has_what_changes_first_and_finds_by_meaning(show: Any, replay: Any) -> None:
    page, _ = show(replay)
    page.focus(".chooser input")
    assert page.locator(".signals button").first.get_attribute("class") == ""
    page.fill(".chooser input", "preview")
    assert page.locator(".signals button.still").count() == page.locator(".signals button").count() > 3
    page.fill(".chooser input", "advised with the prompt")
    found = ["controller.advised_speed", "vehicle.advised_speed"]
    assert page.locator(".signals code").all_inner_texts() == found
    page.keyboard.press("Escape")
    assert page.locator(".signals button").count() == 0


def test_several_signals_and_two_units_in_one_plot_but_not_three(show: Any, replay: Any) -> None:
    page, seen = show(replay)
    plot = "window.replay.plots.all[0]"
    page.locator(".plot .more").first.click()
    pick(page, "vehicle.steering_wheel_angle")
    assert page.evaluate(f"{plot}.spec.signals").count("vehicle.steering_wheel_angle") == 1
    assert page.evaluate(f"{plot}.units") == ["m/s", "deg"]
    assert page.evaluate(f"{plot}.u.axes.length") == 3
    page.locator(".plot .more").first.click()
    page.fill(".chooser input", "vehicle.pose.x")
    assert page.locator(".signals button").first.is_disabled()
    page.locator(".plot").first.locator(".drop").last.click()
    assert page.evaluate(f"{plot}.units") == ["m/s"]
    assert seen.console == []


def test_two_cursors_and_their_difference(show: Any, replay: Any) -> None:
    page, _ = show(replay, "#t=4")
    page.keyboard.press("m")
    page.keyboard.press("Shift+ArrowRight")
    assert page.text_content("#clock").startswith("5.00 / ")
    assert "\u0394 +1.00 s" in page.text_content("#clock")
    change = page.evaluate("((x) => x(5) - x(4))((t) => window.replay.page.runs[0].at('vehicle.pose.x', t))")
    cell = page.evaluate(
        "window.replay.plots.all.flatMap((p) => p.cells).find((c) => c.name === 'vehicle.pose.x').value.textContent"
    )
    assert float(cell.split("\u0394")[1].replace("\u2212", "-")) == pytest.approx(change, abs=1e-3)
    assert page.locator(".head.other:visible").count() >= 3
    page.keyboard.press("Escape")
    assert "\u0394" not in page.text_content("#clock")
    assert page.locator(".head.other:visible").count() == 0


def test_zoom_keys_and_buttons_do_what_they_show(show: Any, replay: Any) -> None:
    page, _ = show(replay, "#t=6")
    scale, shown = "window.replay.scene.scale", "window.replay.plots.range"
    first, whole = page.evaluate(scale), page.evaluate(shown)
    page.keyboard.press("+")
    assert page.evaluate(scale) == pytest.approx(1.4 * first)
    page.keyboard.press("-")
    assert page.evaluate(scale) == pytest.approx(first)
    page.click("#zoom-in")
    page.keyboard.press("z")
    page.click("#time-in")
    low, high = page.evaluate(shown)
    assert high - low == pytest.approx((whole[1] - whole[0]) / 1.6**2, rel=1e-6)
    assert low < 6.0 < high
    page.keyboard.press("f")
    assert page.evaluate(scale) == pytest.approx(first)
    assert page.evaluate(shown) == whole


def test_a_double_click_shows_all_and_goes_nowhere(show: Any, replay: Any) -> None:
    page, _ = show(replay, "#t=6")
    whole = page.evaluate("window.replay.plots.range")
    page.click("#time-in")
    over = page.locator(".u-over").first.bounding_box()
    page.mouse.dblclick(over["x"] + 0.7 * over["width"], over["y"] + 20)
    assert page.evaluate("window.replay.plots.range") == whole
    assert page.evaluate(CLOCK) == 6.0


def test_picture_table_and_video_to_take_home(show: Any, replay: Any, tmp_path: Path) -> None:
    page, seen = show(replay, "#t=5")
    page.select_option("#speed", "8")
    files = {}
    for what in ("png", "csv", "video"):
        with page.expect_download(timeout=30_000) as handed:
            page.click(f"#{what}")
        files[what] = tmp_path / handed.value.suggested_filename
        handed.value.save_as(files[what])
    assert files["png"].read_bytes()[:4] == b"\x89PNG"
    assert imread(files["png"])[..., :3].std() > 0.05
    assert files["video"].read_bytes()[:4] == b"\x1a\x45\xdf\xa3"  # EBML: WebM
    assert files["video"].stat().st_size > 20_000
    heads, *rows = list(csv.reader(files["csv"].read_text(encoding="utf-8").splitlines()))
    column = heads.index("vehicle.speed [m/s]")
    row = next(row for row in rows if float(row[0]) >= 5.0)
    said = page.evaluate("(t) => window.replay.page.runs[0].at('vehicle.speed', t)", float(row[0]))
    assert float(row[column]) == pytest.approx(said, rel=1e-6)
    assert seen.console == []


def test_somebody_who_comes_and_goes_is_no_grey_box(show: Any, tmp_path: Path) -> None:
    recording = native_recording("apa-pedestrian", "stop_time=14")
    path = tmp_path / "report.html"
    path.write_text(replay_page(recording, summarize(recording, load_scenario("apa-pedestrian"), 1.0), []))
    page, _ = show(path, "#t=5")
    skin = """() => { const c = document.getElementById('view'), g = c.getContext('2d');
        const d = new Uint32Array(g.getImageData(0, 0, c.width, c.height).data.buffer);
        return d.filter((pixel) => pixel === 0xffa1c9f2).length; }"""
    assert page.evaluate(skin) == 0
    page.evaluate("window.replay.seek(13)")
    assert page.evaluate(skin) > 10


def test_a_run_of_which_few_instants_are_kept_has_its_turns_and_no_path_across_them(
    show: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    changes = "stop_time=200", "vehicle.driver.profile=[{at: 0, speed: 2}]"
    recording, scenario = native_recording(str(CIRCLES), *changes), load_scenario(str(CIRCLES), list(changes))
    monkeypatch.setattr("orchestrator.presentation.report.replay.MOST_ROWS", (12,))
    path = tmp_path / "report.html"
    path.write_text(replay_page(recording, summarize(recording, scenario, 1.0), []), encoding="utf-8")
    page, seen = show(path, "#t=190")
    heading = "window.replay.plots.all.find((p) => p.cells.some((c) => c.name === 'vehicle.pose.heading')).u.data[1]"
    turned = page.evaluate(f"{heading}.at(-1)")
    assert turned == pytest.approx(math.degrees(recording.signals["vehicle.pose.heading"][-1]), rel=1e-3)
    assert turned > 2500.0
    run = "window.replay.page.runs[0]"
    assert page.evaluate(f"{run}.apart.filter(Boolean).length") > 5
    shown = page.evaluate(f"window.replay.scene.poseAt({run}, 190)[2]")
    assert page.evaluate(f"(at) => {run}.values('vehicle.pose.heading').includes(at)", shown)
    assert seen.console == []


def test_a_short_run_is_one_line(show: Any, replay: Any) -> None:
    page, _ = show(replay)
    assert not page.evaluate("window.replay.page.runs[0].apart.some(Boolean)")


def test_text_of_a_scenario_never_becomes_markup(show: Any, replay: Any) -> None:
    page, seen = show(replay)
    assert page.locator("#title").inner_text().startswith("<script>")
    assert page.title().startswith("<script>")
    assert page.locator("td.message", has_text="onerror").count() >= 1
    assert page.evaluate("window.evil") is None
    assert page.locator("img").count() == 0
    assert seen.requests == [replay.as_uri()]


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_theme_follows_the_system_and_the_switch(show: Any, replay: Any, scheme: str) -> None:
    page, _ = show(replay, color_scheme=scheme)
    colour = "getComputedStyle(document.body).backgroundColor"
    first = page.evaluate(colour)
    page.click("#theme")
    second = page.evaluate(colour)
    assert first != second
    brightness = [sum(int(part) for part in text.strip("rgb()").split(",")) for text in (first, second)]
    assert (brightness[0] > brightness[1]) == (scheme == "light")
    page.click("#theme")
    assert page.evaluate(colour) == first


def test_phone(show: Any, replay: Any) -> None:
    page, seen = show(replay, width=390, height=844, is_mobile=True, has_touch=True)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert shades(page) > 20
    for selector in ("#view", "#timeline", ".plot canvas"):
        assert page.locator(selector).first.bounding_box()["width"] > 300
    page.tap("#play")
    until(page, "window.replay.t > 0.2")
    assert seen.console == []


def test_two_runs_on_one_page(show: Any, overlay: Any) -> None:
    page, seen = show(overlay)
    assert page.locator("#verdict").inner_text().endswith("differ")
    assert page.locator(".lane", has_text="phase A").count() == 1
    assert page.locator(".lane", has_text="phase B").count() == 1
    assert page.locator("#checks tr", has_text="controller.guo2015.k4").count() == 1
    assert page.locator("#checks .pill.bad").count() >= 1
    assert page.evaluate("window.replay.plots.all[0].u.series.length") >= 3
    page.keyboard.press("End")
    assert shades(page) > 20
    assert seen.console == []
    assert seen.requests == [overlay.as_uri()]


def test_three_runs_have_three_colours(show: Any, three: Any) -> None:
    page, seen = show(three)
    for label in "ABC":
        assert page.locator(".lane", has_text=f"phase {label}").count() == 1
    runs = page.evaluate(
        "[...document.querySelectorAll('#legend i')].map((node) => getComputedStyle(node).backgroundColor)"
    )
    assert len(set(runs)) == 3
    lane = """(label) => [...new Set([...document.querySelectorAll(`.span[data-run='${label}']`)]
        .map((node) => getComputedStyle(node).backgroundColor))]"""
    assert [page.evaluate(lane, number) for number in range(3)] == [[colour] for colour in runs]
    assert page.locator("#checks th", has_text=re.compile("^C$")).count() == 1
    assert seen.console == []


def test_the_tube_that_compare_judged_by_is_drawn(show: Any, overlay: Any, replay: Any) -> None:
    drawn = """() => { const { plots } = window.replay, u = plots.all[0].u, { ctx, bbox } = u;
        const d = ctx.getImageData(bbox.left, bbox.top, bbox.width, bbox.height).data;
        let n = 0; for (let i = 3; i < d.length; i += 4) if (d[i] > 35 && d[i] < 48) n++; return n; }"""
    page, _ = show(overlay)
    with_tube = page.evaluate(drawn)
    page, _ = show(replay)
    assert with_tube > 5 * page.evaluate(drawn) > 0


def test_the_whole_page_looks_where_the_pointer_is(show: Any, replay: Any) -> None:
    page, _ = show(replay, "#t=2")
    over = page.locator(".u-over").first.bounding_box()
    page.mouse.move(over["x"] + 0.5 * over["width"], over["y"] + 0.5 * over["height"])
    half = page.evaluate("window.replay.duration") / 2.0
    looked = page.evaluate("window.replay.scene.t")
    assert looked == pytest.approx(half, abs=0.1)
    assert page.text_content("#clock").startswith(f"{looked:.2f} / ")
    assert float(page.get_attribute("#timeline", "aria-valuenow")) == pytest.approx(looked, abs=0.006)
    page.mouse.move(5, 5)
    assert page.text_content("#clock").startswith("2.00 / ")


def test_follow_is_lit_only_while_the_view_follows(show: Any, replay: Any) -> None:
    page, _ = show(replay)
    page.keyboard.press("C")
    assert page.get_attribute("#follow", "aria-pressed") == "true"
    box = page.locator("#view").bounding_box()
    page.mouse.move(box["x"] + 200, box["y"] + 200)
    page.mouse.down()
    page.mouse.move(box["x"] + 260, box["y"] + 200)
    page.mouse.up()
    assert page.get_attribute("#follow", "aria-pressed") == "false"


def test_a_mode_has_names_at_its_axis(show: Any, replay: Any) -> None:
    page, _ = show(replay)
    pick(page, "controller.phase")
    marks = page.evaluate(
        "(() => { const { u } = window.replay.plots.all.at(-1); return u.axes[1].values(u, [0, 2, 2.5]); })()"
    )
    assert marks == ["standby", "path tracking", ""]


def test_prose_is_one_line_and_lists_of_differences_are_folded(show: Any, replay: Any, three: Any) -> None:
    page, _ = show(replay)
    line = "() => document.getElementById('subtitle').getBoundingClientRect().height"
    folded = page.evaluate(line)
    assert folded < 30
    page.click("#subtitle")
    assert page.evaluate(line) > folded
    page, _ = show(three, width=390, height=844)
    assert page.evaluate("document.documentElement.scrollHeight") < 6000
    shown = page.locator("#checks details[open] > .scroll tbody, #checks details[open] > div > .scroll tbody")
    assert all(item.locator("tr").count() <= 8 for item in shown.all())
