"""Exports of a run, read back with the tools they are for."""

import csv
import importlib
import pkgutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestrator.cli import main
from orchestrator.commands.export import FORMATS
from orchestrator.inputs.text.patterns import matching
from orchestrator.presentation import export
from orchestrator.presentation.log.read_log import read_log


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Any:
    out = tmp_path_factory.mktemp("case4")
    main(["run", "guo2015-case4", "--fmus", "native", "--no-page", "--out", str(out)])
    return out / "run.mcap"


def test_csv_has_all_signals_with_units_and_every_bit(log: Any, tmp_path: Path) -> None:
    out = tmp_path / "run.csv"
    assert main(["export", "csv", str(log), "--out", str(out)]) == 0
    run = read_log(log)
    with out.open(newline="") as stream:
        names, units, *rows = csv.reader(stream)
    assert names == ["time", *run.signals]
    assert units == ["s", *(run.variables[name].signal.unit for name in run.signals)]
    table = np.array([[float(cell) for cell in row] for row in rows])
    np.testing.assert_array_equal(table[:, 0], run.t)
    for place, name in enumerate(run.signals, start=1):
        np.testing.assert_array_equal(table[:, place], run.signals[name], err_msg=name)


def test_csv_of_some_signals_with_names_of_states(log: Any, tmp_path: Path) -> None:
    out = tmp_path / "run.csv"
    arguments = ["--signals", "vehicle.pose.*", "--signals", "controller.phase", "--names"]
    assert main(["export", "csv", str(log), "--out", str(out), *arguments]) == 0
    lines = out.read_text().splitlines()
    assert lines[0] == "time,vehicle.pose.x,vehicle.pose.y,vehicle.pose.heading,controller.phase"
    assert lines[2].endswith(",STANDBY")
    assert lines[-1].endswith(",PARKED")


def test_without_out_the_file_stands_beside_the_log(log: Any) -> None:
    assert main(["export", "csv", str(log), "--signals", "vehicle.speed"]) == 0
    assert log.with_suffix(".csv").is_file()


@pytest.mark.parametrize("arguments", [["csv", "nothing.mcap"], ["csv", "LOG", "--signals", "vehicle.sped"]])
def test_bad_input(log: Any, arguments: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", *(str(log) if item == "LOG" else item for item in arguments)]) == 2
    assert capsys.readouterr().err


def test_mf4_has_values_units_comments_and_names_of_states(log: Any, tmp_path: Path) -> None:
    asammdf = pytest.importorskip("asammdf", reason="asammdf is not installed: pip install 'apa-cosim[export]'")
    out = tmp_path / "run.mf4"
    assert main(["export", "mf4", str(log), "--out", str(out)]) == 0
    run = read_log(log)
    with asammdf.MDF(out) as file:
        for name in run.signals:
            raw = file.get(name, raw=True)
            np.testing.assert_array_equal(raw.samples, run.signals[name], err_msg=name)
            np.testing.assert_allclose(raw.timestamps, run.t, rtol=0, atol=1e-12)
        speed = file.get("vehicle.speed")
        assert speed.unit == "m/s"
        assert speed.comment == run.variables["vehicle.speed"].signal.text
        phase = file.get("controller.phase").samples
        assert phase[0] in (b"STANDBY", "STANDBY")
        assert phase[-1] in (b"PARKED", "PARKED")


def test_mf4_refuses_a_name_that_it_would_change(log: Any, tmp_path: Path) -> None:
    assert main(["export", "mf4", str(log), "--out", str(tmp_path / "run.dat")]) == 2


def test_rerun_file_is_valid_and_complete(log: Any, tmp_path: Path) -> None:
    pytest.importorskip("rerun", reason="rerun-sdk is not installed: pip install 'apa-cosim[export]'")
    out = tmp_path / "run.rrd"
    assert main(["export", "rerun", str(log), "--out", str(out)]) == 0
    command = [sys.executable, "-m", "rerun", "rrd"]
    subprocess.run([*command, "verify", str(out)], check=True, capture_output=True)
    listing = subprocess.run([*command, "print", "-v", str(out)], check=True, capture_output=True, text=True).stdout
    for entity in ("/scene/car", "/scene/planned", "/scene/slot", "/scene/driven", "/messages"):
        assert entity in listing
    assert "/signals/vehicle/pose/x" in listing
    assert "/signals/controller/phase" in listing
    assert "blueprint" in listing.lower()


def test_every_format_is_a_module_of_its_own(capsys: pytest.CaptureFixture[str]) -> None:
    names = [item.name for item in pkgutil.iter_modules(export.__path__)]
    found = {name for name in names if hasattr(importlib.import_module(f"{export.__name__}.{name}"), "add_arguments")}
    assert found == FORMATS.keys()
    with pytest.raises(SystemExit):
        main(["export", "--help"])
    text = capsys.readouterr().out
    assert all(name in text for name in FORMATS)


def test_brackets_in_a_pattern_mean_themselves() -> None:
    names = ["vehicle.ultrasonic[1]", "vehicle.ultrasonic[12]", "vehicle.speed"]
    assert matching(names, ["*[1]"]) == ["vehicle.ultrasonic[1]"]
    assert matching(names, ["vehicle.ultra*"]) == names[:2]
    assert matching(names, None) == names
