"""What is absurd is refused or said: numbers beyond what is plausible, runs that no computer can do."""

from pathlib import Path

import pytest

from orchestrator.cli import main
from orchestrator.inputs.scenario.load_scenario import load_scenario, scenario_names
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.scenario.plausible import implausible, plausible
from orchestrator.inputs.text.errors import BadInput
from orchestrator.session.cost import cost_text


def test_no_shipped_scenario_is_absurd() -> None:
    assert [text for name in scenario_names() for text in implausible(load_scenario(name))] == []


def test_the_plausible_range_is_within_the_hard_one_and_holds_the_default() -> None:
    from modelkit.variables import variables

    for model in MODELS.values():
        for item in variables(model.params):
            low, high = plausible(item)
            assert item.signal.low <= low <= item.start <= high <= item.signal.high, item.name


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("vehicle.start.x=5e5", "vehicle.start.x = 500000 m is beyond"),
        ("target.x=-2e4", "target.x = -20000 m is beyond"),
        ("slot.length=11 km", "slot.length = 11000 m is beyond"),
        ("scene.boxes[3].x=1", "scene.boxes[3] has no length and is therefore not in the scene"),
        ("scene.kerbs[1].x1=1", "scene.kerbs[1] has no height and is therefore not in the scene"),
        ("vehicle.driver.reaction_delay=100 ms", ""),
        ("faults=[{signal: vehicle.speed, kind: noise, sigma: 1e9}]", "faults[1].sigma = '1e9' is beyond"),
        ("faults=[{signal: vehicle.pose.x, kind: override, value: nan}]", ""),
    ],
)
def test_what_is_hardly_meant_is_said(setting: str, said: str) -> None:
    try:
        found = implausible(load_scenario("guo2015-case4", [setting]))
    except BadInput:
        found = []
    assert said in "".join(found)
    assert bool(found) == bool(said)


@pytest.mark.parametrize(
    "setting",
    [
        "vehicle.chassis.mass=1e300",
        "vehicle.start.x=1e30",
        "step=inf",
        "stop_time=1e-9",
        "slot.x=1e7",
        "decimation.vehicle=1e7",
    ],
)
def test_what_cannot_be_is_refused(setting: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "guo2015-case4", "--set", setting, "--fmus", "none", "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_a_run_of_terabytes_is_refused_and_a_long_one_told() -> None:
    assert cost_text(6001, 250) == ""
    assert "up to 3 GB of log and 10 GB of scratch space" in cost_text(5_000_000, 250)
    with pytest.raises(BadInput, match="TB of log"):
        cost_text(10**12, 250)


def test_a_study_of_too_many_runs_is_refused_before_any_number_is_drawn(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = tmp_path / "large.yaml"
    study.write_text("scenario: guo2015-case4\nruns: {monte_carlo: {n: 90000000, vehicle.start.x: {uniform: [0, 1]},")
    with study.open("a") as file:
        file.write(" vehicle.start.y: {uniform: [0, 1]}, a: {uniform: [0, 1]}, b: {uniform: [0, 1]},")
        file.write(" c: {uniform: [0, 1]}, d: {uniform: [0, 1]}}}\n")
    assert main(["sweep", str(study), "--out", str(tmp_path / "out")]) == 2
    assert "expected at most" in capsys.readouterr().err
    study.write_text("scenario: guo2015-case4\nruns: {grid: {stop_time: [0.001, 1], step: [0.01]}}\n")
    assert main(["sweep", str(study), "--out", str(tmp_path / "out")]) == 2
    assert "stop_time under its step" in capsys.readouterr().err
    study.write_text("scenario: guo2015-case4\nruns: {grid: {vehicle.start.x: [0, 1]}}\nmap: {x: nothing, y: row}\n")
    assert main(["sweep", str(study), "--out", str(tmp_path / "out")]) == 2
    assert "nothing is no column of the table" in capsys.readouterr().err
