"""A learned policy as a controller: an FMU of a network with the bits of the environment, and its rank among others."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestrator.cli import main as apa
from orchestrator.simulation.cosim.fmu_files import can_compile

pytest.importorskip("gymnasium", reason="the extra gym is not installed")
pytest.importorskip("onnx", reason="onnx is not installed")
pytest.importorskip("onnxruntime", reason="the extra onnx is not installed")
if not can_compile():
    pytest.skip("needs a C compiler", allow_module_level=True)

import onnx
from onnx import TensorProto, helper, numpy_helper

from apa_cosim.gym.__main__ import main
from apa_cosim.gym.catalogue import scene_source
from apa_cosim.gym.environment import ParkingEnv
from apa_cosim.gym.options import EnvironmentOptions
from apa_cosim.gym.policies import OnnxPolicy
from apa_cosim.gym.ranking import for_system, score
from apa_cosim.runs import load_scenario, run
from fmus.policy_fmu import BadPolicy, build_policy_fmu, count_actions
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput


def network(
    file: Path, actions: int = 2, observations: int = 24, cars: str | int = "cars", outputs: Sequence[str] = ("action",)
) -> Path:
    """Write a policy: one layer whose weights are drawn, turned and in reverse on the whole."""
    rng = np.random.default_rng(3)
    weights = rng.normal(0.0, 0.2, (observations, actions)).astype(np.float32)
    bias = np.array([-0.5, 0.3, 0.0][:actions], dtype=np.float32)
    nodes = [
        helper.make_node("MatMul", ["observation", "weights"], ["product"]),
        helper.make_node("Add", ["product", "bias"], ["sum"]),
        helper.make_node("Tanh", ["sum"], ["action"]),
    ]
    ends = [
        helper.make_tensor_value_info(name, TensorProto.FLOAT, [cars, count])
        for name, count in (("observation", observations), *((name, actions) for name in outputs))
    ]
    constants = [numpy_helper.from_array(weights, "weights"), numpy_helper.from_array(bias, "bias")]
    graph = helper.make_graph(nodes, "policy", ends[:1], ends[1:], constants)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    onnx.save(model, str(file))
    return file


@pytest.fixture(scope="module")
def policy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return network(tmp_path_factory.mktemp("policy") / "policy.onnx")


@pytest.mark.slow
@pytest.mark.parametrize("scenes", ["parallel", "world"])
def test_the_fmu_of_a_policy_has_the_bits_of_the_environment(scenes: Any, policy: Path, tmp_path: Path) -> None:
    env = ParkingEnv(scenes, body="kinematic", stop_time=4.0)
    seen, _ = env.reset(options={"scene_seed": 2})
    act, over = OnnxPolicy(policy), False
    while not over:
        seen, _, ended, cut, _ = env.step(act(seen[None])[0])
        over = ended or cut
    driven = env.episode()
    learned = run(
        driven.scenario, controller=build_policy_fmu("learned", policy, driven.period, tmp_path), fmus="native"
    )
    expected = driven.run()
    names = ("vehicle.pose.x", "vehicle.pose.heading", "vehicle.steering_wheel_angle", "controller.speed_request")
    assert abs(expected["vehicle.speed"]).max() > 0.1
    for name in names:
        assert (learned[name] == expected[name]).all(), name


@pytest.mark.slow
def test_a_new_controller_of_a_policy_runs_and_knows_target_and_slot(policy: Path, tmp_path: Path) -> None:
    assert apa(["new", "controller", "learned", "--from", str(policy), "--out", str(tmp_path)]) == 0
    scenario = load_scenario(tmp_path / "learned" / "scenario.yaml")
    assert scenario.slot is not None
    assert scenario.target is not None
    done = run(scenario.model_copy(update={"stop_time": 1.0}), fmus="native")
    known = done.recording.parameters_of("controller")
    assert known["slot.length"] == scenario.slot.length
    assert (known["target.x"], known["target.y"]) == (scenario.target.x, scenario.target.y)
    assert done.outcome == "not_parked"
    assert done["controller.phase"][-1] == 12


def test_a_policy_of_three_actions_treads_the_pedals(tmp_path: Path) -> None:
    file = network(tmp_path / "pedals.onnx", actions=3)
    assert count_actions(file) == 3
    (ranked,) = score(str(file), "apa/Parallel-v0", [1], EnvironmentOptions("kinematic")).outcomes
    env, policy, over, cut = ParkingEnv(body="kinematic", pedals=True), OnnxPolicy(file), False, False
    seen, _ = env.reset(options={"scene_seed": 1})
    while not (over or cut):
        seen, _, over, cut, info = env.step(policy(seen[None])[0])
    assert not cut
    assert (ranked.reason, ranked.duration) == (info["reason"], info["summary"]["duration"])


def test_a_policy_exported_for_one_car_acts_for_all(policy: Path, tmp_path: Path) -> None:
    observations = np.random.default_rng(2).normal(size=(3, 24)).astype(np.float32)
    alone = OnnxPolicy(network(tmp_path / "alone.onnx", cars=1))
    for row, action in zip(observations, alone(observations), strict=True):
        assert (action == OnnxPolicy(policy)(row[None])[0]).all()
    assert alone(observations).shape == (3, 2)


def test_what_is_no_policy_is_refused(policy: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = tmp_path / "text.onnx"
    text.write_text("no network")
    wrong = [text, network(tmp_path / "narrow.onnx", observations=7), network(tmp_path / "one.onnx", actions=1)]
    wrong.append(network(tmp_path / "actor_critic.onnx", outputs=("action", "sum")))
    for file in wrong:
        with pytest.raises(BadPolicy):
            count_actions(file)
        with pytest.raises(BadInput, match=file.name):
            OnnxPolicy(file)
        assert apa(["new", "controller", "learned", "--from", str(file), "--out", str(tmp_path)]) == 2
    assert "policy of 24 observations" in capsys.readouterr().err
    assert apa(["new", "controller", "learned", "--from", "none.onnx", "--out", str(tmp_path)]) == 2
    assert apa(["new", "vehicle", "learned", "--from", str(policy), "--out", str(tmp_path)]) == 2
    assert apa(["new", "controller", "learned", "--from", str(policy), "--period=0", "--out", str(tmp_path)]) == 2
    assert not (tmp_path / "learned").exists()


@pytest.mark.slow
def test_systems_are_ranked_on_the_same_scenes(policy: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["random", str(policy), "--scenes", "apa/Parallel-v0", "apa/Perpendicular-v0", "--episodes", "3"]
    assert main([*asked, "--body", "kinematic"]) == 0
    lines = capsys.readouterr().out.splitlines()
    rows = [line.split() for line in lines if line.startswith(" apa/")]
    assert lines[1].split() == ["environment", "system", "scenes", "parked", "95", "%", "contacts", "median", "time"]
    assert all(row[-1] == "s" or row[3] == "0" for row in rows), "no time without a car that has parked"
    assert sorted((row[0], row[1], row[2]) for row in rows) == [
        (scenes, system, "3")
        for scenes in ("apa/Parallel-v0", "apa/Perpendicular-v0")
        for system in ("policy.onnx", "random")
    ]


@pytest.mark.parametrize("asked", [["nobody"], ["random", "--scenes", "apa/Street-v0"], ["none.onnx"], ["none.fmu"]])
def test_a_bad_system_or_environment_is_refused(asked: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*asked, "--episodes", "1"]) == 2
    assert asked[-1] in capsys.readouterr().err


def test_a_scene_gives_a_system_of_ours_what_it_has_parameters_for() -> None:
    scene = scene_source("parallel", EnvironmentOptions()).scenario_of(1)
    parking = for_system(scene, "apa")
    assert parking.vehicle == scene.vehicle
    assert parking.controller["target.x"] == scene.controller["target.x"]
    assert any(name.startswith("map[1]") for name in parking.controller)
    assert not any(name.startswith("action.") for name in parking.controller)
    assert isinstance(parking, Scenario)


def test_no_name_of_a_policy_reaches_the_terminal(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """onnxruntime warns of an output of another width, and names it as the file does."""
    file = network(tmp_path / "odd.onnx")
    model = onnx.load(str(file))
    model.graph.node[-1].output[0] = model.graph.output[0].name = "a\x1b[2J"
    model.graph.output[0].type.tensor_type.shape.dim[1].dim_value = 6
    onnx.save(model, str(file))
    assert count_actions(file) == 2
    assert "\x1b" not in capfd.readouterr().err
