"""Every command with a place that cannot be written, or has an odd name: one line and its code, or the results."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.fuzz.limits import ask
from tests.fuzz.more_texts import SCENE

ROOT = Path(__file__).parents[2]
SHORT = ["guo2015-case4", "--set", "stop_time=0.3", "--fmus", "none"]
COMMANDS = {
    "run": ["run", *SHORT, "--out", "DIR"],
    "test": ["test", *SHORT, "--out", "DIR"],
    "test --junit": ["test", *SHORT, "--out", "KEPT/test", "--junit", "FILE.xml"],
    "sweep": ["sweep", "guo2015-trial", "--stride", "250", "--out", "DIR"],
    "sweep --figure": ["sweep", "guo2015-trial", "--stride", "250", "--out", "KEPT/study", "--figure", "FILE.png"],
    "check --junit": ["check", "LOG", "project", "--junit", "FILE.xml"],
    "compare --html": ["compare", "LOG", "LOG", "--html", "FILE.html"],
    "report": ["report", "LOG", "--out", "FILE.html"],
    "export csv": ["export", "csv", "LOG", "--out", "FILE.csv"],
    "export mf4": ["export", "mf4", "LOG", "--out", "FILE.mf4"],
    "export ssp": ["export", "ssp", "guo2015-case4", "--fmus", "python", "--out", "FILE.ssp"],
    "export c": ["export", "c", "DIR"],
    "replay": ["replay", "TABLE", "--row", "0", "--out", "DIR"],
    "build": ["build", "--fmus", "python", "--out", "DIR"],
    "recover": ["recover", "PART"],
    "live": ["live", "guo2015-case4", "--out", "FILE.html"],
    "new": ["new", "controller", "my_law", "--out", "DIR"],
    "import": ["import", "tpcap", "SCENE", "--out", "DIR"],
    "falsify": ["falsify", "guo2015-trial", "--budget", "50", "--jobs", "1", "--out", "DIR"],
    "test --coverage": ["test", *SHORT, "--coverage", "--out", "DIR"],
    "export rerun": ["export", "rerun", "LOG", "--out", "FILE.rrd"],
}

SAME_PATH = ("test", "test --coverage", "sweep", "export mf4", "export rerun", "export ssp", "falsify")
"""Commands that write their path as another one does: ``test --junit``, ``sweep --figure``, ``export csv``."""
EACH_CHANGE = [
    pytest.param(name, marks=pytest.mark.release if name in SAME_PATH else ()) for name in COMMANDS if name != "recover"
]


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a log, one that was cut, and a table."""
    folder = tmp_path_factory.mktemp("kept")
    ask(["run", *SHORT, "--no-page", "--out", str(folder)])
    ask(["sweep", "guo2015-trial", "--stride", "250", "--no-page", "--out", str(folder)])
    data = (folder / "run.mcap").read_bytes()
    (folder / "cut.mcap.part").write_bytes(data[: 9 * len(data) // 10])
    return folder


def words(command: str, kept: Path, folder: Path) -> list[str]:
    """Return the command line that writes to ``folder``."""
    part = folder / "cut.mcap.part"
    if command == "recover" and folder.is_dir() and not part.exists():
        try:
            shutil.copyfile(kept / "cut.mcap.part", part)
        except OSError:
            part.unlink(missing_ok=True)
            (folder / "cut.mcap.part").symlink_to(kept / "cut.mcap.part")
    scene = kept / "scene.csv"
    scene.write_text(SCENE)
    table = kept / "guo2015-trial.parquet"
    places = {"SCENE": scene, "DIR": folder / "dir", "LOG": kept / "run.mcap", "TABLE": table, "PART": part}
    found = []
    for word in COMMANDS[command]:
        word = str(places.get(word, word))
        word = word.replace("KEPT", str(kept))
        found.append(str(folder / word) if word.startswith("FILE.") else word)
    return found


def one_line(command: list[str]) -> str:
    """Return the line that a command ends with, code 2."""
    answer = ask(command, 60.0)
    assert not answer.mistake, answer.mistake
    lines = [line for line in answer.err.splitlines() if line.startswith("apa: ") and "warning" not in line]
    assert answer.code == 2, answer
    assert len(lines) == 1 or (command[0] == "test" and "FAIL" in answer.out), answer.err
    return "\n".join([*lines, answer.out])


@pytest.mark.parametrize("command", EACH_CHANGE)
def test_a_file_where_a_folder_should_be(command: str, kept: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    assert "file: is a file, expected a folder" in one_line(words(command, kept, tmp_path / "file"))
    assert (tmp_path / "file").read_text() == "mine"


@pytest.mark.parametrize("command", [name for name, asked in COMMANDS.items() if any("FILE" in word for word in asked)])
def test_a_folder_where_a_file_should_be(command: str, kept: Path, tmp_path: Path) -> None:
    asked = words(command, kept, tmp_path)
    (tmp_path / asked[-1]).mkdir()
    assert "is a folder, expected a file" in one_line(asked)
    assert [path.name for path in tmp_path.iterdir()] == [Path(asked[-1]).name]


@pytest.mark.parametrize("command", ["report", "export csv", "check --junit"])
def test_links_in_a_ring_and_the_root(command: str, kept: Path, tmp_path: Path) -> None:
    asked = words(command, kept, tmp_path)
    Path(asked[-1]).symlink_to(Path(asked[-1]).name)
    assert "too many levels of symbolic links (a cycle)" in one_line(asked)
    assert "is a folder, expected a file" in one_line([*asked[:-1], "/"])


def test_a_folder_where_the_log_should_be(tmp_path: Path) -> None:
    (tmp_path / "run.mcap" / "x").mkdir(parents=True)
    assert "run.mcap" in one_line(["run", *SHORT, "--no-page", "--out", str(tmp_path)])


@pytest.fixture
def small(tmp_path: Path) -> Iterator[Path]:
    """A disk of 64 kB."""
    yield from mounted(tmp_path / "small", "size=64k")


def mounted(folder: Path, how: str) -> Iterator[Path]:
    folder.mkdir()
    mount = shutil.which("mount")
    done = mount and subprocess.run([mount, "-t", "tmpfs", "-o", how, "tmpfs", folder], capture_output=True)
    if not done or done.returncode:
        pytest.skip("no disk can be mounted here")
    try:
        yield folder
    finally:
        subprocess.run(["umount", "-l", folder], check=True)


@pytest.mark.parametrize("command", COMMANDS)
def test_a_full_disk(command: str, kept: Path, small: Path) -> None:
    asked = words(command, kept, small)
    with (small / "fill").open("wb", buffering=0) as fill:
        while fill.write(bytes(4096)) == 4096 and os.statvfs(small).f_bavail > 0:
            pass
    answer = one_line(asked)
    assert "the disk is full" in answer
    assert not [path for path in small.rglob("*") if path.name.startswith(".apa")]


@pytest.mark.parametrize("command", ["run", "test", "sweep", "export csv", "build", "recover"])
def test_a_disk_that_is_read_only(command: str, kept: Path, tmp_path: Path) -> None:
    for folder in mounted(tmp_path / "ro", "size=4m"):
        asked = words(command, kept, folder)
        subprocess.run(["mount", "-o", "remount,ro", folder], check=True)
        assert "read-only" in one_line(asked)


@pytest.mark.parametrize("command", [*EACH_CHANGE, "recover"])
def test_an_odd_path(command: str, kept: Path, tmp_path: Path) -> None:
    folder = tmp_path / "a +b (c) 'd' #1 %20 & é"
    folder.mkdir()
    answer = ask(words(command, kept, folder), 60.0)
    assert not answer.mistake, answer.mistake
    assert answer.code in (0, 1), answer.err
    assert len(list(folder.iterdir())) >= 1


@pytest.mark.skipif(sys.platform != "linux", reason="names are any bytes on Linux only")
@pytest.mark.parametrize("command", ["compare --html", "report", "identify"])
def test_a_log_in_a_folder_whose_name_is_no_word(command: str, kept: Path, tmp_path: Path) -> None:
    folder = tmp_path / os.fsdecode(b"a b\xffd")
    folder.mkdir()
    log = str(shutil.copy(kept / "run.mcap", folder))
    options = {"compare --html": ["compare", log, log, "--html"], "report": ["report", log, "--out"]}
    given = [*options.get(command, ["identify", log, "--out"]), str(folder / "new")]
    answer = ask(given, 60.0)
    assert not answer.mistake, answer.mistake
    assert answer.code in (0, 1), answer.err
    assert (folder / "new").is_file() or (folder / "new" / "report.html").is_file()


@pytest.mark.release
@pytest.mark.parametrize("kind", ["none", "python", "native"])
def test_without_home_in_odd_folders_and_a_narrow_terminal(kind: str, tmp_path: Path) -> None:
    odd = tmp_path / "t %23 + ; é"
    odd.mkdir()
    environment = {key: value for key, value in os.environ.items() if key not in ("HOME", "XDG_CACHE_HOME")}
    environment |= {"PYTHONPATH": str(ROOT), "TMPDIR": str(odd), "PYTHONIOENCODING": "cp1252"}
    command = [sys.executable, "-m", "orchestrator", "run", "guo2015-case4", "--fmus", kind, "--out", str(odd / "run")]
    done = subprocess.run([*command, "--set", "title=→"], env=environment, capture_output=True)
    assert done.returncode == 0, done.stderr
    assert {path.name for path in (odd / "run").iterdir()} >= {"run.mcap", "summary.json", "report.html"}
