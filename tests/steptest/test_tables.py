"""Tables of inputs as other tools write them: read in their units, or refused with what would be right."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from modelkit.signal import Signal
from modelkit.variables import Variable, variables
from orchestrator.cli import main
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.log.read_log import read_log
from orchestrator.session.session import run_scenario
from orchestrator.testing.steptest.drive import drive
from orchestrator.testing.steptest.step_test import load_step_test
from orchestrator.testing.steptest.stimuli import StimulatedInput, stimulus
from vehicle_fmu.interface import VehicleInput

T = np.array([0.0, 1.0, 2.0, 3.0])
KMH = [0.0, 1.0, 2.0, 2.0]


def read(folder: Path, text: str | bytes, column: str, si: str = "m/s", **more: Any) -> list[float]:
    """Return the values of a column at 0, 1, 2 and 3 s."""
    (folder / "in.csv").write_bytes(text if isinstance(text, bytes) else text.encode())
    place = StimulatedInput(Variable("speed", float, Signal(si, "speed"), 0.0), folder / "test.yaml", "inputs.speed")
    return stimulus({"csv": {"file": "in.csv", "column": column, **more}}, place, T).tolist()


READ = [
    ("time,v [km/h]\n0,0\n1,3.6\n2,7.2\n", "v [km/h]"),
    ("time,v [km/h]\n0,0\n1,3.6\n2,7.2\n", "v"),
    ("time,v (km/h)\n0,0\n1,3.6\n2,7.2\n", "v"),
    ("time,v(kph)\n0,0\n1,3.6\n2,7.2\n", "v"),
    ("time,v {km/h}\n0,0\n1,3.6\n2,7.2\n", "v"),
    ("time,v <km/h>\n0,0\n1,3.6\n2,7.2\n", "v"),
    ("time,v / km/h\n0,0\n1,3.6\n2,7.2\n", "v"),
    ("time,v in km/h\n0,0\n1,3.6\n2,7.2\n", "v in km/h"),
    ("time,v\ns,km/h\n0,0\n1,3.6\n2,7.2\n", "v"),
    ("time,v\n[ms],[km/h]\n0,0\n1000,3.6\n2000,7.2\n", "v"),
    ("time [ms],v [m/s]\n0,0\n1000,1\n2000,2\n", "v"),
    ("time_ms,v\n0,0\n1000,1\n2000,2\n", "v"),
    ('"time","v"\n0,0\n1,1\n2,2\n', "v"),
    ('"time", "v"\n"0", "0"\n"1", "1"\n"2", "2"\n', "v"),
    ("time;v\n0;0\n1;1\n2;2\n", "v"),
    ("time;v [km/h]\n0,0;0,0\n1,0;3,6\n2,0;7,2\n", "v"),
    ("time\tv\n0\t0\n1\t1\n2\t2\n", "v"),
    ("v,time\n0,0\n1,1\n2,2\n", "v"),
    ("time,v,\n0,0,\n1,1,\n2,2,\n", "v"),
    ("\ufefftime,v\r\n0,0\r\n1,1\r\n2,2\r\n", "v"),
    ('time,"v, ahead [km/h]"\n0,0\n1,3.6\n2,7.2\n', "v, ahead"),
    ("time,v [mph]\n0,0\n1,2.2369362920544025\n2,4.473872584108805\n", "v"),
    ("time,v\n0,0\n1 s,3.6 km/h\n2 s,7.2 km/h\n", "v"),
    ("time;v\n0;0\n1;3,6 km/h\n2;7,2 km/h\n", "v"),
]


@pytest.mark.parametrize(("text", "column"), READ)
def test_a_table_is_read_in_its_units(tmp_path: Path, text: str, column: str) -> None:
    assert read(tmp_path, text, column) == pytest.approx(KMH, abs=1e-12)


def test_utf16_of_a_spreadsheet_is_read(tmp_path: Path) -> None:
    assert read(tmp_path, "time\tv [°]\n0\t0\n1\t180\n".encode("utf-16"), "v", "rad")[1] == math.pi


def test_a_unit_can_be_told_beside_the_table(tmp_path: Path) -> None:
    table = "time,angle_deg\n0,0\n1,180\n"
    assert read(tmp_path, table, "angle_deg", "rad", unit="deg")[1] == math.pi
    assert read(tmp_path, table, "angle_deg", "rad", unit="rad")[1] == 180.0


REFUSED: list[tuple[str | bytes, str, str]] = [
    ("time,v [furlong]\n0,0\n", "v", "in.csv: column v [furlong] is in furlong; expected m/s or km/h"),
    ("time,v [deg]\n0,0\n", "v", "column v [deg] is in deg; expected m/s or km/h"),
    ("time,v [-]\n0,0\n", "v", "is in 1; expected m/s"),
    ("time,v (filtered)\n0,0\n", "v", "is in filtered; expected m/s"),
    ("time,v [km/h]\ns,m/s\n0,0\n", "v", "line 2: v [km/h] is in m/s, and in km/h by its name"),
    ("time,v [km/h]\n0,3.6 m/s\n", "v", "line 2: v [km/h]: '3.6 m/s' is in 'm/s'"),
    ("time,v_kmh\n0,0\n", "v_kmh", "may be in km/h by its name; write unit: km/h, or unit: m/s"),
    ("time,vDeg\n0,0\n", "vDeg", "may be in deg by its name"),
    ("distance [m],v\n0,0\n", "v", "column distance [m] is in m; expected s"),
    ("time,v,v\n0,0,1\n", "v", "has 2 columns v"),
    ("time,v [km/h],v [m/s]\n0,0,1\n", "v", "has 2 columns v"),
    ("a,t,time,v\n0,0,0,1\n", "v", "has 2 columns of times: t, time"),
    ("time,time,v\n0,0,1\n", "v", "has 2 columns of times: time, time"),
    ("time [ms],time [s],v\n0,0,1\n", "v", "has 2 columns of times: time [ms], time [s]"),
    ("v\n0\n1\n", "v", "has no column of times: the first one, v, would be its own time"),
    ("time,v {furlong}\n0,0\n", "v", "column v {furlong} is in furlong"),
    ("time,v/km/h\n0,0\n", "v/km/h", "may be in km/h by its name"),
    ("time,v|kph\n0,0\n", "v|kph", "may be in km/h by its name"),
    ("time,v:rpm\n0,0\n", "v:rpm", "may be in rpm by its name"),
    ("time,v_percent\n0,0\n", "v_percent", "may be in "),
    ("time,V\n0,0\n", "v", "has no column v; did you mean V?"),
    ("time,v\n0,0\n1\n", "v", "line 3 has 1 values, the header 2 names"),
    ("time,v\n0,0\n1,1,5\n", "v", "line 3 has 3 values"),
    ("time,v\n0,0\n1,\n", "v", "line 3: v: is empty"),
    ("time,v\n0,0\n1,nan\n", "v", "line 3: v: "),
    ("time,v\n0,0\nnan,1\n", "v", "line 3: time: "),
    ("time,v\n0,0\n1,n/a\n", "v", "line 3: v: speed: 'n/a' is not a number"),
    ('time,v\n0,0\n1,"1,5"\n', "v", "line 3: v: speed: '1,5' is not a number"),
    ("time;v\n0;1,234\n1;2,345\n", "v", "1,234 has a decimal comma, or one between thousands: write 1.234"),
    ("time;v\n0,5;1.234,5\n", "v", "line 2: v: speed: '1.234,5' is not a number"),
    ("time,v\n1,0\n0,1\n", "v", "line 3: its time is before that of the row above"),
    ("time,v\n1700000000,0\n1700000001,1\n", "v", "lie outside the test, 0 to 3 s"),
    ("time,v\n", "v", "expected a row of names and rows of numbers"),
    ("time,v\ns,m/s\n", "v", "has names, but no row of numbers"),
    ("time,v\ns,m/s\nfirst,second\n0,1\n", "v", "line 3: time: 'first' is not a number"),
    ('time,v\n0,"1\n', "v", "unexpected end of data"),
    (b"time,v\xb0\n0,0\n", "v", "is not text in UTF-8"),
    (b"time,v\n0,\0\n", "v", "zero bytes"),
    ("", "v", "expected a row of names"),
]


@pytest.mark.parametrize(("text", "column", "said"), REFUSED)
def test_what_cannot_be_read_for_sure_is_refused(tmp_path: Path, text: str | bytes, column: str, said: str) -> None:
    with pytest.raises(BadInput) as error:
        read(tmp_path, text, column)
    assert said in str(error.value)
    assert str(error.value).startswith(f"{tmp_path / 'test.yaml'}: inputs.speed: ")
    assert "\n" not in str(error.value)


def test_two_rows_at_one_time_are_a_step(tmp_path: Path) -> None:
    assert read(tmp_path, "time,v\n0,1\n1,1\n1,5\n3,5\n", "v") == [1.0, 5.0, 5.0, 5.0]


def test_times_that_were_added_up_hold_at_their_step(tmp_path: Path) -> None:
    (tmp_path / "in.csv").write_text("time,on\n0,0\n0.30000000000000004,1\n")
    place = StimulatedInput(Variable("on", bool, Signal("1", "on"), False), tmp_path / "test.yaml", "inputs.on")
    t = np.arange(5) * 100_000_000 / 1e9
    assert stimulus({"csv": {"file": "in.csv", "column": "on"}}, place, t).tolist() == [0, 0, 0, 1, 1]


def test_an_exported_run_read_again_gives_the_same_bits(tmp_path: Path) -> None:
    scenario = load_scenario("guo2015-case4", ["stop_time=7"])
    run_scenario(scenario, log=tmp_path / "run.mcap")
    assert main(["export", "csv", str(tmp_path / "run.mcap"), "--out", str(tmp_path / "run.csv")]) == 0
    inputs = [item.name for item in variables(VehicleInput)]
    test = {
        "model": "vehicle",
        "stop_time": "7 s",
        "parameters": dict(scenario.vehicle),
        "inputs": {name: {"csv": {"file": "run.csv", "column": f"vehicle.{name}"}} for name in inputs},
        "expect": [{"id": "a", "signal": "speed", "always": {"max": 9}}],
    }
    (tmp_path / "again.yaml").write_text(yaml.safe_dump(test))
    before, after = read_log(tmp_path / "run.mcap"), drive(load_step_test(tmp_path / "again.yaml"), "none")
    moved = [name for name, values in before.signals.items() if name.startswith("vehicle.") and np.ptp(values) > 0.0]
    assert len(moved) > 20
    for name in moved:
        assert before.signals[name].tobytes() == after.signals[name].tobytes(), name
