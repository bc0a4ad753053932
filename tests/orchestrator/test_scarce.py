"""Little memory, few descriptors, a closed stream, a folder that is gone: one line and exit code 2, or the result."""

import errno
import os
import subprocess
import sys
from pathlib import Path

import pytest
from mcap.records import Channel

from orchestrator.inputs.text.failures import place_of
from orchestrator.presentation.log import records
from orchestrator.simulation.cosim import model_description

resource = pytest.importorskip("resource", reason="limits of this kind are POSIX's")
RUN = ["run", "guo2015-case4", "--fmus", "none", "--no-page"]
STUDY = ["sweep", "guo2015-trial", "--stride", "250"]


def ran(words: list[str], folder: Path, limits: dict[str, int]) -> subprocess.CompletedProcess[str]:
    def limit() -> None:
        for name, value in limits.items():
            resource.setrlimit(getattr(resource, name), (value, value))

    command = [sys.executable, "-c", "from orchestrator.cli import main; raise SystemExit(main())", *words]
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    return subprocess.run(
        command, cwd=folder, env=environment, preexec_fn=limit, capture_output=True, text=True, check=False, timeout=300
    )


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="limits are kept by Linux")
@pytest.mark.parametrize("megabytes", [400, pytest.param(1_100, marks=pytest.mark.release)])
def test_a_study_neither_hangs_nor_aborts_when_memory_is_scarce(megabytes: int, tmp_path: Path) -> None:
    """In the native libraries of scipy and Arrow it would do one or the other."""
    done = ran([*STUDY, "--out", str(tmp_path / "out")], tmp_path, {"RLIMIT_AS": megabytes * 1_000_000})
    assert done.returncode == 2, done.stderr
    assert done.stderr.count("\n") == 1
    assert "more memory" in done.stderr


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="limits are kept by Linux")
@pytest.mark.parametrize(
    "command", ["rerun", *(pytest.param(item, marks=pytest.mark.release) for item in ("csv", "mf4", "ros2"))]
)
def test_an_export_to_a_disk_that_is_full_ends_in_one_line(command: str, tmp_path: Path) -> None:
    """rerun-sdk waits for ever where it writes to a file itself."""
    pytest.importorskip({"mf4": "asammdf"}.get(command, command if command == "rerun" else "mcap"))
    out = tmp_path / "out"
    assert ran([*RUN, "--set", "stop_time=1", "--out", str(out)], tmp_path, {}).returncode in (0, 1)
    before = sorted(out.iterdir())
    words = ["export", command, str(out / "run.mcap")]
    done = ran(words, tmp_path, {"RLIMIT_FSIZE": 8192})
    assert done.returncode == 2, done.stderr
    assert done.stderr.count("\n") == 1
    assert "larger than is allowed" in done.stderr
    assert sorted(out.iterdir()) == before


@pytest.mark.release
@pytest.mark.skipif(sys.platform != "linux", reason="no folder can be made below a device")
def test_a_figure_needs_no_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """matplotlib says in two lines that its folder cannot be made."""
    monkeypatch.setenv("HOME", "/dev/null")
    for name in ("XDG_CONFIG_HOME", "XDG_CACHE_HOME", "MPLCONFIGDIR"):
        monkeypatch.delenv(name, raising=False)
    done = ran(
        ["run", "guo2015-case4", "--fmus", "none", "--set", "stop_time=0.2", "--out", str(tmp_path / "out")],
        tmp_path,
        {},
    )
    assert done.returncode in (0, 1), done.stderr
    assert (tmp_path / "out" / "overview.png").exists()
    assert "atplotlib" not in done.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="Linux has a device that is full")
def test_a_study_goes_on_when_its_progress_cannot_be_written(tmp_path: Path) -> None:
    often = "from orchestrator.inputs.text import console; console.PERIOD = 1e-3; console.LONGEST = 1e-3"
    code = f"{often}; from orchestrator.cli import main; raise SystemExit(main())"
    words = [*STUDY, "--fmus", "none", "--jobs", "1", "--no-page", "--out", str(tmp_path / "out")]
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    with open("/dev/full", "w") as full:
        done = subprocess.run([sys.executable, "-c", code, *words], env=environment, stderr=full, check=False)
    assert done.returncode == 0
    assert (tmp_path / "out" / "guo2015-trial.parquet").is_file()


def test_no_more_processes_are_said_with_the_limit() -> None:
    assert "ulimit -u" in place_of(BlockingIOError(errno.EAGAIN, "Resource temporarily unavailable"))


def test_a_folder_that_is_gone_is_named(tmp_path: Path) -> None:
    gone = tmp_path / "gone"
    gone.mkdir()
    remove = f"import os; os.rmdir({str(gone)!r})"
    code = f"{remove}; from orchestrator.cli import main; raise SystemExit(main())"
    done = subprocess.run(
        [sys.executable, "-c", code, *RUN],
        cwd=gone,
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert "the current folder is gone" in done.stderr


@pytest.mark.parametrize("error", [OSError(errno.EMFILE, "Too many open files"), MemoryError()])
def test_a_file_is_not_to_blame_for_scarce_resources(
    error: Exception, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(model_description, "read_model_description", fails)
    with pytest.raises(type(error)):
        model_description.read_description(tmp_path / "none.fmu")
    monkeypatch.setattr(records, "ReadDataStream", fails)
    with pytest.raises(type(error)):
        records.parse_record(Channel, records.RawRecord(0, 4, memoryview(b"")))
