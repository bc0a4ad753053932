"""What was found once, and a short attack of each kind with seeds that stay; ``make fuzz`` attacks for long."""

import subprocess
import sys
from pathlib import Path

import pytest

from orchestrator.inputs.text.errors import INTERRUPTED
from tests.fuzz.limits import ask
from tests.fuzz.logs import retold
from tests.fuzz.more_texts import COLUMNS, STEP_TEST

ROOT = Path(__file__).parents[2]
CORPUS = Path(__file__).parent / "corpus"
FILES = sorted(CORPUS.glob("*.yaml"))
SETTINGS = (CORPUS / "settings.txt").read_text().splitlines()
METADATA_LINES = (CORPUS / "metadata.txt").read_text().splitlines()


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("log")
    ask(["run", "guo2015-case4", "--set", "stop_time=0.3", "--fmus", "none", "--no-page", "--out", str(folder)])
    return folder / "run.mcap"


@pytest.mark.parametrize("file", FILES, ids=lambda path: path.stem)
def test_a_file_that_broke_it_once_is_refused_in_a_line(file: Path, log: Path, tmp_path: Path) -> None:
    words = {
        "run": ["run", str(file), "--fmus", "none", "--no-page", "--out", str(tmp_path)],
        "sweep": ["sweep", str(file), "--no-page", "--out", str(tmp_path)],
        "check": ["check", str(log), str(file)],
        "compare": ["compare", str(log), str(log), "--tolerances", str(file)],
    }
    answer = ask(words[file.name.partition("-")[0]], 5.0)
    assert not answer.mistake, answer.mistake
    if file.stem != "run-date":
        assert answer.code == 2, answer
        assert answer.err.count("\n") == 1
        assert len(answer.err) < 1000


@pytest.mark.parametrize("line", SETTINGS)
def test_settings_that_broke_it_once_are_refused_in_a_line(line: str, tmp_path: Path) -> None:
    sets = [part for text in line.split(" ") for part in ("--set", text.replace("\\udc80", "\udc80"))]
    if line.startswith(("faults", "requirements")):
        sets = ["--set", line]
    answer = ask(["run", "guo2015-case4", *sets, "--fmus", "none", "--no-page", "--out", str(tmp_path)], 5.0)
    assert not answer.mistake, answer.mistake
    assert answer.code == 2, answer
    assert answer.err.count("\n") == 1


@pytest.mark.parametrize("line", METADATA_LINES)
def test_metadata_that_broke_it_once_is_refused_in_a_line(line: str, log: Path, tmp_path: Path) -> None:
    key, _, text = line.partition(" ")
    odd = tmp_path / "odd.mcap"
    odd.write_bytes(retold(log.read_bytes(), key, text))
    for words in (["report", str(odd), "--out", str(tmp_path / "page.html")], ["check", str(odd), "project"]):
        answer = ask(words, 5.0)
        assert not answer.mistake, answer.mistake
        assert answer.code == 2, answer
        assert [part for part in answer.err.splitlines() if "warning" not in part] == [answer.err.splitlines()[-1]]


@pytest.mark.parametrize("columns", [b"", b"brake", b"t,brake\n0", b"t,brake\ns,1", b"\xff\xfe", b"0,1\n0,1"])
def test_columns_that_broke_a_step_test_once_are_refused(columns: bytes, tmp_path: Path) -> None:
    (tmp_path / "odd.yaml").write_text(STEP_TEST)
    (tmp_path / "odd.csv").write_bytes(columns)
    answer = ask(["test", str(tmp_path / "odd.yaml"), "--fmus", "none", "--out", str(tmp_path / "out")], 10.0)
    assert not answer.mistake, answer.mistake
    assert answer.code == 2, answer


@pytest.mark.parametrize("notes", ["{}", "[]", "[[1]]", '{"odd": 1}', "[" * 5000, "{"])
def test_finds_that_are_none_are_refused_in_a_line(notes: str, tmp_path: Path) -> None:
    (tmp_path / "odd.yaml").write_text("name: odd\nextends: guo2015-case4\n")
    (tmp_path / "counterexamples.json").write_text(notes)
    answer = ask(["falsify", "--regression", str(tmp_path)], 10.0)
    assert not answer.mistake, answer.mistake
    assert answer.code == 2, answer
    assert answer.err.count("\n") == 1


@pytest.mark.parametrize("name", ["..", ".hidden", "a" * 150, "\udc80", "#", "é"])
def test_names_that_are_none_cost_that_test_alone(name: str, tmp_path: Path) -> None:
    file = tmp_path / f"{name}.yaml"
    file.write_text(STEP_TEST.replace("title: odd", 'name: ".."'))
    (tmp_path / "odd.csv").write_text(COLUMNS)
    answer = ask(["test", str(file), name, "--fmus", "none", "--out", str(tmp_path / "out")], 10.0)
    assert not answer.mistake, answer.mistake
    assert answer.code == 2
    assert "1 of 2" in answer.out
    assert (tmp_path / "out" / "junit.xml").is_file()


@pytest.mark.release
@pytest.mark.parametrize(
    ("kind", "seconds"),
    [
        *(("inputs", 5), ("tables", 3), ("ssp", 3), ("logs", 5), ("calls", 2), ("kills", 10)),
        *(("fmus", 3), ("journals", 5), ("parquet", 5), ("scenes", 3), ("drives", 5), ("policies", 5)),
    ],
)
def test_a_short_attack(kind: str, seconds: int, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tests.fuzz", kind, "--seconds", str(seconds), "--seed", "20150915"]
    done = subprocess.run([*command, "--finds", str(tmp_path)], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    assert " 0 found" in done.stdout


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # the log is left open
@pytest.mark.parametrize(
    "words", [["run", "guo2015-case4", "--no-page"], ["test", "guo2015-case4"]], ids=lambda words: words[0]
)
def test_a_run_that_is_long_by_request_does_not_hang(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("orchestrator.inputs.text.console.PERIOD", 0.01)
    answer = ask(
        [*words, "--set", "step=1e-8", "--set", "stop_time=0.02", "--fmus", "none", "--out", str(tmp_path)], 1.0
    )
    assert not answer.mistake, answer.mistake
    assert answer.code == INTERRUPTED
