"""The page in a real browser: its judge agrees with the judge in Python, people drive it, sliders move the ghost."""

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml

from controller_fmu.registry import Phase
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.studies.live.map_code import map_code
from orchestrator.studies.live.page import live_page
from orchestrator.studies.live.situation import page_scenarios
from tests.live.person import drive, hurries_once, never_obeys, standing_clock

scenarios_of = cache(page_scenarios)
LARGEST_PAGE = 400_000
PHASES = [state.name for state in Phase]
WHOLE = """(names) => names.map((name) => {
  const { lab } = window.live;
  lab.load(name);
  const run = lab.whole.run(lab.situation.params(), lab.situation.data.times, 1);
  const { outcome, reason, numbers: n, checks } = judged(run.row, lab.situation, lab.table);
  const phase = 1 + lab.seen.indexOf("controller.phase"), at = (i, place) => run.trace[i * run.width + place];
  const events = [], changes = (i) => at(i, phase) !== at(i - 1, phase);
  const word = (value) => stateName(stateNames(lab.engine.models, "controller.phase"), value);
  for (let i = 1; i < run.lines; i++) if (changes(i)) events.push([at(i, 0), word(at(i, phase))]);
  const margins = Object.fromEntries(checks.map((check) => [check.id, check.margin]));
  const pose = AXES.map((axis) => n[`final.${axis}`]), manoeuvres = n.manoeuvres || 0;
  return { outcome, reason, duration: n.duration, manoeuvres, pose, events, margins };
})"""
MAPPED = """async (names) => {
  const lab = await startMapLab(window.live.map.parts);
  return names.map((name) => {
    lab.load(name);
    const params = lab.situation.params(), { times } = lab.situation.data, course = lab.openForMap();
    const [row, whole] = [course, lab.whole].map((runs) => runs.run(params, times, 1 << 30).row);
    course.close();
    return [course.engine !== lab.engine, row.every((value, place) => Object.is(value, whole[place]))];
  });
}"""
"""Whether the map has code of its own for a scenario, and whether that has all bits of the complete code."""
RECORD = Path(__file__).parents[1] / "golden" / "scenarios.yaml"
"""What the native FMUs do, to six digits."""
REPLANS = "valet-search-60"
"""Drives another path here than with the mathematics library of the record; ``test_module`` compares its end."""
GROW = ("preview-camera", "preview-geometry")
"""Grow the last bit of a sine to the sample in which the lap ends: see test_module.py."""
FRAME_PATH = 0.17
"""What the vehicle drives in a camera frame of 20 ms at 8.3 m/s [m]."""


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Any:
    return written(tmp_path_factory.mktemp("live"), scenarios_of())


@pytest.fixture(scope="module")
def apa_file(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The page of the parking system, whose controller is an FMU of its own."""
    return written(tmp_path_factory.mktemp("live-apa"), scenarios_of("apa"))


def written(folder: Any, scenarios: Any) -> Any:
    path = folder / "live.html"
    path.write_text(live_page(scenarios, map_code(scenarios)), encoding="utf-8")
    assert path.stat().st_size < LARGEST_PAGE
    return path


@pytest.fixture
def page(file: Any, show: Any) -> Iterator[Any]:
    yield from watched(show, file, "guo2015-case4")


@pytest.fixture
def apa_page(apa_file: Any, show: Any) -> Iterator[Any]:
    yield from watched(show, apa_file, "apa-parallel")


@pytest.fixture
def own_page(file: Any, show: Any) -> Iterator[Any]:
    """A page whose clock a test may stop."""
    yield from watched(show, file, "guo2015-case4", is_own=True)


def watched(show: Any, file: Any, scenario: Any, is_own: bool = False) -> Iterator[Any]:
    """Show a page that, when its test is over, has reported nothing and asked for nothing from outside."""
    shown, seen = show(file, f"#s={scenario}", 1440, 900, is_own=is_own)
    yield shown
    assert seen.console == []
    assert [url for url in seen.requests if not url.startswith(("file:", "data:", "blob:"))] == []


def test_every_run_of_the_page_comes_to_the_end_on_record(page: Any) -> None:
    as_on_record(page, scenarios_of())


def test_the_code_of_the_map_has_the_bits_of_the_complete_code(page: Any) -> None:
    names = [scenario.name for scenario in scenarios_of()]
    found = dict(zip(names, page.evaluate(MAPPED, names), strict=True))
    first = scenarios_of()[0].controller["system"]
    own = {scenario.name for scenario in scenarios_of() if scenario.controller["system"] == first}
    assert {name for name, (is_own, _) in found.items() if is_own} == own
    assert all(is_equal for _, is_equal in found.values())


def test_a_controller_of_one_system_has_no_code_for_a_map(tmp_path: Path, show: Any) -> None:
    """Its map runs the complete code, as any page does without code for its map."""
    assert map_code(scenarios_of("apa")) is None
    path = tmp_path / "live.html"
    path.write_text(live_page(scenarios_of()[:1], None), encoding="utf-8")
    for page in watched(show, path, "guo2015-case4"):
        assert page.evaluate(MAPPED, ["guo2015-case4"]) == [[False, True]]


@pytest.mark.release  # compiles WebAssembly of another controller for a quarter of a minute
def test_the_parking_system_has_a_page_of_its_own(apa_page: Any) -> None:
    assert apa_page.evaluate(MAPPED, ["apa-parallel"]) == [[False, True]]
    apa_page.select_option("#scenario", "valet-perpendicular")
    apa_page.fill("#search", "scene.boxes[6].y")
    apa_page.click("#found button")
    fill(apa_page, "vehicle.scene.boxes[6].y", "4")  # a wall, which the controller's map contains
    apa_page.wait_for_function("() => !window.live.isDue")
    agrees(ghost(apa_page), run_of("valet-perpendicular", "vehicle.scene.boxes[6].y=4"))
    assert ghost(apa_page)["manoeuvres"] == 5
    as_on_record(apa_page, scenarios_of("apa"))


def as_on_record(page: Any, scenarios: Any) -> None:
    names = [scenario.name for scenario in scenarios if scenario.name != REPLANS]
    record = yaml.safe_load(RECORD.read_text(encoding="utf-8"))
    for name, found in zip(names, page.evaluate(WHOLE, names), strict=True):
        alike(found, record[name], name, FRAME_PATH if name in GROW else 2e-6)


def alike(found: Any, asked: Any, where: Any, within: Any) -> None:
    if isinstance(asked, dict):
        assert found.keys() == asked.keys(), where
        for key, value in asked.items():
            alike(found[key], value, f"{where} {key}", within)
    elif isinstance(asked, list):
        assert len(found) == len(asked), where
        for ours, theirs in zip(found, asked, strict=True):
            alike(ours, theirs, where, within)
    elif isinstance(asked, float | int):
        assert found == pytest.approx(asked, rel=0.0, abs=within, nan_ok=True), where
    else:
        assert found == asked, where


TO_TRY = [
    ("guo2015-case1-105", {"controller.guo2015.k1": 0.3}, "not_parked", 1),
    ("guo2015-case1-105", {"controller.guo2015.k2": 0.3}, "not_parked", 1),
    ("guo2015-case1-105", {"vehicle.driver.profile[1].speed": 1.0}, "not_parked", 1),
    ("guo2015-case1-105", {"vehicle.driver.profile[1].speed": 1.0, "car.steering.rate_limit": 45.0}, "parked", 1),
    ("hsic", {"vehicle.start.y": 5.0}, "parked", 1),
    ("hsic", {"vehicle.start.y": 5.5}, "not_parked", 1),
    ("hsic", {"vehicle.steering.lag": 0.4}, "parked", 1),
    ("hsic", {"vehicle.steering.lag": 0.8}, "steering_fault", 0),
    ("preview", {"controller.preview.set_speed": 11.0}, "finished", 0),
    ("preview", {"controller.preview.set_speed": 12.0}, "bad_parameter", 0),
    ("preview", {"controller.preview.set_speed": 20.0}, "bad_parameter", 0),
    ("zhang2022", {"vehicle.start.x": 8.0}, "parked", 1),
    ("zhang2022", {"vehicle.steering.lag": 0.1}, "parked", 1),
    ("zhang2022", {"vehicle.steering.lag": 0.2}, "not_parked", 1),
    ("adaptive", {"vehicle.driver.reaction_delay": 0.6}, "parked", 3),
    ("adaptive", {"vehicle.driver.reaction_delay": 1.2}, "parked", 3),
    ("adaptive", {"vehicle.driver.profile[1].speed": 2.25}, "parked", 7),
]
"""What the pages of the laws say to try: outcome, or reason of a failure, and manoeuvres."""
TO_TRY_OF_APA = [
    ("apa-parallel", {"vehicle.scene.boxes[2].x": 8.0}, "not_parked", 4),
    ("apa-parallel", {"vehicle.scene.boxes[2].x": 7.4}, "not_parked", 6),
    ("apa-parallel", {"vehicle.scene.boxes[2].x": 6.0}, "slot_too_short", 0),
    ("apa-parallel", {"vehicle.scene.boxes[2].x": 2.8}, "no_slot", 0),
    ("apa-parallel", {"vehicle.ultrasonic.noise": 0.02}, "parked", 2),
    ("apa-parallel", {"vehicle.ultrasonic.noise": 0.1}, "no_slot", 0),
    ("valet-perpendicular", {"vehicle.scene.boxes[6].y": 4.0}, "parked", 5),
]
"""What the page of the parking system says to try."""
TRIED = """(all) => all.map(([name, changes]) => {
  const { lab } = window.live;
  lab.load(name, changes);
  const { outcome, reason, numbers } = lab.ghost();
  return [outcome === "failed" ? reason : outcome, numbers.manoeuvres];
})"""


def test_what_the_laws_pages_say_to_try_comes_out_so(page: Any, apa_page: Any) -> None:
    for shown, to_try in ((page, TO_TRY), (apa_page, TO_TRY_OF_APA)):
        found = shown.evaluate(TRIED, [item[:2] for item in to_try])
        assert [tuple(item) for item in found] == [item[2:] for item in to_try]


def test_who_is_too_fast_once_is_brought_back_by_point_tracking(own_page: Any) -> None:
    found = drive(own_page, hurries_once)
    phases = own_page.evaluate("() => window.live.drive.history.spans('controller.phase').map((span) => span.value)")
    assert PHASES.index("TO_Q2") in phases
    assert found["numbers"]["manoeuvres"] >= 2
    assert (found["outcome"], found["byHand"]) == ("parked", True)
    assert own_page.text_content("#drive-said") == "You: parked"


def test_who_never_obeys_fails_with_a_reason(own_page: Any) -> None:
    found = drive(own_page, never_obeys)
    assert found["outcome"] == "failed"
    assert found["reason"] == "not_stopping"
    assert "You: failed: not stopping" in own_page.text_content("#drive-said")


PADS = """() => {
  window.pad = { buttons: Array.from({ length: 17 }, () => ({ value: 0, pressed: false })) };
  navigator.getGamepads = () => [window.pad];
  window.tones = 0;
  const made = AudioContext.prototype.createOscillator;
  AudioContext.prototype.createOscillator = function () { window.tones += 1; return made.call(this); };
}"""
START = "() => live.lab.situation.pose('vehicle.start')"
HELD = "() => ({ ...live.driver.pedal, lever: live.driver.lever, drives: live.driver.drives, t: live.drive.t })"


def test_a_finger_and_a_gamepad_drive_and_sounds_are_off_until_asked_for(file: Any, show: Any) -> None:
    page, seen = show(file, "#s=guo2015-case4-105", 390, 844, is_own=True, has_touch=True, is_mobile=True)
    page.evaluate(PADS)
    standing_clock(page)
    box = page.locator("#accelerator").bounding_box()
    finger = page.context.new_cdp_session(page)
    before = page.evaluate(START)
    x, y = handle(page, "vehicle.start")
    for kind, by in (("touchStart", 15), ("touchMove", 25), ("touchMove", 35)):
        finger.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [{"x": x + by, "y": y - by}]})
    finger.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    moved = [now - then for now, then in zip(page.evaluate(START), before, strict=True)]
    scale = page.evaluate("() => live.stage.scale")
    assert moved == pytest.approx([20 / scale, 20 / scale, 0.0], abs=0.002)
    page.tap("#gear-R")
    at = [{"x": box["x"] + 20, "y": box["y"] + 40}]
    finger.send("Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": at})
    page.clock.run_for(1000)
    held = page.evaluate(HELD)
    assert (held["accelerator"], held["lever"], held["drives"]) == (0.25, 1, True)
    assert 0.9 < held["t"] < 1.1
    finger.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    page.clock.run_for(500)
    assert page.evaluate(HELD)["accelerator"] == 0.0
    page.evaluate("() => { pad.buttons[6] = { value: 0.6, pressed: true }; pad.buttons[0].pressed = true; }")
    page.clock.run_for(1000)
    held = page.evaluate(HELD)
    assert (held["brake"], held["lever"]) == (0.6, 3)
    assert page.evaluate("tones") == 0
    page.check("#sound")
    page.evaluate("() => { pad.buttons[6].value = 0; live.drive.restart(); live.sounds.play('STOP'); }")
    assert page.evaluate("tones") == 3
    assert seen.console == []


def ghost(page: Any) -> Any:
    return page.evaluate(
        "() => { const { outcome, reason, numbers } = window.live.whole; return { outcome, reason, ...numbers }; }"
    )


def run_of(name: Any, *sets: Any) -> Any:
    scenario = load_scenario(name, list(sets))
    ran = run_scenario(scenario, fmu_files("native"), kind="native")
    return summarize(ran.recording, scenario, ran.wall_time)


def agrees(found: Any, summary: Any) -> None:
    assert (found["outcome"], found["reason"]) == (summary.outcome, summary.reason)
    assert found["manoeuvres"] == summary.manoeuvres
    for axis in ("x", "y", "heading"):
        assert found[f"final.{axis}"] == pytest.approx(getattr(summary.final, axis), rel=0.0, abs=1e-6)


def fill(page: Any, name: Any, value: Any) -> None:
    field = page.locator(f'[id="p-{name}"]')
    field.fill(value)
    field.dispatch_event("change")


def test_a_slider_moves_the_ghost_as_apa_run_with_set_does(page: Any) -> None:
    before = ghost(page)
    page.focus('input[type="range"][aria-label="car.steering.rate_limit"]')
    for _ in range(15):
        page.keyboard.press("ArrowLeft")
    page.wait_for_function("() => !window.live.isDue")
    value = page.evaluate("() => window.live.lab.situation.get('car.steering.rate_limit')")
    after = ghost(page)
    assert value < 9.9
    assert after["final.x"] != before["final.x"]
    agrees(after, run_of("guo2015-case4", f"car.steering.rate_limit={value!r}"))


def test_a_value_out_of_range_is_refused_with_the_range(page: Any) -> None:
    before = ghost(page)
    fill(page, "controller.guo2015.k1", "1000")
    wrong = page.locator('[id="p-controller.guo2015.k1-wrong"]')
    assert wrong.text_content() == "out of range: it takes 0 to 100 1/m\u00b2"
    assert page.locator('[id="p-controller.guo2015.k1"]').get_attribute("aria-invalid") is not None
    assert ghost(page) == before
    fill(page, "controller.guo2015.k1", "2")
    assert wrong.text_content() == ""


def test_a_parameter_is_named_by_its_meaning_with_a_rounded_range(page: Any) -> None:
    pins = page.locator(".pin")
    for pin in pins.all():
        label, meaning = pin.locator("label").inner_text(), pin.locator(".meaning").inner_text()
        code = pin.locator(".meaning code").inner_text()
        assert label
        assert label != code
        assert meaning.startswith(code)
        assert not re.search(r"\d[.\d]*\d{5}|\d{6}|\d (?:to|1)$| 1$", meaning), meaning
    assert "0.573 to 5730 deg/s" in pins.nth(1).locator(".meaning").inner_text()


def test_the_map_is_computed_when_it_is_first_opened(page: Any) -> None:
    page.click("#map-tab")
    page.wait_for_function("() => window.live.map.rows.length > 0", timeout=60_000)
    colours = """() => { const c = document.getElementById("map"), g = c.getContext("2d");
        return new Set(new Uint32Array(g.getImageData(0, 0, c.width, c.height).data.buffer)).size; }"""
    page.wait_for_timeout(50)
    assert page.evaluate(colours) > 2


def test_the_chart_is_seen_whole_at_a_usual_width(page: Any) -> None:
    page.click("#chart-tab")
    page.wait_for_selector("#chart svg")
    hidden = (
        "() => { const sheet = document.querySelector('.chart-sheet'); return sheet.scrollWidth - sheet.clientWidth; }"
    )
    assert page.evaluate(hidden) <= 0


def test_the_exported_scenario_comes_to_the_end_of_the_page(page: Any, tmp_path: Path) -> None:
    fill(page, "vehicle.driver.profile[1].speed", "1.2")
    page.fill("#search", "backlash")
    page.click("#found button")
    fill(page, "vehicle.steering.backlash", "3")
    drag(page, "target", 0.25, 0.05)
    page.wait_for_function("() => !window.live.isDue")
    file = tmp_path / "exported.yaml"
    file.write_text(page.input_value("#yaml"), encoding="utf-8")
    assert "backlash" in file.read_text(encoding="utf-8")
    summary = run_of(str(file))
    dragged, usual = load_scenario(str(file)).target, load_scenario("guo2015-case4").target
    assert dragged is not None
    assert usual is not None
    assert dragged.pose != usual.pose
    agrees(ghost(page), summary)


VALUES = """(names) => names.map((name) => live.lab.situation.get(name))"""
ANGLED = ["kind=angled", "angle=60 deg", "side=left", "row=2", "origin.heading=40 deg", "origin.x=3", "kerb={}"]


def follows(page: Any, path: Path) -> Any:
    """Return the scenario that the page exports, after all that slot_layout generates was compared with the page."""
    page.wait_for_function("() => !window.live.isDue")
    path.write_text(page.input_value("#yaml"), encoding="utf-8")
    scenario = load_scenario(str(path))
    assert scenario.slot is not None
    assert scenario.target is not None
    expected = {f"vehicle.{name}": value for name, value in scenario.vehicle.items() if name.startswith("scene.")}
    for owner, values in (("slot", scenario.slot), ("target", scenario.target), ("controller.target", scenario.target)):
        expected |= {f"{owner}.{name}": value for name, value in values.model_dump().items()}
    found = dict(zip(expected, page.evaluate(VALUES, list(expected)), strict=True))
    assert found == pytest.approx(expected, rel=0.0, abs=1e-9)
    return scenario


def test_a_slot_that_is_dragged_takes_neighbours_kerb_and_target_along(apa_page: Any, tmp_path: Path) -> None:
    usual = load_scenario("apa-parallel")
    assert usual.slot is not None
    drag(apa_page, "slot", 0.5, -0.25)
    moved = follows(apa_page, tmp_path / "dragged.yaml")
    assert moved.slot.x == pytest.approx(usual.slot.x + 0.5, abs=0.05)
    for name in ("scene.boxes[1].x", "scene.boxes[2].x", "scene.kerbs[1].x1"):
        assert moved.vehicle[name] - usual.vehicle[name] == pytest.approx(moved.slot.x - usual.slot.x)
    fill(apa_page, "slot_layout.length", "7")
    assert follows(apa_page, tmp_path / "longer.yaml").slot.length == 7.0
    drag(apa_page, "target", 0.25, 0.0)
    assert follows(apa_page, tmp_path / "target.yaml").target.x > moved.target.x + 0.5
    apa_page.evaluate("() => { live.lab.situation.set('car.width', 1.7); live.changed(); }")
    assert follows(apa_page, tmp_path / "car.yaml").vehicle["car.width"] == 1.7
    refused = apa_page.evaluate("() => live.lab.situation.set('slot.length', 4)")
    assert refused.startswith("slot.length follows slot_layout")


def test_the_handle_of_a_slot_says_what_it_takes_along(page: Any, apa_page: Any) -> None:
    for shown, name, said in (
        (page, "guo2015-case4", "no slot_layout"),
        (apa_page, "valet-perpendicular", "no slot_layout"),
        (apa_page, "apa-parallel", "with its neighbours"),
    ):
        shown.select_option("#scenario", name)
        shown.evaluate("() => live.draw(performance.now())")
        shown.mouse.move(*handle(shown, "slot"))
        assert said in shown.get_attribute("#view", "title")


def test_an_angled_row_follows_its_layout(tmp_path: Path, show: Any) -> None:
    scenario = load_scenario("apa-parallel", ["car=zhang2022", *(f"slot_layout.{item}" for item in ANGLED)])
    page, _ = show(written(tmp_path, [scenario]), "", 1440, 900)
    for name, value in (("origin.heading", -0.3), ("origin.y", 2.0), ("length", 3.5), ("depth", 5.5)):
        page.evaluate("([name, value]) => live.lab.situation.set(name, value)", [f"slot_layout.{name}", value])
        page.evaluate("() => live.changed()")
        follows(page, tmp_path / "turned.yaml")
    page.evaluate("() => { live.lab.situation.set('car.steering.rate_limit', 5); live.changed(); }")
    assert follows(page, tmp_path / "car.yaml").car == "zhang2022"


def handle(page: Any, prefix: Any) -> Any:
    """Return where on the screen what can be dragged is taken."""
    return page.evaluate(
        "(prefix) => { const { stage } = window.live, item = stage.handles().find((one) => one.prefix === prefix);"
        " const box = stage.canvas.getBoundingClientRect(), [u, v] = stage.pixel(...item.points[0][1]);"
        " return [u + box.left, v + box.top]; }",
        prefix,
    )


def drag(page: Any, prefix: Any, dx: Any, dy: Any) -> None:
    """Drag a handle by metres."""
    x, y = handle(page, prefix)
    scale = page.evaluate("() => window.live.stage.scale")
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 0.5 * dx * scale, y - 0.5 * dy * scale)
    page.mouse.move(x + dx * scale, y - dy * scale)
    page.mouse.up()


def test_the_address_holds_scenario_and_changes(page: Any, file: Any, show: Any) -> None:
    page.select_option("#scenario", "hsic")
    fill(page, "vehicle.steering.lag", "0.05")
    page.wait_for_function("() => !window.live.isDue")
    again, _ = show(file, page.evaluate("() => location.hash"), 1440, 900)
    assert again.input_value("#scenario") == "hsic"
    assert ghost(again) == ghost(page)
    again.evaluate("() => { location.hash = '#s=none&vehicle.steering.lag=9&car.nothing=1&x=%E0%A4%A'; }")
    again.wait_for_selector("#notice:not([hidden])")
    assert again.input_value("#scenario") == "guo2015-case4"
    reported = again.text_content("#notice")
    for words in ("no scenario none", "x=%E0%A4%A", "out of range: vehicle.steering.lag", "no parameter car.nothing"):
        assert words in reported


def test_a_map_is_coloured_and_a_cell_taken_from_it_is_what_it_says(page: Any) -> None:
    page.click("#map-tab")
    page.click("#map-go")
    page.wait_for_selector("#map[data-done]", timeout=60_000)
    assert page.text_content("#map-said").startswith("400 runs in")
    page.focus("#map")
    for key in ("ArrowRight",) * 4 + ("ArrowUp",) * 6 + ("Enter",):
        page.keyboard.press(key)
    page.wait_for_function("() => !window.live.isDue")
    assert sum(int(text.split()[-1]) for text in page.locator("#map-key > span").all_text_contents()) == 400
    cell = page.evaluate("() => { const { map } = window.live; return map.rows[6][4]; }")
    found = ghost(page)
    assert (found["outcome"], found["reason"]) == (cell["outcome"], cell["reason"])
    box = page.locator("#map").bounding_box()
    page.mouse.click(box["x"] + 10.5 / 20 * box["width"], box["y"] + 10.5 / 20 * box["height"])
    assert page.evaluate("() => window.live.map.at") == [10, 9]
    page.select_option("#map-color", "error")
    assert page.text_content("#map-key") == "on the target to 3 m off and more"


UNTIL = "([name, state]) => { const { drive } = window.live; while (drive.state(name) !== state) drive.go(); }"


def test_the_chart_shows_the_state_and_how_it_came(page: Any) -> None:
    page.click("#chart-tab")
    page.evaluate("() => { const { drive } = window.live; while (drive.t < 5.0) drive.go(); }")
    page.wait_for_timeout(100)
    on = page.evaluate("() => [...document.querySelectorAll('[data-state].on')].map((node) => node.dataset.state)")
    assert on == [page.evaluate("() => window.live.drive.state('controller.phase')")]
    assert page.locator(".past li").count() == 4
    assert page.text_content("#chart-said").startswith(f"{on[0].lower().replace('_', ' ')}:")
    assert "(standing to drive)" in page.locator(".past li").first.text_content()
    guards = page.locator(".deciding li")
    assert guards.all_text_contents()[-1] == "\u2013 notwheel set for Q3 \u2192 to Q3"
    assert page.locator(".deciding .holds").count() == 0
    page.evaluate(
        "() => { const { drive } = live; while (drive.state('controller.phase') === 'PRE_STEER') drive.go(); }"
    )
    page.wait_for_timeout(100)
    assert page.locator(".deciding .holds").all_text_contents() == ["\u2713 holdswheel set for Q2 \u2192 to Q2, taken"]
    page.click("#restart")
    page.wait_for_timeout(100)
    assert guards.count() == 0
    page.focus('[data-state="STOP"]')
    assert page.text_content("#chart-said").startswith("stop:")
    page.select_option("#scenario", "adaptive")
    page.evaluate(UNTIL, ["controller.phase", "PATH_TRACKING"])
    page.wait_for_timeout(100)
    assert page.locator('[data-state="TO_Q2"]').count() == 0
    assert guards.all_text_contents() == [
        "\u2013 nottakeover \u2192 takeover",
        "\u2013 notfault \u2192 failed",
        "\u2713 holdswheel set to reverse \u2192 path tracking, taken",
        "\u2013 notwheel set to go ahead \u2192 to Q4",
    ]


def test_the_chart_says_what_was_tested_before_what_was_taken(apa_page: Any) -> None:
    apa_page.click("#chart-tab")
    apa_page.select_option("#scenario", "valet-perpendicular")
    taken, guards = apa_page.locator(".deciding .holds"), apa_page.locator(".deciding li")
    apa_page.evaluate(UNTIL, ["controller.apa.state", "PLANNING"])
    apa_page.wait_for_timeout(100)
    assert taken.text_content().startswith("\u2713 holdsgoal known \u2192 planning, taken")
    apa_page.select_option("#scenario", "apa-parallel")
    apa_page.evaluate(UNTIL, ["controller.apa.state", "SEARCHING"])
    apa_page.wait_for_timeout(100)
    assert taken.all_text_contents() == ["\u2713 holdsswitched on \u2192 searching, taken"]
    apa_page.evaluate("live.drive.go()")
    apa_page.wait_for_timeout(100)
    assert taken.count() == 0
    assert guards.all_text_contents() == [
        "\u2013 notswitched off \u2192 standby",
        "\u2013 notfault \u2192 failed",
        "\u2013 notslot found \u2192 confirming: a slot is found and the vehicle stands",
    ]
    apa_page.evaluate(UNTIL, ["controller.apa.state", "STEERING"])
    apa_page.wait_for_timeout(100)
    assert guards.all_text_contents() == [
        "\u2013 notswitched off \u2192 standby",
        "\u2013 notfault \u2192 failed",
        "\u2013 notslot rejected \u2192 searching: no path into the slot shown",
        "\u2013 notdriven on \u2192 searching: the driver drove on instead of confirming, or chose another slot",
        "\u2713 holdsconfirmed \u2192 steering, taken",
    ]


def test_a_scenario_with_faults_says_what_it_disturbs(page: Any) -> None:
    page.select_option("#scenario", "fault-pose-frozen")
    assert (
        page.inner_text("#faults") == "This scenario disturbs what is received: stuck_at_last vehicle.odometry, 2 s on."
    )
    page.evaluate("() => { const { drive } = window.live; while (drive.t < 2.1) drive.go(); }")
    page.wait_for_selector("#faults em:visible")
    assert page.inner_text("#faults").endswith("stuck_at_last vehicle.odometry, 2 s on, now.")


def test_controllers_of_two_models_do_not_share_a_page() -> None:
    scenarios = [load_scenario(name) for name in ("guo2015-case4", "valet-perpendicular")]
    with pytest.raises(BadInput, match="another controller than guo2015-case4: a page has one"):
        live_page(scenarios)
