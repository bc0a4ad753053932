"""Any system: instances of others with names, units and frames of their own, connected by a few lines and judged."""

import json
import math
import re
import shutil
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from mcap.reader import make_reader

from orchestrator.cli import main
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.scenario.wiring.system_text import Origin, PoseFrame, SystemText, Term, terms
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.log.read_log import read_log
from orchestrator.simulation.cosim.algorithm import CoSimulation
from orchestrator.simulation.cosim.fmu_instance import FmuInstance, Scale
from orchestrator.simulation.cosim.model_instance import ModelInstance
from orchestrator.simulation.system.assemble import ElaboratedSystem, elaborate
from orchestrator.simulation.system.conversions import into, out_of
from orchestrator.simulation.system.diagnostics import loops, remarks
from orchestrator.simulation.system.units import UnfitUnitsError, conversion
from tests.orchestrator import bad_fmus, c_fmus
from tests.orchestrator.toy_models import BRAIN, PLANT

MOST_LINES = 20


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with third-party FMUs and the scenarios that connect them."""
    folder = tmp_path_factory.mktemp("desk")
    for make in (c_fmus.two_arcs, c_fmus.sensor, c_fmus.plant):
        make(folder)
    for path in c_fmus.THEIR.glob("*.yaml"):
        shutil.copy(path, folder)
    return folder


@pytest.fixture(scope="module", params=["two_arcs", "all_theirs"])
def driven(request: pytest.FixtureRequest, desk: Path) -> tuple[str, Path]:
    """A scenario of the desk, and the folder of its run."""
    folder = desk / f"{request.param}-run"
    assert main(["run", str(desk / f"{request.param}.yaml"), "--out", str(folder), "--quiet"]) == 0
    return request.param, folder


def test_systems_of_others_park_by_a_few_lines(driven: tuple[str, Path], desk: Path) -> None:
    """A controller in C with deg and km/h; with it a PythonFMU as vehicle and an FMI 3.0 sensor, each in its frame."""
    name, folder = driven
    assert len((desk / f"{name}.yaml").read_text().splitlines()) <= MOST_LINES
    summary = json.loads((folder / "summary.json").read_text())
    assert (summary["outcome"], summary["manoeuvres"]) == ("parked", 1)
    assert abs(summary["final"]["lateral_error"]) < 0.03
    assert [event["to"] for event in summary["events"]] == ["PATH_TRACKING", "STRAIGHTEN", "PARKED"]
    used = {item["name"]: item for item in summary["fmus"]}
    assert used["controller"]["kind"] == "foreign"
    assert Path(used["controller"]["path"]).name == "two_arcs.fmu"
    assert (folder / "report.html").stat().st_size > 10_000


@pytest.mark.parametrize("driven", ["all_theirs"], indirect=True)
def test_the_log_has_their_names_and_the_roles(driven: tuple[str, Path]) -> None:
    file = driven[1] / "run.mcap"
    log = read_log(file)
    x, east, course = (log.signals[name] for name in ("vehicle.pose.x", "plant.East", "plant.Course"))
    assert x == pytest.approx(east / 100.0 - 2.405 * np.cos(np.radians(course)), abs=1e-12)
    assert log.signals["vehicle.pose.heading"] == pytest.approx([-math.radians(value) for value in course])
    assert log.signals["gps.pose[1]"][-1] == pytest.approx(x[-1] + 0.05, abs=1e-3)
    assert log.states("gps.quality") == {1: "NONE", 2: "FAIR", 3: "GOOD"}
    assert log.parameters["gps.bias"] == 0.05
    assert log.states("controller.phase")[9] == "PARKED"
    with file.open("rb") as stream:
        summary = make_reader(stream).get_summary()
        assert summary is not None
        topics = {channel.topic for channel in summary.channels.values()}
    assert {"/tf", "/scene", "/trail", "/plant", "/gps", "/gps/parameters"} <= topics


def test_parameters_and_faults_of_a_third_instance(
    desk: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    system = ["run", str(desk / "all_theirs.yaml"), "--out", str(tmp_path), "--no-page", "--json"]
    short = [*system, "--set", "stop_time=4", "--force"]
    assert main([*short, "--set", "gps.bias=20 cm"]) == 1
    assert read_log(tmp_path / "run.mcap").parameters["gps.bias"] == 0.2
    assert main([*system, "--set", "gps.bais=20 cm"]) == 2
    assert "gps.bais: unknown; did you mean gps.bias?" in capsys.readouterr().err
    fault = "[{signal: gps.pose, kind: stuck_at_last, start: 3}]"
    assert main([*short, "--set", f"faults={fault}"]) == 1
    signals = read_log(tmp_path / "run.mcap").signals
    assert signals["controller.Yaw"][-1] == pytest.approx(math.degrees(-signals["gps.pose[3]"][300]), abs=1e-9)
    assert signals["gps.pose[3]"][-1] != signals["gps.pose[3]"][300]


def test_a_suite_runs_systems_beside_shipped_scenarios(desk: Path, tmp_path: Path) -> None:
    names = [str(desk / "two_arcs.yaml"), "guo2015-case3"]
    assert main(["test", *names, "--out", str(tmp_path), "--quiet"]) == 0
    assert json.loads((tmp_path / "their-case4" / "summary.json").read_text())["outcome"] == "parked"


def test_names_that_no_other_tool_can_spell(tmp_path: Path) -> None:
    names = ["der(x)", "'a name, 1'", "a", "a.b", "c[2]", "Motor-1.speed", "größe", "1st", "m[1,2]", "d", "D.e", "f[1]"]
    outputs = "".join(
        f'<ScalarVariable name="{name}" valueReference="{place}" causality="output"><Real/></ScalarVariable>'
        for place, name in enumerate(names, start=2)
    )
    text = bad_fmus.DESCRIPTION.format(guid="good").replace("</ModelVariables>", f"{outputs}</ModelVariables>")
    c_fmus.c_fmu(tmp_path / "odd.fmu", c_fmus.THEIR / "bad.c", text, "bad")
    scenario = {"extends": "guo2015-case4", "stop_time": 0.1, "requirements": []}
    system = {
        "components": {"odd": "odd.fmu"},
        "connections": {"odd.u": "vehicle.speed", "vehicle.advised_speed": "odd.der(x)"},
    }
    (tmp_path / "odd.yaml").write_text(yaml.safe_dump({**scenario, "system": system}))
    main(["run", str(tmp_path / "odd.yaml"), "--fmus", "none", "--out", str(tmp_path), "--quiet"])
    assert {name for name in read_log(tmp_path / "run.mcap").signals if name.startswith("odd.")} == {
        f"odd.{name}" for name in [*names, "u", "y"]
    }
    assert (tmp_path / "report.html").is_file()


def test_windows_in_phases_of_ours_are_not_judged_where_the_chart_has_none(desk: Path, tmp_path: Path) -> None:
    text = (desk / "two_arcs.yaml").read_text()
    mode = "{from: controller.State, states: {idle: 1, first: 2, second: 3, there: 4}}"
    text = re.sub(r"mode: .*", f"mode: {mode}", text) + "stop_condition: {succeeded: [there]}\n"
    limit = "{id: slow, signal: vehicle.speed, max_abs: 1, window: {phase: TO_Q1}, source: us, required: false}"
    path = desk / "own_states.yaml"
    path.write_text(f"{text}requirements: [{limit}]\n")
    assert main(["run", str(path), "--out", str(tmp_path), "--quiet", "--no-page"]) == 0
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert [event["to"] for event in summary["events"]] == ["FIRST", "SECOND", "THERE"]
    assert summary["checks"][0]["note"] == "not measured"


def toys(text: str) -> tuple[Scenario, list[FmuInstance]]:
    instances: list[FmuInstance] = [ModelInstance("plant", PLANT, {}), ModelInstance("brain", BRAIN, {})]
    written = {"components": {"plant": "p.fmu", "brain": "b.fmu"}, **yaml.safe_load(text)}
    return Scenario(name="toys", system=SystemText(**written)), instances


def assembled(text: str) -> ElaboratedSystem:
    return elaborate(*toys(text))


def exchanged(text: str, **outputs: float) -> dict[str, float]:
    """Return the inputs of the plant after one exchange with the given outputs of the brain."""
    system = assembled(text)
    plant, brain = system.instances[:2]
    master = CoSimulation(system.instances, 10, 20, None, system.connections)
    master.initialize()
    fetch = brain.fetch_outputs

    def fetched() -> None:
        fetch()
        for name, value in outputs.items():
            brain.outputs.values[brain.outputs.index[name]] = value

    brain.fetch_outputs = fetched  # type: ignore[method-assign]
    master.run()
    return dict(zip(plant.inputs.names, plant.inputs.values.tolist(), strict=True))


def test_gains_offsets_maps_constants_and_types() -> None:
    text = """
connections:
  plant.command: {from: -brain.command, factor: 2, offset: 3}
  plant.mode: {from: brain.right, map: {7: busy, 8: done}, else: idle}
  plant.active: brain.right
  plant.right: 5
"""
    found = exchanged(text, command=4.0, right=7.0)
    assert found == {"command": -5.0, "mode": 1.0, "active": 1.0, "right": 5.0}
    assert exchanged(text, command=4.0, right=0.0)["active"] == 0.0
    assert exchanged(text, command=4.0, right=3.0)["mode"] == 0.0


def test_a_unit_is_written_where_the_fmu_says_none_or_one() -> None:
    with pytest.raises(BadInput, match="is in m/s, as its FMU says, not in km/h"):
        assembled("connections: {plant.command: 'brain.command [km/h]'}")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("connections: {plant.comand: brain.command}", "no input 'comand'; did you mean plant.command?"),
        ("connections: {plant.command: brain.comand}", "no output 'comand'; did you mean brain.command?"),
        ("connections: {plnt.command: brain.command}", "no instance is called 'plnt'; did you mean plant?"),
        ("connections: {plant.command: bran.command}", "'bran.command' is not a number"),
        ("connections: {plant.command: 5 deg}", "'5 deg' is in 'deg', expected a number in m/s"),
        ("connections: {'plant.command, plant.right': brain.command}", "2 inputs, but 1 signals"),
        (
            "connections: {plant.command: brain.command, 'plant.command, plant.right': 'brain.command, brain.right'}",
            "plant.command is fed twice",
        ),
        ("connections: {plant.mode: {from: brain.mode, map: {bussy: done}}}", "'bussy' is no state of mode"),
        ("connections: {plant.mode: {from: brain.mode, map: {busy: dune}}}", "'dune' is none of idle, busy, done"),
        ("connections: {plant.command: {from: brain.command, into: there}}", "'there' is none of the frames"),
        ("roles: {sped: plant.moving}", "no such role; did you mean speed?"),
        ("roles: {speed: plant.left}", "plant.left is in 1, vehicle.speed in m/s"),
        ("roles: {speed: 3}", "a role is a signal"),
    ],
)
def test_what_does_not_fit_is_said_with_the_names_that_come_closest(text: str, said: str) -> None:
    with pytest.raises((BadInput, ValueError)) as caught:
        assembled(text)
    assert said in str(caught.value)


@pytest.mark.parametrize(
    "system",
    [
        5,
        {"components": 5},
        {"components": {"a b": "x.fmu"}},
        {"components": {"controller": None, "vehicle": "none"}},
        {"components": {"sensor": "nothing.fmu"}},
        {"connections": 5},
        {"connections": {"vehicle.prompt": None}},
        {"connections": {"vehicle.prompt": {"from": "controller.prompt", "map": {"zz": 1}}}},
        {"frames": {"a": {"y": "up"}}},
        {"ssp": "nothing.ssp"},
        {"roles": {"speed": "vehicle.speed"}},
    ],
)
def test_a_system_that_has_no_meaning_is_bad_input(
    system: object, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(yaml.safe_dump({"extends": "guo2015-case4", "system": system}))
    assert main(["run", str(path), "--fmus", "none", "--out", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_a_group_is_connected_as_one_and_what_is_left_by_name() -> None:
    system = assembled("connections: {brain.pose: plant.pose}")
    fed = {
        (system.instances[instance].name, system.instances[instance].inputs.names[place])
        for instance, place in system.fed
    }
    assert fed >= {("brain", "pose.x"), ("brain", "pose.heading"), ("plant", "command"), ("plant", "active")}


def test_a_loop_of_direct_feedthrough_is_said() -> None:
    scenario, instances = toys("{}")
    instances[0].outputs.direct = {"left": ["right"]}
    assert loops(elaborate(scenario, instances)) == []
    instances[1].outputs.direct = {"right": ["left"]}
    (said,) = loops(elaborate(scenario, instances))
    assert said.startswith("algebraic loop: ")
    assert "plant.left -> brain.right -> plant.left" in said + said.partition(": ")[2]


def test_what_a_verdict_needs_and_nobody_plays_is_said() -> None:
    scenario, instances = toys("roles: {pose: plant.pose}")
    said = " ".join(remarks(elaborate(scenario, instances), scenario.stop_condition))
    assert "has no output speed: standstill does not end the run" in said
    assert "no instance is called controller, nor plays its roles" in said
    assert "pose.x" not in said


@given(
    pose=st.tuples(*[st.floats(-50, 50)] * 2, st.floats(-3, 3)),
    origin=st.tuples(*[st.floats(-50, 50)] * 2, st.floats(-3, 3)),
    side=st.sampled_from(["left", "right"]),
    ahead=st.floats(-3, 3),
)
def test_a_frame_there_and_back(
    pose: tuple[float, float, float], origin: tuple[float, float, float], side: Literal["left", "right"], ahead: float
) -> None:
    frame = PoseFrame(origin=Origin(x=origin[0], y=origin[1], heading=origin[2]), y=side, ahead=ahead)
    assert out_of(frame, *into(frame, *pose)) == pytest.approx(pose, abs=1e-9)


def test_a_frame_by_hand() -> None:
    """Origin 10 m ahead of ours, x to our left, y to its right (our right is backwards), front axle 2 m ahead."""
    frame = PoseFrame(origin=Origin(x=10.0, heading=math.pi / 2), y="right", ahead=2.0)
    assert into(frame, 3.0, 4.0, 0.0) == pytest.approx((4.0, -5.0, math.pi / 2))


def test_units_are_those_of_the_fmu_then_those_everybody_knows() -> None:
    mine = {"turn": Scale(2.0 * math.pi, 0.0, (0,) * 7 + (1,)), "degC": Scale(1.0, 273.15, (0, 0, 0, 0, 1, 0, 0, 0))}
    assert conversion("turn", "rad", mine, {}) == (pytest.approx(2.0 * math.pi), 0.0)
    assert conversion("degC", "K", mine, {}) == (1.0, 273.15)
    assert conversion("km/h", "m/s", {}, {})[0] == pytest.approx(1 / 3.6)
    assert conversion("cm", "m", {}, {})[0] == pytest.approx(0.01)
    assert conversion("apples", "apples", {}, {}) == (1.0, 0.0)
    for one, other in (("m", "rad"), ("apples", "m"), ("m", "1")):
        with pytest.raises(UnfitUnitsError):
            conversion(one, other, {}, {})


def test_terms() -> None:
    assert terms("-a.b [deg], c.d[1].e") == [Term("a.b", "deg", True), Term("c.d[1].e", None, False)]
    assert terms("a.m[2,1] [km/h]") == [Term("a.m[2,1]", "km/h", False)]
    with pytest.raises(BadInput, match="is no signal"):
        terms("a.b, ")
