"""The page as text: one file, small, nothing to fetch, nothing that a scenario could smuggle in."""

import base64
import hashlib
import html
import json
import re
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestrator.evaluation.comparison.compare import compare
from orchestrator.evaluation.comparison.tolerance import Tolerance, Tolerances
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.report.overlay import write_overlay
from orchestrator.presentation.report.page import page
from orchestrator.presentation.report.payload import Arrays
from orchestrator.presentation.report.replay import LARGEST_PAGE, replay_page
from orchestrator.presentation.report.thinning import RANGE_TOLERANCE, thin
from tests.native_runs import drive_natively

EVIL = "<script>window.evil = 1</script><img src=x onerror='window.evil = 1'>"


def unpacked(text: str) -> Any:
    """Return the header and the arrays of a packed page, as template/data.js reads them."""
    raw = zlib.decompress(base64.b64decode(text))
    size = int.from_bytes(raw[:4], "little")
    header = json.loads(raw[4 : 4 + size])
    arrays, at = [], 4 + size
    for length in header["lengths"]:
        planes = np.frombuffer(raw[at : at + 4 * length], dtype=np.uint8).reshape(4, length)
        arrays.append(np.ascontiguousarray(planes.T).view("<f4").ravel())
        at += 4 * length
    return header, arrays


def said(pattern: str, text: str) -> str:
    found = re.search(pattern, text)
    assert found is not None
    return found[1]


def data_of(text: str) -> Any:
    return unpacked(said(r'<script type="text/plain" id="data">([^<]*)</script>', text))


def test_packed_numbers_come_back() -> None:
    arrays = Arrays()
    places = [arrays.add(np.array(values)) for values in ([1.5, -2.0, np.nan], [], [1.5, -2.0, np.nan], [7.0])]
    assert places == [0, 1, 0, 2]
    header, found = unpacked(arrays.pack({"a": [np.float64("inf"), np.int64(3)], "b": "</script>"}))
    assert header["a"] == [None, 3]
    assert header["b"] == "</script>"
    np.testing.assert_array_equal(found[0], np.array([1.5, -2.0, np.nan], dtype=np.float32))
    assert [len(item) for item in found] == [3, 0, 1]


def test_page_is_one_file_that_fetches_nothing(replay: Any) -> None:
    text = replay.read_text()
    assert not re.search(r'(src|href)\s*=\s*["\']?(https?:)?//', text)
    assert '<link rel="stylesheet"' not in text
    assert "fetch(" not in text
    assert "XMLHttpRequest" not in text
    assert "@import" not in text
    assert "Copyright (c) 2022 Leon Sorokin" in text


def test_policy_allows_exactly_the_scripts_of_the_page(replay: Any) -> None:
    text = replay.read_text()
    content = said(r'Content-Security-Policy" content="([^"]*)"', text)
    scripts = re.findall(r"<script>(.*?)</script>", text, re.S)
    hashes = {f"'sha256-{base64.b64encode(hashlib.sha256(item.encode()).digest()).decode()}'" for item in scripts}
    assert content.startswith("default-src 'none'")
    assert hashes == set(said(r"script-src ([^;]*)", content).split())


def test_title_is_escaped() -> None:
    assert "<title>&lt;script&gt;&amp;&quot;</title>" in page('<script>&"', "")


def test_no_text_of_the_scenario_stands_in_the_page(replay: Any) -> None:
    text = replay.read_text()
    assert EVIL not in text
    assert text.count("window.evil") == text.count(html.escape(EVIL)) * EVIL.count("window.evil")


def test_signals_in_the_page_are_those_of_the_run(replay: Any, case4: Any) -> None:
    recording = case4[0]
    header, arrays = data_of(replay.read_text())
    run = header["runs"][0]
    t = arrays[run["time"]]
    assert set(run["signals"]) == set(recording.signals)
    for name, signal in run["signals"].items():
        values = recording.signals[name]
        if "c" in signal:
            assert (values == signal["c"]).all()
            continue
        kept = arrays[signal["a"]] + signal["o"]
        if signal.get("held"):
            rows = np.searchsorted(t, recording.t.astype(np.float32), side="right") - 1
            np.testing.assert_array_equal(kept[rows], values)
        else:
            error = np.abs(np.interp(recording.t, t, kept) - values).max()
            assert error <= 1.01 * RANGE_TOLERANCE * np.ptp(values) + 1e-5


def test_sixty_seconds_stay_under_one_megabyte_whatever_happens() -> None:
    scenario = load_scenario(
        "fault-driver-does-not-move", ["stop_time=60", "controller.limit.driver_response_timeout=100"]
    )
    ran = drive_natively(scenario)
    recording = ran.recording
    assert recording.t[-1] == 60.0
    random = np.random.default_rng(1)
    for name, values in recording.signals.items():
        if recording.variables[name].kind is float:
            values += random.normal(size=len(values))
    text = replay_page(recording, summarize(recording, scenario, ran.wall_time), [])
    assert len(text.encode()) < LARGEST_PAGE


def test_far_from_the_origin_nothing_is_rounded_away() -> None:
    scenario = load_scenario("guo2015-case4-far")
    ran = drive_natively(scenario)
    header, arrays = data_of(replay_page(ran.recording, summarize(ran.recording, scenario, 0.0), []))
    run = header["runs"][0]
    signal = run["signals"]["vehicle.pose.x"]
    x = ran.recording.signals["vehicle.pose.x"]
    kept = arrays[signal["a"]].astype(float) + signal["o"]
    assert kept[0] == pytest.approx(x[0], abs=1e-5)
    assert kept[-1] == pytest.approx(x[-1], abs=1e-5)
    assert all(abs(number) < 100.0 for corner in run["scene"]["slot"] for number in corner)


def test_thinning_keeps_steps_and_spikes() -> None:
    t = np.linspace(0.0, 60.0, 6001)
    smooth = np.sin(t)
    smooth[2345] = 9.0
    mode = (t > 17.33).astype(float)
    thinned = thin(t, [smooth], [mode], [4321], 1000)
    change = int(np.argmax(mode))
    assert {0, 2344, 2345, 2346, 4321, change - 1, change, 6000} <= set(thinned.rows.tolist())
    assert thinned.deviation <= RANGE_TOLERANCE
    assert len(thinned.rows) <= 1000


def test_thinning_says_when_it_cannot() -> None:
    t = np.linspace(0.0, 60.0, 6001)
    noise = np.random.default_rng(1).normal(size=6001)
    thinned = thin(t, [noise], [], [], 500)
    assert len(thinned.rows) <= 502
    assert thinned.deviation > 0.1


def test_a_run_of_one_instant_has_a_page_and_one_of_none_is_refused() -> None:
    scenario = load_scenario("guo2015-case4", ["stop_time=0.01"])
    recording = drive_natively(scenario).recording
    for rows in (1, 0):
        recording.t_ns = recording.t_ns[:rows]
        recording.signals = {name: values[:rows] for name, values in recording.signals.items()}
        summary = summarize(recording, scenario, 0.0)
        if rows:
            header, arrays = data_of(replay_page(recording, summary, []))
            assert arrays[header["runs"][0]["time"]].tolist() == [0.0]
        else:
            with pytest.raises(BadInput, match="no instant"):
                replay_page(recording, summary, [])


def test_runs_of_one_scenario_have_names_of_their_own(case4: Any, tmp_path: Path) -> None:
    runs = [case4[0]] * 3
    found = [compare(runs[0], run, Tolerances(Tolerance(0.01))) for run in runs[1:]]
    for logs, expected in (
        (["base", "gain", "slow"], ["base", "gain", "slow"]),
        ([], ["guo2015-case4 (1)", "guo2015-case4 (2)", "guo2015-case4 (3)"]),
    ):
        path = tmp_path / "page.html"
        write_overlay(path, runs, ([], [], []), found, logs)
        header, _ = data_of(path.read_text(encoding="utf-8"))
        assert header["title"] == ", ".join(expected)
        assert [run["about"].split(",")[0] for run in header["runs"]] == [
            f"{label}: {name}" for label, name in zip("ABC", expected, strict=True)
        ]
