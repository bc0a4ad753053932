"""A log cut off anywhere is mended up to its last whole chunk; a killed run leaves such a log."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader

from orchestrator.log.read_log import read_log
from orchestrator.log.recover import recover
from orchestrator.scenario.load_scenario import load_scenario
from orchestrator.session.session import run_scenario
from orchestrator.text.errors import BadInput

DEMO = str(Path(__file__).with_name("demo.yaml"))
NEVER_ENDING = [
    *("--set", "stop_time=100000"),
    *("--set", "vehicle.driver.obeys_stop=false"),
    *("--set", "vehicle.driver.obeys_direction=false"),
    *("--set", "faults=[{signal: vehicle.brake_request, kind: override, value: false}]"),
]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("log") / "run.mcap"
    run_scenario(load_scenario(DEMO, ["stop_time=6"]), log=path)
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


def test_a_broken_chunk_ends_the_mended_log(whole: Path, tmp_path: Path) -> None:
    data, ends = bytearray(whole.read_bytes()), chunk_ends(whole)
    data[ends[2] + 200] ^= 0xFF
    broken = tmp_path / "run.mcap"
    broken.write_bytes(data)
    found = recover(broken)
    assert found.path == tmp_path / "run.recovered.mcap"
    assert 0 < len(read_log(found.path).t_ns) < len(read_log(whole).t_ns)


def test_a_whole_log_stays_whole(whole: Path, tmp_path: Path) -> None:
    copy = tmp_path / "run.mcap"
    copy.write_bytes(whole.read_bytes())
    found = recover(copy)
    assert found.complete
    assert read_log(found.path).t_ns.tolist() == read_log(whole).t_ns.tolist()


@pytest.mark.parametrize("content", [b"", b"no log", b"\x89MCAP0\r\n"])
def test_nothing_to_recover_is_explained(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "run.mcap.part"
    path.write_bytes(content)
    with pytest.raises(BadInput, match=r"run\.mcap\.part: (is not an MCAP file|holds no complete chunk)"):
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
    mended = subprocess.run(
        [sys.executable, "-m", "orchestrator", "recover", str(tmp_path / "run.mcap.part")],
        capture_output=True,
        text=True,
        check=True,
    )
    assert "run.mcap" in mended.stdout
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
