"""The replay page in a real browser: it renders, plays, obeys the keyboard, asks nothing of any network."""

import pytest

CLOCK = "window.replay.t"


def until(page, condition: str) -> None:
    """Wait for a condition; the page's policy forbids Playwright's own way, which is eval."""
    for _ in range(400):
        if page.evaluate(condition):
            return
        page.wait_for_timeout(25)
    raise AssertionError(f"never true: {condition}")


def shades(page) -> int:
    """Return how many different colours the top view has."""
    return page.evaluate(
        """() => { const c = document.getElementById('view'), g = c.getContext('2d');
        return new Set(new Uint32Array(g.getImageData(0, 0, c.width, c.height).data.buffer)).size; }"""
    )


def test_page_renders_without_a_request_or_a_complaint(show, replay):
    page, seen = show(replay)
    assert shades(page) > 20
    assert page.locator(".plot canvas").count() >= 5
    assert page.locator(".pill.good").count() >= 6
    assert page.locator("#verdict").inner_text() == "parked"
    assert {"pre steer", "to Q2", "to Q1", "parked"} <= set(page.locator("#legend .chip").all_inner_texts())
    page.wait_for_timeout(300)
    assert seen.console == []
    assert seen.requests == [replay.as_uri()]


def test_plays_moves_the_car_and_stops_at_the_end(show, replay):
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


def test_keyboard(show, replay):
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
    page.keyboard.press("+")
    assert page.input_value("#speed") == "2"
    page.keyboard.press("-")
    page.keyboard.press("-")
    assert page.input_value("#speed") == "0.5"
    page.keyboard.press(" ")
    assert page.evaluate("window.replay.playing")
    page.keyboard.press(" ")
    assert not page.evaluate("window.replay.playing")


def test_links_lead_to_the_moment_of_the_worst_value(show, replay, case4):
    page, _ = show(replay)
    speed = next(check for check in case4[1].checks if check.signal == "vehicle.speed")
    page.locator("#checks tr", has_text="speed").locator("a.moment").click()
    assert page.evaluate(CLOCK) == pytest.approx(speed.t, abs=1e-3)
    assert page.evaluate("window.replay.page.runs[0].at('vehicle.speed', window.replay.t)") == pytest.approx(
        speed.value
    )


def test_fragment_opens_at_a_moment(show, replay):
    page, _ = show(replay, "#t=9.25")
    assert page.evaluate(CLOCK) == 9.25
    assert page.locator("#clock").inner_text().startswith("9.25")


def test_timeline_and_plots_are_scrubbers(show, replay):
    page, _ = show(replay)
    box = page.locator(".lane:first-child .track").bounding_box()
    page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 5)
    assert page.evaluate(f"{CLOCK} / window.replay.duration") == pytest.approx(0.5, abs=0.01)
    over = page.locator(".u-over").first.bounding_box()
    page.mouse.click(over["x"] + 0.25 * over["width"], over["y"] + 20)
    assert page.evaluate(f"{CLOCK} / window.replay.duration") == pytest.approx(0.25, abs=0.01)


def test_zoom_of_one_plot_is_the_zoom_of_all(show, replay):
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


def test_any_signal_can_be_plotted_and_removed(show, replay):
    page, seen = show(replay)
    before = page.locator(".plot").count()
    page.fill(".chooser input", "vehicle.distance")
    page.locator(".chooser input").dispatch_event("change")
    assert page.locator(".plot").count() == before + 1
    page.locator(".plot .close").click()
    assert page.locator(".plot").count() == before
    assert seen.console == []


def test_text_of_a_scenario_never_becomes_markup(show, replay):
    page, seen = show(replay)
    assert page.locator("#title").inner_text().startswith("<script>")
    assert page.title().startswith("<script>")
    assert page.locator("td.message", has_text="onerror").count() >= 1
    assert page.evaluate("window.evil") is None
    assert page.locator("img").count() == 0
    assert seen.requests == [replay.as_uri()]


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_theme_follows_the_system_and_the_switch(show, replay, scheme):
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


def test_phone(show, replay):
    page, seen = show(replay, width=390, height=844, is_mobile=True, has_touch=True)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert shades(page) > 20
    for selector in ("#view", "#timeline", ".plot canvas"):
        assert page.locator(selector).first.bounding_box()["width"] > 300
    page.tap("#play")
    until(page, "window.replay.t > 0.2")
    assert seen.console == []


def test_two_runs_on_one_page(show, overlay):
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


def test_the_whole_page_looks_where_the_pointer_is(show, replay):
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


def test_follow_is_lit_only_while_the_view_follows(show, replay):
    page, _ = show(replay)
    page.keyboard.press("C")
    assert page.get_attribute("#follow", "aria-pressed") == "true"
    box = page.locator("#view").bounding_box()
    page.mouse.move(box["x"] + 200, box["y"] + 200)
    page.mouse.down()
    page.mouse.move(box["x"] + 260, box["y"] + 200)
    page.mouse.up()
    assert page.get_attribute("#follow", "aria-pressed") == "false"


def test_a_mode_has_names_at_its_axis(show, replay):
    page, _ = show(replay)
    page.fill(".chooser input", "controller.phase")
    page.locator(".chooser input").dispatch_event("change")
    marks = page.evaluate(
        "(() => { const { u } = window.replay.plots.all.at(-1); return u.axes[1].values(u, [0, 2, 2.5]); })()"
    )
    assert marks == ["standby", "path tracking", ""]
