"""A log cut off anywhere is repaired up to its last whole chunk; a killed run leaves such a log."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader

from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.log.read_log import read_log
from orchestrator.presentation.log.recover import recover
from orchestrator.session.session import run_scenario

DEMO = str(Path(__file__).with_name("demo.yaml"))
NEVER_ENDING = [
    *("--set", "stop_time=100000"),
    *("--set", "vehicle.driver.complies_with_stop=false"),
    *("--set", "vehicle.driver.complies_with_direction=false"),
    *("--set", "faults=[{signal: vehicle.brake_request, kind: override, value: false}]"),
]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("log") / "run.mcap"
    run_scenario(load_scenario(DEMO, ["stop_time=20"]), log=path)
    return path


def chunk_ends(path: Path) -> list[int]:
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    return [
        index.chunk_start_offset + index.chunk_length + index.message_index_length for index in summary.chunk_indexes
    ]


def test_all_whole_chunks_come_back_wherever_it_is_cut(whole: Path, tmp_path: Path) -> None:
    data, ends = whole.read_bytes(), chunk_ends(whole)
    before = read_log(whole)
    assert len(ends) > 4
    for cut in [ends[2], ends[2] + 1, (ends[2] + ends[3]) // 2, ends[3] - 1, ends[-1] + 40]:
        part = tmp_path / "run.mcap.part"
        part.write_bytes(data[:cut])
        (tmp_path / "run.mcap").unlink(missing_ok=True)
        found = recover(part)
        assert found.path == tmp_path / "run.mcap"
        assert not found.complete
        after = read_log(found.path)
        rows = len(after.t_ns)
        assert rows >= 3 * len(before.t_ns) // (len(ends) + 1) - 60
        for name, values in after.signals.items():
            assert np.ascontiguousarray(values).tobytes() == before.signals[name][:rows].tobytes(), name
        assert after.info["scenario"] == before.info["scenario"]


def test_more_of_the_file_never_means_less_of_the_log(whole: Path, tmp_path: Path) -> None:
    data, ends = whole.read_bytes(), chunk_ends(whole)
    part = tmp_path / "run.mcap.part"
    counts = []
    for cut in ends[1:]:
        part.write_bytes(data[:cut])
        counts.append(recover(part).messages)
    assert counts == sorted(set(counts))


def flipped(whole: Path, folder: Path, byte: int) -> Path:
    data = bytearray(whole.read_bytes())
    data[byte] ^= 0xFF
    path = folder / "run.mcap"
    path.write_bytes(data)
    return path


def test_what_stands_behind_a_broken_chunk_is_kept(whole: Path, tmp_path: Path) -> None:
    ends = chunk_ends(whole)
    broken = flipped(whole, tmp_path, ends[2] + 200)
    with pytest.raises(BadInput, match=rf"byte {ends[2]}: .*try: apa recover"):
        read_log(broken)
    found = recover(broken)
    assert found.path == tmp_path / "run.recovered.mcap"
    assert found.lost[0].startswith(f"byte {ends[2]}: ")
    after, before = read_log(found.path), read_log(whole)
    assert after.t_ns[-1] == before.t_ns[-1]
    assert 0 < after.count < before.count
    kept = before.rows(np.searchsorted(before.t_ns, after.t_ns))
    assert kept.t_ns.tolist() == after.t_ns.tolist()
    for name, values in kept.signals.items():
        assert values.tobytes() == after.signals[name].tobytes(), name


def test_a_mended_log_says_what_it_lacks(whole: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = recover(flipped(whole, tmp_path, chunk_ends(whole)[2] + 200))
    read_log(found.path)
    assert "is a repaired log; it lacks byte" in capsys.readouterr().err


@pytest.mark.parametrize("shift", [1, 5, 8])
def test_a_broken_length_costs_one_chunk(whole: Path, tmp_path: Path, shift: int) -> None:
    found = recover(flipped(whole, tmp_path, chunk_ends(whole)[2] + shift))
    after, before = read_log(found.path).t_ns, read_log(whole).t_ns
    assert after[-1] == before[-1]
    assert len(found.lost) >= 1
    assert len(after) > len(before) / 2


def test_a_whole_log_is_left_as_it_is(whole: Path, tmp_path: Path) -> None:
    copy = tmp_path / "run.mcap"
    copy.write_bytes(whole.read_bytes())
    found = recover(copy)
    assert found.complete
    assert found.path == copy
    assert [item.name for item in tmp_path.iterdir()] == ["run.mcap"]


def test_nothing_is_overwritten(whole: Path, tmp_path: Path) -> None:
    data = whole.read_bytes()
    (tmp_path / "run.mcap").write_bytes(data)
    (tmp_path / "run.mcap.part").write_bytes(data[: len(data) // 2])
    names = [recover(tmp_path / "run.mcap.part").path.name for _ in range(2)]
    assert names == ["run.recovered.mcap", "run.recovered-2.mcap"]
    assert (tmp_path / "run.mcap").read_bytes() == data


def test_no_single_flipped_bit_is_believed(whole: Path, tmp_path: Path) -> None:
    data = whole.read_bytes()
    path = tmp_path / "run.mcap"
    places = {*range(0, 80), *range(len(data) - 120, len(data)), *range(80, len(data), len(data) // 100)}
    for place in sorted(places):
        wrong = bytearray(data)
        wrong[place] ^= 1 << place % 8
        path.write_bytes(wrong)
        with pytest.raises(BadInput):
            read_log(path)


@pytest.mark.parametrize("content", [b"", b"no log", b"\x89MCAP0\r\n"])
def test_nothing_to_recover_is_explained(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "run.mcap.part"
    path.write_bytes(content)
    with pytest.raises(BadInput, match=r"run\.mcap\.part: (is no MCAP log|holds no complete chunk)"):
        recover(path)
    assert [item.name for item in tmp_path.iterdir()] == ["run.mcap.part"]
    with pytest.raises(BadInput, match="no such file"):
        recover(tmp_path / "none.part")


def start(out: Path) -> "subprocess.Popen[str]":
    command = [sys.executable, "-m", "orchestrator", "run", DEMO, "--fmus", "none", "--out", str(out), *NEVER_ENDING]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    part = out / "run.mcap.part"
    deadline = time.monotonic() + 120.0
    while not (part.exists() and part.stat().st_size > 400_000):
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.02)
    return process


def test_a_killed_run_leaves_all_but_the_last_chunk(tmp_path: Path) -> None:
    process = start(tmp_path)
    os.kill(process.pid, signal.SIGKILL)
    process.communicate()
    assert not (tmp_path / "run.mcap").exists()
    size = (tmp_path / "run.mcap.part").stat().st_size
    repaired = subprocess.run(
        [sys.executable, "-m", "orchestrator", "recover", str(tmp_path / "run.mcap.part")],
        capture_output=True,
        text=True,
        check=True,
    )
    assert "run.mcap" in repaired.stdout
    found = read_log(tmp_path / "run.mcap")
    assert np.diff(found.t_ns).tolist() == [10_000_000] * (len(found.t_ns) - 1)
    assert (tmp_path / "run.mcap").stat().st_size > size - 64 * 1024
    assert found.info["scenario"]["name"] == "demo"


def test_ctrl_c_ends_with_a_readable_log_and_130(tmp_path: Path) -> None:
    process = start(tmp_path)
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=120)
    assert process.returncode == 130, errors
    assert "aborted: interrupted" in output
    found = read_log(tmp_path / "run.mcap")
    assert found.info["end"]["reason"] == "interrupted"
    assert len(found.t_ns) > 1000
    assert not (tmp_path / "run.mcap.part").exists()
