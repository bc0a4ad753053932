"""Code that comes with a file is run only where its folder is trusted."""

from pathlib import Path

import pytest

from orchestrator.cli import main
from orchestrator.inputs.text.errors import BadInput
from orchestrator.session.trust import VARIABLE, is_trusted, trusting
from orchestrator.studies.sweep.repeat import NEEDED, write_scenario

LAW = """
from pathlib import Path
Path({mark!r}).write_text("ran")
raise ImportError("seen enough")
"""
SCENARIO = "name: got\nextends: guo2015-case4\nsystem:\n  components: {controller: law.py:MODEL}\n"
STEP_TEST = (
    "model: law.py:MODEL\nname: got\nstop_time: 1\nstep: 0.01\nexpect:\n  - {id: small, signal: y, always: {max: 1}}\n"
)
STUDY = "name: study\nscenario: got.yaml\nruns: {grid: {vehicle.start.x: [0, 0.1]}}\n"


@pytest.fixture
def received(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder with third-party files; their code writes the file ``ran`` beside the folder."""
    monkeypatch.delenv(VARIABLE)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "received"
    folder.mkdir()
    (folder / "law.py").write_text(LAW.format(mark=str(tmp_path / "ran")))
    (folder / "got.yaml").write_text(SCENARIO)
    (folder / "step.yaml").write_text(STEP_TEST)
    (folder / "study.yaml").write_text(STUDY)
    return folder


COMMANDS = {
    "run": ["run", "got.yaml"],
    "test": ["test", "-j", "2", "got.yaml"],
    "step test": ["test", "step.yaml"],
    "sweep": ["sweep", "study.yaml"],
}


@pytest.mark.parametrize("command", COMMANDS)
def test_code_in_a_received_folder_is_not_run(command: str, received: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = COMMANDS[command]
    assert main([*words[:-1], str(received / words[-1])]) == 2
    out, err = capsys.readouterr()
    assert "add --trust if you trust" in out + err
    assert not (received.parent / "ran").exists()


def test_trust_is_remembered_for_the_folder_and_those_in_it(received: Path) -> None:
    words = ["run", str(received / "got.yaml"), "--no-page"]
    assert main([*words, "--trust"]) == 2  # the model itself is none
    assert (received.parent / "ran").exists()
    (received.parent / "ran").unlink()
    assert main(words) == 2
    assert (received.parent / "ran").exists()
    assert is_trusted(received / "deeper")
    assert not is_trusted(received.parent)


def test_what_the_command_line_names_needs_no_question(received: Path) -> None:
    assert main(["run", "guo2015-case4", "--controller", str(received / "law.py:MODEL")]) == 2
    assert (received.parent / "ran").exists()


def test_a_table_asks_before_its_code_is_imported(received: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The table says of which file its scenario's controller is, by an absolute path."""
    monkeypatch.setenv(VARIABLE, "all")
    from orchestrator.inputs.scenario.load_scenario import load_scenario

    scenario = load_scenario(str(received / "got.yaml"), [])
    monkeypatch.delenv(VARIABLE)
    monkeypatch.setattr("orchestrator.studies.sweep.repeat.chunk_scenario", lambda *_: scenario)
    table = type("Fake", (), {"path": received / "else.parquet", "job": None, "about": {"study": {"name": "x"}}})
    table.chunk = lambda number: None  # type: ignore[attr-defined]
    table.names = lambda: NEEDED  # type: ignore[attr-defined]
    with trusting("ask"), pytest.raises(BadInput, match="add --trust"):
        write_scenario(table, 0, received.parent / "row.yaml")  # type: ignore[arg-type]
    assert not (received.parent / "ran").exists()


def test_what_apa_new_has_written_is_trusted(received: Path, tmp_path: Path) -> None:
    assert main(["new", "controller", "mine", "--out", str(tmp_path)]) == 0
    assert is_trusted(tmp_path / "mine")
    assert not is_trusted(tmp_path)
