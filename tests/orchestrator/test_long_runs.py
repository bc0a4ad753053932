"""Long runs: the same verdicts as of short ones, in memory that does not grow with them."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from modelkit.signal import Signal
from modelkit.variables import Variable
from orchestrator.cli import main
from orchestrator.evaluation.comparison import traces
from orchestrator.evaluation.comparison.compare import compare
from orchestrator.evaluation.comparison.tolerance import Tolerance, Tolerances
from orchestrator.evaluation.verdict.logged_scenario import read_logged_scenario
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.presentation.drawing.decimation import decimate, deviation
from orchestrator.presentation.log import mcap_log
from orchestrator.presentation.log.mcap_file import HEADER_SIZE, McapFile
from orchestrator.presentation.log.protobuf_rows import Encoder
from orchestrator.presentation.log.read_log import read_log
from orchestrator.presentation.log.signal_channels import add_channel
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim import signal_blocks
from orchestrator.simulation.cosim.recording import Recording, StoredRecording, recording_of
from orchestrator.simulation.cosim.signal_blocks import SignalBlocks

GROWTH_MB = 16.0
"""Memory that a log of four times the length may take besides: caches, the allocator's leftovers, the log's index."""
RARER = ("report", "compare", "csv")
CIRCLES = Path(__file__).parents[1] / "report" / "circles.yaml"
MAX_PAGE_BYTES = 50e6
"""What the scripts of a page may keep."""
FULL_ROWS, FULL_MB = 2_750_000, 400.0
"""A log of about 411 MB, and what a command may take for it."""
CHILD = """
import json, resource, sys
from orchestrator.cli import main
code = main(sys.argv[1:])
print(json.dumps([code, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024]))
"""
SMALL = """
from orchestrator.simulation.cosim import signal_blocks
from orchestrator.evaluation.comparison import traces
from orchestrator.presentation.drawing import decimation
signal_blocks.MEMORY_BYTES, signal_blocks.BLOCK_BYTES, traces.SPAN_ROWS = 4 << 20, 1 << 20, 1 << 14
decimation.MAX_VALUES = 100_000
"""
SPECIAL = [0.0, -0.0, np.nan, np.inf, -np.inf, 1e-310, 255.0, 256.0, -1.0, 2.0**31, 0.1]


@pytest.fixture
def small_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let any run of more than some hundred exchanges be stored."""
    monkeypatch.setattr(signal_blocks, "MEMORY_BYTES", 1 << 14)
    monkeypatch.setattr(signal_blocks, "BLOCK_BYTES", 1 << 14)
    monkeypatch.setattr(traces, "SPAN_ROWS", 700)


def test_blocks_give_back_every_bit(small_blocks: None) -> None:
    draw = np.random.default_rng(3)
    columns = [draw.normal(size=1000), draw.integers(0, 2, 1000), draw.integers(-(2**31), 2**31, 1000)]
    columns += [np.full(1000, value) for value in SPECIAL]
    columns += [draw.choice(SPECIAL, 1000), np.where(np.arange(1000) < 500, 0.0, -0.0)]
    rows = np.column_stack([np.asarray(column, dtype=float) for column in columns])
    names = [f"v{place}" for place in range(rows.shape[1])]
    blocks, times = SignalBlocks(names), np.arange(1000) * 7
    blocks.append(0, rows[0])
    blocks.extend(times[1:600], rows[1:600])
    for t_ns, row in zip(times[600:], rows[600:], strict=True):
        blocks.append(int(t_ns), row)
    assert blocks.is_stored
    found = recording_of(blocks, {}, {}, {})
    assert found.t_ns.tolist() == times.tolist()
    for place, name in enumerate(names):
        assert found.signals[name].tobytes() == rows[:, place].tobytes(), name
    chosen = [0, 1, 63, 64, 65, 500, 998, 999]
    assert found.rows(chosen).signals["v0"].tolist() == rows[chosen, 0].tolist()
    assert found.between(60, 200).signals["v2"].tolist() == rows[60:200, 2].tolist()
    assert [found.row_at(t / 1e9) for t in (-5.0, 0.0, 7.0, 8.0, 7e9)] == [0, 0, 1, 2, 1000]


@pytest.fixture(scope="module")
def parked(tmp_path_factory: pytest.TempPathFactory) -> tuple[Recording, Path]:
    log = tmp_path_factory.mktemp("long") / "run.mcap"
    ran = run_scenario(load_scenario("guo2015-case4", []), None, log=log)
    return ran.recording, log


def plain(recording: Recording) -> str:
    return summarize(recording, read_logged_scenario(recording), 0.0).model_dump_json()


@pytest.fixture
def stored(parked: tuple[Recording, Path], small_blocks: None) -> Recording:
    found = read_log(parked[1])
    assert isinstance(found, StoredRecording)
    assert len(list(found.parts())) > 5
    return found


def test_a_stored_run_is_judged_to_the_same_bits(parked: tuple[Recording, Path], stored: Recording) -> None:
    assert plain(stored) == plain(parked[0])


def test_a_run_that_is_stored_meanwhile_is_judged_to_the_same_bits(
    parked: tuple[Recording, Path], small_blocks: None
) -> None:
    ran = run_scenario(load_scenario("guo2015-case4", []), None)
    assert isinstance(ran.recording, StoredRecording)
    assert plain(ran.recording) == plain(parked[0])


def test_contact_by_poses_is_the_same_block_by_block(parked: tuple[Recording, Path], stored: Recording) -> None:
    """A third-party vehicle puts out no clearance, so every pose is held against the scene."""
    scenario = read_logged_scenario(parked[0]).model_copy(
        update={"obstacles": [[(-9, -4), (-7, -4), (-7, -2), (-9, -2)]]}
    )
    for run in (parked[0], stored):
        run.info["fmus"] = []
    one, two = (summarize(run, scenario, 0.0) for run in (parked[0], stored))
    assert one.outcome == "not_parked"
    assert one.penetration > 0.0
    assert one.model_dump_json() == two.model_dump_json()


@pytest.mark.parametrize("time", [pytest.param(0.0, marks=pytest.mark.release), 0.1])
def test_stored_runs_are_compared_like_short_ones(
    time: float, parked: tuple[Recording, Path], stored: Recording
) -> None:
    run = parked[0]
    turned = run.signals["vehicle.pose.heading"] * 5.0
    signals = dict(run.signals) | {
        "vehicle.pose.x": run.signals["vehicle.pose.x"] + np.where(run.t > 9.0, 0.02, 0.0),
        "controller.phase": np.where(run.t > 12.0, 3.0, run.signals["controller.phase"]),
        "vehicle.pose.heading": np.arctan2(np.sin(turned), np.cos(turned)),
    }
    other = Recording(run.t_ns[:-40], {name: item[:-40] for name, item in signals.items()}, {}, run.variables, run.info)
    tolerances = Tolerances(Tolerance(absolute=1e-3, relative=0.0, time=time))
    there, back = compare(stored, other, tolerances), compare(other, stored, tolerances)
    traces.SPAN_ROWS, small = 1 << 18, traces.SPAN_ROWS
    expected = compare(run, other, tolerances), compare(other, run, tolerances)
    traces.SPAN_ROWS = small
    assert not there.passed
    for found, right in zip((there, back), expected, strict=True):
        assert {row.signal: row.passed for row in found.signals} == {row.signal: row.passed for row in right.signals}
        for one, two in zip(sorted(found.signals, key=key), sorted(right.signals, key=key), strict=True):
            assert one.model_dump() == pytest.approx(two.model_dump(), abs=1e-12)


def key(row: Any) -> str:
    return str(row.signal)


def test_an_exported_table_is_the_same(
    parked: tuple[Recording, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    texts = []
    for number, size in enumerate((64 << 20, 1 << 14)):
        monkeypatch.setattr(signal_blocks, "MEMORY_BYTES", size)
        monkeypatch.setattr(signal_blocks, "BLOCK_BYTES", 1 << 14)
        out = tmp_path / f"{number}.csv"
        assert main(["export", "csv", str(parked[1]), "--out", str(out), "--names"]) == 0
        texts.append(out.read_text())
    assert texts[0] == texts[1]
    assert texts[0].count("\n") == parked[0].count + 2


def test_an_mdf_file_of_a_long_run_is_the_same(
    parked: tuple[Recording, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asammdf = pytest.importorskip("asammdf")
    found = []
    for number, size in enumerate((64 << 20, 1 << 14)):
        monkeypatch.setattr(signal_blocks, "MEMORY_BYTES", size)
        monkeypatch.setattr(signal_blocks, "BLOCK_BYTES", 1 << 14)
        out = tmp_path / f"{number}.mf4"
        words = ["--signals", "vehicle.pose.*", "--signals", "controller.phase", "--out", str(out)]
        assert main(["export", "mf4", str(parked[1]), *words]) == 0
        with asammdf.MDF(out) as file:
            names = ("vehicle.pose.x", "vehicle.pose.heading", "controller.phase")
            found.append([(file.get(name).samples.tolist(), file.get(name).timestamps.tolist()) for name in names])
    assert found[0] == found[1]
    assert len(found[0][0][0]) == parked[0].count


def test_a_page_keeps_changes_and_extremes_of_a_long_run(
    parked: tuple[Recording, Path], stored: Recording, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("orchestrator.presentation.drawing.decimation.MAX_VALUES", 60_000)
    monkeypatch.setattr("orchestrator.presentation.drawing.decimation.MAX_STEP_ROWS", 300)
    run, shown = parked[0], decimate(stored, [3.337])
    assert shown.count < run.count / 2
    assert round(3.34, 9) in shown.t.round(9).tolist()
    for name in ("vehicle.pose.x", "vehicle.speed", "vehicle.steering_wheel_angle"):
        assert (shown.signals[name].min(), shown.signals[name].max()) == (
            run.signals[name].min(),
            run.signals[name].max(),
        )
    phases = run.signals["controller.phase"]
    changes = run.t[np.flatnonzero(np.diff(phases)) + 1]
    kept = shown.t[np.flatnonzero(np.diff(shown.signals["controller.phase"])) + 1]
    assert kept.tolist() == changes.tolist()
    assert 0.0 < deviation(stored, shown, ["vehicle.speed"]) < 0.2
    page = tmp_path / "report.html"
    assert main(["report", str(parked[1]), "--out", str(page)]) == 0
    assert f"of {run.count} instants shown" in page_text(page)


def page_text(page: Path) -> str:
    import base64
    import re
    import zlib

    text = page.read_text(encoding="utf-8")
    packed = next(item for item in re.findall(r">([A-Za-z0-9+/=\s]{1000,})<", text))
    raw = zlib.decompress(base64.b64decode(packed))
    return raw[4 : 4 + int.from_bytes(raw[:4], "little")].decode()


def long_log(path: Path, rows: int) -> None:
    """Write a log of a car on a circle, with ten more signals."""
    units = {"pose.x": "m", "pose.y": "m", "pose.heading": "rad", "speed": "m/s", "steering_wheel_angle": "rad"}
    units |= {f"more.s{k}": "1" for k in range(10)}
    variables = [Variable(name, float, Signal(unit, "a signal"), 0.0) for name, unit in units.items()]
    file, encoder = McapFile(path), Encoder(variables, room=HEADER_SIZE)
    channel = add_channel(file, "/vehicle", "Vehicle", variables, ["output"] * len(units))
    for begin in range(0, rows, 2000):
        t_ns = np.arange(begin, min(begin + 2000, rows)) * 10_000_000
        t = t_ns / 1e9
        turns = 0.1 * t
        values = [5 * np.sin(turns), 5 - 5 * np.cos(turns), np.mod(turns + 3, 6.28) - 3, 1 + 0.1 * np.sin(t), 0 * t + 5]
        values += [np.round(np.sin((k + 1) * turns), 6) for k in range(10)]
        file.write_rows(channel, t_ns, encoder.rows(np.column_stack(values)))
        file.flush()
    file.metadata("end", {"reason": json.dumps("stop_time"), "t_ns": json.dumps(rows * 10_000_000)})
    file.close()


def peak_mb(command: str, log: Path, folder: Path, setup: str = SMALL) -> float:
    """Return the peak memory of a command that reads a log; ``setup`` comes before it."""
    arguments = {
        "run": ["run", str(log), "--fmus", "native", "--set", "stop_time=36000", "--out", str(folder)],
        "check": ["check", str(log), "gbt41630"],
        "report": ["report", str(log), "--out", str(folder / "page.html")],
        "compare": ["compare", str(log), str(log), "--time", "0.05"],
        **{name: ["export", name, str(log), "--out", str(folder / f"run.{name}")] for name in ("csv", "mf4", "ros2")},
        "rerun": ["export", "rerun", str(log), "--out", str(folder / "run.rrd")],
    }[command]
    ran = subprocess.run([sys.executable, "-c", setup + CHILD, *arguments], capture_output=True, text=True, check=True)
    code, peak = json.loads(ran.stdout.splitlines()[-1])
    assert code in (0, 1), ran.stderr
    return float(peak)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="peak memory comes from getrusage")
@pytest.mark.parametrize("command", ["check", *(pytest.param(item, marks=pytest.mark.release) for item in RARER)])
def test_memory_does_not_grow_with_the_log(command: str, tmp_path: Path) -> None:
    """Read at once, the longer log takes 43 MB more."""
    peaks = []
    for rows in (40_000, 160_000):
        log = tmp_path / f"{rows}.mcap"
        long_log(log, rows)
        peaks.append(peak_mb(command, log, tmp_path))
    assert peaks[1] - peaks[0] < GROWTH_MB


@pytest.mark.release
@pytest.mark.skipif(sys.platform == "win32", reason="peak memory comes from getrusage")
def test_a_log_of_411_mb_takes_less_memory_than_it_has_bytes(tmp_path: Path) -> None:
    log = tmp_path / "run.mcap"
    long_log(log, FULL_ROWS)
    assert log.stat().st_size > 400e6
    for command in ("check", "report", "compare", "mf4", "ros2", "rerun"):
        assert peak_mb(command, log, tmp_path, "") < FULL_MB


@pytest.mark.release
@pytest.mark.skipif(sys.platform == "win32", reason="peak memory comes from getrusage")
def test_ten_hours_of_circles_are_run_judged_and_shown(show: Any, tmp_path: Path) -> None:
    assert peak_mb("run", CIRCLES, tmp_path, "") < FULL_MB
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["duration"] == 36_000.0
    assert summary["final"]["heading"] > 6000.0
    assert {check["id"]: check["passed"] for check in summary["checks"]}["speed"]
    page, seen = show(tmp_path / "report.html", "#t=30000")
    assert page.evaluate("performance.memory.usedJSHeapSize") < MAX_PAGE_BYTES
    assert page.locator(".plot canvas").count() >= 5
    assert seen.console == []


def test_the_trail_of_a_long_run_has_bounds_and_covers_all_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mcap_log, "MAX_TRAIL_POSES", 100)
    pictures = mcap_log._Pictures.__new__(mcap_log._Pictures)
    pictures._poses, pictures._trail_count, pictures._trail_stride = [], 0, 1
    for number in range(10_000):
        pictures._add_to_trail(str(number).encode())
    numbers = [int(pose) for pose in pictures._poses]
    assert len(numbers) <= 100
    assert set(np.diff(numbers)) == {pictures._trail_stride}
    assert numbers[0] == 0
    assert numbers[-1] > 10_000 - 2 * pictures._trail_stride
