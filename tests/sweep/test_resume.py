"""A study that is killed, interrupted, finished elsewhere, and its rows run again."""

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from orchestrator.cli import main
from orchestrator.inputs.text.errors import BadInput
from orchestrator.studies.sweep.table import Table

STUDY = """
name: trial
scenario: guo2015-case4
runs:
  grid: {controller.system: [ntbpt, ntbptcwpt]}
  latin_hypercube:
    n: 100
    "vehicle.driver.profile[1].speed": {uniform: [2 km/h, 2.0]}
    vehicle.start.y: {uniform: [-10 cm, 10 cm]}
"""
COUNT = 200
CHUNK = 10


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Any:
    path = tmp_path_factory.mktemp("study") / "trial.yaml"
    path.write_text(STUDY)
    return path


@pytest.fixture(scope="module")
def whole(study: Any, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The table of a study that nothing happened to."""
    return sweep(study, tmp_path_factory.mktemp("whole"))


def sweep(study: Any, out: Any, *more: Any) -> Any:
    assert main(["sweep", str(study), "--out", str(out), "--chunk", str(CHUNK), "--no-page", *more]) == 0
    return out / "trial.parquet"


def begun(study: Any, out: Any, *more: Any) -> Any:
    command = [sys.executable, "-m", "orchestrator", "sweep", str(study), "--out", str(out), "--chunk", str(CHUNK)]
    return subprocess.Popen([*command, "--no-page", *more], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def parts(out: Any) -> Any:
    return sorted((out / "parts").glob("*.parquet"))


def wait_for_parts(process: Any, out: Any, count: Any) -> None:
    while len(parts(out)) < count:
        assert process.poll() is None, process.communicate()
        time.sleep(0.005)


@pytest.fixture(scope="module")
def killed(study: Any, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The folder of a study that was killed; tests copy it before they go on with it."""
    folder = tmp_path_factory.mktemp("killed")
    process = begun(study, folder, "--jobs", "1")
    wait_for_parts(process, folder, 3)
    os.kill(process.pid, signal.SIGKILL)
    process.communicate()
    return folder


@pytest.fixture
def small(study: Any, tmp_path: Path) -> Any:
    """A study of four runs."""
    path = tmp_path / "small" / "trial.yaml"
    path.parent.mkdir()
    path.write_text(study.read_text().replace("n: 100", "n: 2"))
    return path


def test_a_killed_study_goes_on_to_the_same_bytes(study: Any, killed: Any, whole: Any, tmp_path: Path) -> None:
    shutil.copytree(killed, tmp_path, dirs_exist_ok=True)
    kept = {path: path.stat().st_mtime_ns for path in parts(tmp_path)}
    assert 3 <= len(kept) < COUNT / CHUNK
    again = begun(study, tmp_path, "--jobs", "1", "--resume")
    wait_for_parts(again, tmp_path, len(kept) + 2)
    os.kill(again.pid, signal.SIGKILL)
    again.communicate()
    assert {path: path.stat().st_mtime_ns for path in kept} == kept
    assert sweep(study, tmp_path, "--resume").read_bytes() == whole.read_bytes()
    assert not (tmp_path / "parts").exists()


def test_an_interrupted_study_keeps_what_is_done(study: Any, whole: Any, tmp_path: Path) -> None:
    process = begun(study, tmp_path, "--jobs", "1")
    wait_for_parts(process, tmp_path, 2)
    process.send_signal(signal.SIGINT)
    out, error = process.communicate()
    assert process.returncode == 130, error
    assert f"go on with: apa sweep {study} --out {tmp_path} " in " ".join(out.split())
    assert out.split("\n")[-2].endswith("--resume")
    assert f"{len(parts(tmp_path)) * CHUNK} of {COUNT} runs are kept" in out
    assert sweep(study, tmp_path, "--resume").read_bytes() == whole.read_bytes()


def test_an_unfinished_study_is_not_overwritten_unasked(
    study: Any, small: Any, killed: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "parts").mkdir()
    sweep(small, tmp_path)  # an empty folder is no unfinished study
    shutil.copytree(killed, tmp_path, dirs_exist_ok=True)
    assert main(["sweep", str(study), "--out", str(tmp_path), "--no-page"]) == 2
    assert "--resume goes on, --restart" in capsys.readouterr().err
    other = tmp_path / "other.yaml"
    other.write_text(study.read_text().replace("2.0]", "2.1]"))
    assert main(["sweep", str(other), "--out", str(tmp_path), "--no-page", "--resume"]) == 2
    assert "made with another design and study" in capsys.readouterr().err
    finished = Table(sweep(small, tmp_path, "--restart"))
    assert finished.count == 4
    assert main(["sweep", str(study), "--out", str(tmp_path), "--no-page", "--resume"]) == 2
    assert f"{finished.path}: its runs were made with another design and job and study" in capsys.readouterr().err


def test_a_study_may_be_finished_by_another_engine(small: Any, tmp_path: Path) -> None:
    common = ["sweep", str(small), "--no-page", "--chunk", "2", "--set", "stop_time=3", "--out"]
    assert main([*common, str(tmp_path / "batch")]) == 0
    assert main([*common, str(tmp_path / "fmus"), "--fmus", "native"]) == 0
    tables = [(tmp_path / kind / "trial.parquet").read_bytes() for kind in ("batch", "fmus")]
    assert tables[0] == tables[1]


def test_rows_come_in_order_with_units_and_study(whole: Any) -> None:
    table = Table(whole)
    assert table.count == COUNT
    assert table.column("row").tolist() == list(range(COUNT))
    assert table.note("final.heading_error")[0] == "rad"
    states = table.note("controller.system")[2]
    assert (states["0"], states["1"]) == ("NTBPTCWPT", "NTBPT")
    assert table.about["study"]["scenario"] == "guo2015-case4"
    assert set(table.column("outcome")) >= {"parked", "failed"}


def test_any_row_can_be_replayed_with_the_same_bits(
    whole: Any, some: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for number in some(COUNT, 2, seed=12):
        out = tmp_path / str(number)
        code = main(["replay", str(whole), "--row", str(number), "--out", str(out), "--no-page"])
        assert "same bits as in the table" in capsys.readouterr().out
        assert code == (0 if Table(whole).row(number)["outcome"] == "parked" else 1)
        assert (out / "run.mcap").stat().st_size > 10_000


def test_a_row_can_be_replayed_on_fmus(whole: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["replay", str(whole), "--row", "150", "--out", str(tmp_path), "--no-page", "--fmus", "python"])
    assert "same bits as in the table" in capsys.readouterr().out


def test_a_replay_says_if_the_bits_differ(
    whole: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    original = Table.row
    monkeypatch.setattr(Table, "row", lambda self, number: {**original(self, number), "max_speed": 1e-3})
    assert main(["replay", str(whole), "--row", "3", "--out", str(tmp_path), "--no-page"]) == 2
    assert "differs from the table: max_speed" in capsys.readouterr().out


@pytest.mark.parametrize("row", ["-1", str(COUNT)])
def test_a_row_that_is_not_there(whole: Any, row: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["replay", str(whole), "--row", row]) == 2
    assert f"expected 0 to {COUNT - 1}" in capsys.readouterr().err


def test_no_bit_of_a_table_can_be_changed_and_believed(whole: Any, tmp_path: Path) -> None:
    def content(path: Any) -> Any:
        table = Table(path)
        notes = [(name, table.note(name)) for name in table.names()]
        return str((table.about, notes, [table.column(name).tolist() for name in table.names()]))

    data, odd, draw = whole.read_bytes(), tmp_path / "odd.parquet", random.Random(5)
    reported = content(whole)
    described = int.from_bytes(data[-8:-4], "little") + 8
    refused = 0
    for number in range(150):
        at = draw.randrange(len(data) - described if number % 2 else 0, len(data))
        odd.write_bytes(data[:at] + bytes([data[at] ^ 1 << draw.randrange(8)]) + data[at + 1 :])
        try:
            assert content(odd) == reported, at
        except BadInput:
            refused += 1
    assert refused > 50
    place = data.index(b"apa.checksum", len(data) - described)
    for at in range(place - 2, place + 80):
        odd.write_bytes(data[:at] + bytes([data[at] ^ 1 << draw.randrange(8)]) + data[at + 1 :])
        with pytest.raises(BadInput):
            Table(odd)


def test_what_is_no_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path(tmp_path / "a.parquet").write_text("no")
    assert main(["replay", str(tmp_path / "a.parquet"), "--row", "0"]) == 2
    assert "cannot be read as a table" in capsys.readouterr().err


def test_set_and_json(study: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["sweep", str(study), "--out", str(tmp_path), "--no-page", "--set", "vehicle.start.x=1 cm", "--json"]
    assert main(arguments) == 0
    reported = json.loads(capsys.readouterr().out)
    assert (reported["count"], reported["made"], reported["table"]) == (COUNT, COUNT, str(tmp_path / "trial.parquet"))
    assert Table(Path(reported["table"])).job.scenario["vehicle"]["start.x"] == 0.01
    assert main(["sweep", str(study), "--out", str(tmp_path), "--set", "nothing"]) == 2


def without(column: str) -> Callable[[Any, dict[str, Any]], Any]:
    return lambda found, about: found.drop_columns([column])


def about(change: Callable[[dict[str, Any]], object]) -> Callable[[Any, dict[str, Any]], Any]:
    def changed(found: Any, reported: dict[str, Any]) -> Any:
        change(reported)
        return found

    return changed


FORGED = {
    "no final pose": without("final.x"),
    "no outcome": without("outcome"),
    "no seed": without("run_seed"),
    "key of no scenario": about(lambda reported: reported["job"]["scenario"].update({"start.y": 1.0})),
    "scenario without target": about(lambda reported: reported["job"]["scenario"].pop("target")),
    "scenario of numbers": about(lambda reported: reported["job"].update(scenario=5)),
    "study without a name": about(lambda reported: reported["study"].pop("name")),
    "labels of numbers": about(lambda reported: reported["study"].update(labels=[1])),
    "sources of numbers": about(lambda reported: reported.update(sources=1)),
}


@pytest.mark.parametrize("name", FORGED)
def test_a_table_that_says_something_else_is_refused_in_one_line(
    name: str, whole: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its checksum is right, or it has none, as tables of older versions."""
    import pyarrow.parquet as pq

    found = pq.read_table(whole)
    reported = json.loads(found.schema.metadata[b"apa"])
    odd = FORGED[name](found, reported)
    pq.write_table(odd.replace_schema_metadata({b"apa": json.dumps(reported).encode()}), tmp_path / "odd.parquet")
    assert main(["replay", str(tmp_path / "odd.parquet"), "--row", "0", "--no-page"]) == 2
    (*warnings, said) = capsys.readouterr().err.splitlines()
    assert all("has no checksum" in line for line in warnings)
    assert said.startswith(f"apa: {tmp_path / 'odd.parquet'}")
