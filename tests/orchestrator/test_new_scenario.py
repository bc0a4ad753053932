"""``apa new scenario --controller their.fmu``: connections suggested by names, units and descriptions."""

from pathlib import Path

import pytest
import yaml

from modelkit.signal import Signal
from modelkit.variables import Variable, variables
from orchestrator.cli import main
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.simulation.cosim.fmu_instance import Ports
from orchestrator.simulation.system.signal_matching import Signals, match_signals
from tests.orchestrator import c_fmus, foreign_fmus

WRITTEN_ELSEWHERE = [
    ("StrWhlAngReq", "deg", "", "steering_wheel_request", ""),
    ("swa_cmd", "rad", "", "steering_wheel_request", ""),
    ("SteeringWheelAngle", "deg", "desired angle of the steering wheel, clockwise", "steering_wheel_request", "-"),
    ("u1", "rad", "steering-wheel angle request, right positive", "steering_wheel_request", "-"),
    ("u1", "rad", "steering-wheel angle request, counter-clockwise", "steering_wheel_request", ""),
    ("VehSpdReq", "km/h", "", "speed_request", ""),
    ("v_des", "m/s", "", "speed_request", ""),
    ("targetVelocity", "mps", "speed demand", "speed_request", ""),
    ("BrakeForce", "N", "braking force demand", "", ""),
    ("heading_error", "rad", "", "", ""),
    ("Kp", "1", "", "", ""),
]


@pytest.mark.parametrize(("name", "unit", "text", "target", "sign"), WRITTEN_ELSEWHERE)
def test_outputs_of_other_tools_find_the_input_that_they_mean(
    name: str, unit: str, text: str, target: str, sign: str
) -> None:
    ours = Signals("vehicle", Ports(variables(MODELS["vehicle"].inputs)))
    theirs = Signals("controller", Ports([Variable(name, float, Signal(unit, text), 0.0)]))
    sure = [item for item in match_signals(ours, theirs, is_unique=True) if item.is_sure]
    assert [(item.target, item.source) for item in sure] == (
        [(f"vehicle.{target}", f"{sign}controller.{name}")] if target else []
    )


def test_no_unit_of_another_quantity_and_no_other_type_is_suggested() -> None:
    ours = Signals("vehicle", Ports(variables(MODELS["vehicle"].inputs)))
    for variable in (
        Variable("steering_wheel_request", float, Signal("N.m", "torque"), 0.0),
        Variable("SteeringWheelReq", bool, Signal("1", ""), False),
    ):
        found = match_signals(ours, Signals("controller", Ports([variable])), is_unique=True)
        assert "vehicle.steering_wheel_request" not in [item.target for item in found if item.is_sure]


def test_the_system_of_a_controller_with_names_of_its_own_is_written_and_drives(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    c_fmus.two_arcs(tmp_path)
    assert main(["new", "scenario", "--controller", "two_arcs.fmu", "--out", "mine"]) == 0
    said = capsys.readouterr().out
    assert "suggested lines, marked '# ?'" in said
    assert "1 lines are commented out" in said
    text = Path("mine/two_arcs.yaml").read_text()
    system = yaml.safe_load(text)["system"]
    assert system["components"] == {"controller": "../two_arcs.fmu"}
    assert system["connections"] == {
        "controller.Yaw [rad]": "vehicle.odometry.heading",
        "vehicle.steering_wheel_request": "controller.StrWhlAngReq",
        "vehicle.speed_request": "controller.VehSpdReq",
        "vehicle.steering_active": True,
        "vehicle.speed_control_active": True,
    }
    assert system["roles"] == {"request": "controller.StrWhlAngReq", "manoeuvres": "controller.Moves"}
    marked = [line for line in text.splitlines()[5:] if line.startswith("    ")]
    assert len(marked) == 8
    assert all("# ?" in line for line in marked)
    filled = text.replace("# mode", "mode").replace(
        "{0: standby, 1: path tracking, 2: parked}", "{1: standby, 4: parked}"
    )
    Path("mine/two_arcs.yaml").write_text(filled)
    assert main(["fmu", "check", "two_arcs.fmu", "--scenario", "mine/two_arcs.yaml"]) == 0
    assert main(["run", "mine/two_arcs.yaml", "--fmus", "none", "--no-page", "--set", "stop_time=1"]) == 1
    assert "warning" not in capsys.readouterr().err


def test_a_vehicle_and_both_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    c_fmus.two_arcs(tmp_path)
    c_fmus.plant(tmp_path)
    assert main(["new", "scenario", "car", "--fmu", "plant.fmu"]) == 0
    system = yaml.safe_load(Path("car.yaml").read_text())["system"]
    assert system["components"] == {"vehicle": "plant.fmu"}
    assert system["connections"]["vehicle.Demand [m/s]"] == "controller.speed_request"
    assert system["connections"]["controller.odometry.y"] == "-vehicle.South [m]"
    assert system["roles"]["pose"] == "vehicle.East [m], -vehicle.South [m], vehicle.Course [rad]"
    assert main(["new", "scenario", "pair", "--fmu", "plant.fmu", "--controller", "two_arcs.fmu"]) == 0
    assert main(["run", "pair.yaml", "--fmus", "none", "--no-page", "--set", "stop_time=0.1"]) == 1
    assert main(["new", "scenario", "other", "--fmu", "plant.fmu", "--vehicle", "plant.fmu"]) == 2


def test_equal_names_need_no_line_and_names_with_commas_are_quoted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    good = foreign_fmus.controller(tmp_path)
    odd = foreign_fmus.changed(
        good,
        tmp_path / "odd: one.fmu",
        lambda text: text.replace('"steering_wheel_request"', '"Steering wheel, request"'),
    )
    assert main(["new", "scenario", "odd", "--controller", str(odd)]) == 0
    written = yaml.safe_load(Path("odd.yaml").read_text())["system"]
    assert written["connections"]["vehicle.steering_wheel_request"] == 'controller."Steering wheel, request" [rad]'
    assert "vehicle.prompt" not in written["connections"]
    assert main(["fmu", "check", str(odd), "--scenario", "odd.yaml", "--no-load"]) == 1
