"""``apa identify``: logs of all kinds with columns and units of their own, its files, and its messages."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from orchestrator.cli import main
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.studies.identification.car_file import base_car, write_car
from orchestrator.studies.identification.compiled_vehicle import CompiledVehicle
from orchestrator.studies.identification.logs import Columns, read_drive
from orchestrator.studies.identification.parameter import GEOMETRY, ODOMETRY
from orchestrator.studies.identification.signals import Series
from tests.identification.drives import CAR, measurements_only, random_drive, simulated_log
from tests.report.test_page import data_of

DEGREE = np.pi / 180.0
NAMES = {"pose.x": "east", "pose.y": "north", "pose.heading": "yaw", "measured_speed": "v"}
NAMES |= {"steering_wheel_angle": "wheel"}
SCALES = {"pose.x": 1.0, "pose.y": 1.0, "pose.heading": DEGREE, "measured_speed": 1.0 / 3.6}
SCALES |= {"steering_wheel_angle": DEGREE}
UNITS = {"east": "m", "north": "m", "yaw": "deg", "v": "km/h", "wheel": "deg"}
COLUMNS = [word for signal, column in NAMES.items() for word in ("--column", f"{signal}={column}")]


@pytest.fixture(scope="module")
def log() -> dict[str, Series]:
    random = np.random.default_rng(4747)
    angle, speed = random_drive(random)
    return measurements_only(simulated_log(CAR, (angle[:1500], speed[:1500]), random, CompiledVehicle()), CAR)


def columns_of(log: dict[str, Series]) -> dict[str, np.ndarray]:
    return {NAMES[name]: item.values / SCALES[name] for name, item in log.items()}


def write_csv(path: Path, log: dict[str, Series]) -> None:
    columns = columns_of(log)
    lines = ["time," + ",".join(f"{name} [{UNITS[name]}]" for name in columns)]
    rows = zip(log["pose.x"].t.tolist(), *(values.tolist() for values in columns.values()), strict=True)
    lines += [",".join(f"{value:.9g}" for value in row) for row in rows]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_mf4(path: Path, log: dict[str, Series]) -> None:
    asammdf = pytest.importorskip("asammdf")
    with asammdf.MDF() as file:
        t = log["pose.x"].t
        file.append([asammdf.Signal(v, t, name=name, unit=UNITS[name]) for name, v in columns_of(log).items()])
        file.save(path, overwrite=True)


def write_mcap(path: Path, log: dict[str, Series]) -> None:
    from mcap.writer import Writer

    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        schema = writer.register_schema("car", "jsonschema", b"{}")
        channel = writer.register_channel("/car", "json", schema)
        columns = columns_of(log)
        for row, t in enumerate(log["pose.x"].t.tolist()):
            data = json.dumps({name: values[row] for name, values in columns.items()}).encode()
            writer.add_message(channel, round(t * 1e9), data, round(t * 1e9))
        writer.finish()


def test_a_table_in_other_units_gives_a_car_for_scenarios(
    tmp_path: Path, log: dict[str, Series], capsys: pytest.CaptureFixture[str]
) -> None:
    file, out = tmp_path / "drive.csv", tmp_path / "out"
    write_csv(file, log)
    code = main(["identify", str(file), *COLUMNS, "--set", "car.wheelbase=2.62 m", "--out", str(out), "--json"])
    assert code == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed == json.loads((out / "identification.json").read_text(encoding="utf-8"))
    rows = {row["name"]: row for row in printed["parameters"]}
    assert set(rows) == {"car.steering.ratio", "odometry.radius_error", "odometry.steering_offset"}
    for name, row in rows.items():
        assert row["low"] <= CAR[name] <= row["high"], name
    assert printed["signals"]["pose.heading"]["column"] == "yaw"
    data, _ = data_of((out / "report.html").read_text(encoding="utf-8"))
    assert "residual.pose.x" in data["runs"][1]["signals"]
    assert data["verdict"]["text"] == "3 of 3 identified"
    residuals = [plot["signals"] for plot in data["plots"] if plot["title"].startswith("Residual")]
    assert residuals == [["residual.pose.x", "residual.pose.y"], ["residual.pose.heading"]]
    scenario = tmp_path / "scenario.yaml"
    scenario.write_text(f"extends: guo2015-case4\ncar: {out / 'car.yaml'}\n", encoding="utf-8")
    vehicle = load_scenario(str(scenario)).vehicle
    assert vehicle["car.wheelbase"] == 2.62
    assert vehicle["car.steering.ratio"] == rows["car.steering.ratio"]["value"]
    assert vehicle["odometry.ideal"] is False


@pytest.mark.parametrize(
    ("suffix", "write", "prefix"), [(".csv", write_csv, ""), (".mf4", write_mf4, ""), (".mcap", write_mcap, "/car.")]
)
def test_logs_of_all_kinds_are_the_same_drive(
    tmp_path: Path, log: dict[str, Series], suffix: str, write: Callable[[Path, dict[str, Series]], None], prefix: str
) -> None:
    file = tmp_path / f"drive{suffix}"
    write(file, log)
    names = {signal: f"{prefix}{column}" for signal, column in NAMES.items()}
    units = {f"{prefix}{name}": unit for name, unit in UNITS.items()} if suffix == ".mcap" else {}
    drive = read_drive(file, Columns(names, units))
    assert set(drive.followed) == {"steering_wheel_angle", "measured_speed"}
    for name, item in {**drive.followed, **drive.compared}.items():
        values = np.unwrap(log[name].values) if name == "pose.heading" else log[name].values
        np.testing.assert_allclose(item.values, values, atol=1e-6)
        np.testing.assert_allclose(item.t, log[name].t, atol=1e-9)


def test_the_log_of_a_run_needs_no_columns(tmp_path: Path) -> None:
    run = tmp_path / "run"
    assert main(["run", "guo2015-case4", "--out", str(run), "--no-page", "--fmus", "native"]) == 0
    drive = read_drive(run / "run.mcap", Columns())
    assert {"pose.x", "odometry.heading", "speed"} <= drive.compared.keys()
    assert set(drive.followed) == {"measured_speed"}
    assert "steering_wheel_request" in drive.inputs


KNOWN = [word for name in (*GEOMETRY, *ODOMETRY) for word in ("--set", f"{name}={CAR[name]}")]
REFUSED = [
    (["--column", "pose.x=est"], "has no column est; did you mean east"),
    (["--column", "pose.z=east"], "no such signal; did you mean"),
    (["--unit", "yaw=m"], "column yaw [deg] is in deg, unit: says m"),
    (["--fit", "car.wheelbas"], "no such parameter of the vehicle; did you mean car.wheelbase"),
    (["--fit", "steering.lag"], "steering.lag: the log has no steering_wheel_request"),
    (["--set", "car.wheelbase=2 deg"], "expected"),
    (["--set", "car.wheelbase"], "expected NAME=VALUE"),
    (KNOWN, "all usual parameters are known already"),
    (["--from", "100"], "has 0 samples there"),
]


@pytest.mark.parametrize(("words", "text"), REFUSED)
def test_bad_input_is_refused_with_what_would_be_right(
    tmp_path: Path, log: dict[str, Series], capsys: pytest.CaptureFixture[str], words: list[str], text: str
) -> None:
    file = tmp_path / "drive.csv"
    write_csv(file, log)
    assert main(["identify", str(file), *COLUMNS, "--out", str(tmp_path / "out"), *words]) == 2
    assert text in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_files_that_are_no_logs_are_refused(tmp_path: Path) -> None:
    for name, content in (("a.csv", "x"), ("a.mcap", "x"), ("b.csv", "time,q\n0,1\n1,2\n")):
        (tmp_path / name).write_text(content, encoding="utf-8")
        with pytest.raises(BadInput):
            read_drive(tmp_path / name, Columns())
    with pytest.raises(BadInput, match="no such file"):
        read_drive(tmp_path / "none.csv", Columns())


@pytest.mark.parametrize("numbers", [(3,), (1, 2), (2, 1), (1, 3)])
def test_a_car_keeps_the_numbers_of_its_sensors(tmp_path: Path, numbers: tuple[int, ...]) -> None:
    base = base_car("", {f"car.ultrasonic.mounts[{number}].x": f"{number}.5" for number in numbers})
    write_car(tmp_path / "car.yaml", base, {"car.wheelbase": 2.6}, "a test")
    written = base_car(str(tmp_path / "car.yaml"), {}).values
    assert written == {**base.values, "car.wheelbase": 2.6}


@pytest.mark.parametrize("where", [64, 200, 3000])
def test_a_damaged_mdf_file_is_one_line(
    where: int, log: dict[str, Series], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """asammdf prints a traceback of its own, and another one where it forgets what it could not open."""
    path = tmp_path / "drive.mf4"
    write_mf4(path, log)
    path.write_bytes(path.read_bytes()[:where] + bytes(500))
    assert main(["identify", str(path), *COLUMNS]) == 2
    out, err = capfd.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert err.startswith(f"apa: {path}: is no MDF file")
