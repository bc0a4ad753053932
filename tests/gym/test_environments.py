"""The Gymnasium environments: their contract, their bits, and the verdict of their episodes."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.fmu_files import can_compile

pytest.importorskip("gymnasium", reason="the extra gym is not installed")
if not can_compile():
    pytest.skip("needs a C compiler", allow_module_level=True)

import gymnasium
from gymnasium.error import ResetNeeded
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

import apa_cosim
from apa_cosim.gym import ParkingEnv, ParkingVectorEnv
from tests.benchmark.parkbench_scene import scene, write

CASE = "-9, 4, 0, 0, 0, 0, 2, 4, 3, -12,-8, 4,-8, 4,-3, -12,-3, 6,-4, 9,-4, 8,4"
"""A case of TPCAP: a wall beside the target, a triangle ahead."""
SLOT = """
name: near
target: {{x: 0, y: 0}}
slot: {{x: 1.3, y: 0, length: 6, width: 2.4}}
vehicle: {{start: {{x: {x}, y: 0}}, scene: {{boxes: [{{x: 8, y: 0, length: 2, width: 2}}]}}}}
"""
POSE = ("x", "y", "heading")


@pytest.fixture
def case(tmp_path: Path) -> Path:
    file = tmp_path / "case.csv"
    file.write_text(CASE)
    return file


@pytest.fixture
def parkbench_scene(tmp_path: Path) -> Path:
    return write(tmp_path / "scene.json", scene())


def actions(count: int, cars: int = 1, seed: int = 5) -> Iterator[Any]:
    """Yield actions that drive the cars somewhere: mostly in reverse and turned."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        yield np.clip(rng.normal((-0.3, 0.3), 0.5, (cars, 2)), -1.0, 1.0).astype(np.float32)


def driven(env: ParkingEnv, count: int, **reset: Any) -> list[Any]:
    """Return everything that an environment tells of an episode of at most ``count`` periods."""
    found: list[Any] = [env.reset(**reset)]
    for action in actions(count):
        found.append(env.step(action[0]))
        if found[-1][2] or found[-1][3]:
            break
    return found


def is_same(one: Any, other: Any) -> bool:
    """Return whether two results are equal to the bit, arrays and NaN included."""
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and one.tobytes() == other.tobytes()
    if isinstance(one, (tuple, list)):
        return len(one) == len(other) and all(map(is_same, one, other))
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(is_same(one[key], other[key]) for key in one)
    return bool(one == other or (one != one and other != other))


@pytest.mark.parametrize(
    "name",
    [
        *("apa/Parallel-v0", "apa/TPCAP-v0"),
        *(
            pytest.param(f"apa/{name}-v0", marks=pytest.mark.release)
            for name in ("Perpendicular", "World", "ParkBench")
        ),
    ],
)
def test_the_checker_of_gymnasium_finds_nothing(name: str, case: Path, parkbench_scene: Path) -> None:
    files = {"apa/TPCAP-v0": [case.parent], "apa/ParkBench-v0": [parkbench_scene]}
    given: dict[str, Any] = {"files": files[name]} if name in files else {}
    env = gymnasium.make(name, render_mode="rgb_array", body="kinematic", **given)
    check_env(env.unwrapped)
    env.close()


@pytest.mark.parametrize("body", ["kinematic", "double_track"])
@pytest.mark.parametrize("scenes", ["parallel", "world"])
def test_an_episode_repeats_to_the_bit(scenes: Any, body: Any) -> None:
    first, second = (driven(ParkingEnv(scenes, body=body), 60, seed=3) for _ in range(2))
    assert is_same(first, second)
    scene = first[0][1]["scene_seed"]
    again = driven(ParkingEnv(scenes, body=body), 60, options={"scene_seed": scene})
    assert is_same(first, again)
    assert not is_same(first, driven(ParkingEnv(scenes, body=body), 60, seed=4))


def test_pedals_move_the_car_in_both_directions() -> None:
    env = ParkingEnv("parallel", pedals=True)
    for accelerator in (0.3, -0.3):
        env.reset(seed=1)
        for _ in range(10):
            seen, *_ = env.step(np.array([accelerator, 0.0, 0.0], dtype=np.float32))
        assert accelerator * float(seen[4]) > 0.01
        for _ in range(15):
            seen, *_ = env.step(np.array([0.0, 0.0, 1.0], dtype=np.float32))
        assert abs(float(seen[4])) < 0.01


def test_the_observation_is_the_pose_in_the_frame_of_the_target() -> None:
    env = ParkingEnv("perpendicular", body="kinematic")
    seen, _ = env.reset(seed=8)
    scenario = env.episode().scenario
    assert scenario.target is not None
    x, y, heading = scenario.target.pose
    dx, dy = (scenario.vehicle[f"start.{axis}"] - at for axis, at in (("x", x), ("y", y)))
    along = np.cos(heading) * dx + np.sin(heading) * dy
    across = np.cos(heading) * dy - np.sin(heading) * dx
    turn = scenario.vehicle["start.heading"] - heading
    assert seen[:4] == pytest.approx([along / 10, across / 10, np.cos(turn), np.sin(turn)], abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("scenes", ["parallel", "world"])
def test_an_episode_is_recorded_with_the_same_bits_and_verdict(scenes: Any, tmp_path: Path) -> None:
    env = ParkingEnv(scenes, stop_time=4.0)
    *_, last = driven(env, 100, seed=6)
    run = env.episode().run(tmp_path / "run.mcap")
    assert [run[f"vehicle.pose.{axis}"][-1] for axis in POSE] == env.episodes.poses[0, :3].tolist()
    seen = np.array([run[f"controller.observation[{number + 1}]"][-1] for number in range(24)])
    assert is_same(seen.astype(np.float32), last[0])
    assert (run.outcome, run.summary.duration) == (last[4]["outcome"], last[4]["summary"]["duration"])
    assert run.summary.final.lateral_error == last[4]["summary"]["final.lateral_error"]
    logged = apa_cosim.read_log(tmp_path / "run.mcap")
    assert (logged.outcome, logged.reason) == (run.outcome, run.reason)
    assert (logged["controller.action[1]"] == run["controller.action[1]"]).all()
    assert run.save(tmp_path / "page").is_file()


@pytest.mark.slow
def test_a_recorded_episode_has_the_bits_of_the_python_models() -> None:
    from apa_cosim.gym import recorded
    from orchestrator.simulation.cosim.model_instance import ModelInstance

    env = ParkingEnv("world", body="kinematic", stop_time=1.0)
    driven(env, 10, seed=2)
    compiled = env.episode().run()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(recorded, "CompiledInstance", ModelInstance)
        python = env.episode().run()
    assert all((compiled[name] == python[name]).all() or np.isnan(python[name]).any() for name in python.signals)


def test_a_car_that_stands_at_its_target_is_parked(tmp_path: Path) -> None:
    file = tmp_path / "near.yaml"
    file.write_text(SLOT.format(x=0.05))
    env = ParkingEnv("tpcap", files=[file])
    env.reset(seed=0)
    total, over = 0.0, False
    info: dict[str, Any] = {}
    while not over:
        _, reward, over, truncated, info = env.step(np.zeros(2, dtype=np.float32))
        total += reward
        assert not truncated
    assert (info["outcome"], info["reason"], info["is_success"]) == ("parked", "all checks passed", True)
    assert total == pytest.approx(20.0, abs=0.1)
    assert env.episode().run().outcome == "parked"
    with pytest.raises(ResetNeeded):
        env.step(np.zeros(2, dtype=np.float32))


def test_contact_ends_an_episode_at_once(tmp_path: Path) -> None:
    file = tmp_path / "near.yaml"
    file.write_text(SLOT.format(x=2.5))
    env = ParkingEnv("tpcap", files=[file])
    env.reset(seed=0)
    for _ in range(50):
        _, reward, over, truncated, info = env.step(np.array([1.0, 0.0], dtype=np.float32))
        if over:
            break
    assert (over, truncated, info["outcome"], info["reason"]) == (True, False, "not_parked", "contact")
    assert reward < -15.0
    assert -0.03 < info["summary"]["min_clearance"] < 0.0
    run = env.episode().run()
    assert run.summary.penetration == -info["summary"]["min_clearance"]
    assert run.outcome == "not_parked"


def ahead_to_the_end(env: ParkingEnv) -> Any:
    """Return the last period of an episode in which the car drives straight ahead."""
    env.reset(seed=0)
    while True:
        found = env.step(np.array([0.8, 0.0], dtype=np.float32))
        if found[2] or found[3]:
            return found


def test_contact_with_a_polygon_is_that_of_the_verdict(case: Path) -> None:
    env = ParkingEnv("tpcap", files=[case], body="kinematic")
    *_, info = ahead_to_the_end(env)
    assert info["reason"] == "contact"
    summary = env.episode().run().summary
    assert summary.duration == info["summary"]["duration"]
    assert summary.penetration == pytest.approx(-info["summary"]["min_clearance"], abs=1e-12)


def test_contact_at_the_stop_time_with_a_polygon_that_no_sensor_measures(case: Path) -> None:
    wall = [(8.0 - 0.5 * number, -3.0) for number in range(41)] + [(-12.0, -4.0), (8.0, -4.0)]
    corners = ", ".join(f"{x}, {y}" for x, y in wall)
    case.write_text(f"-9, 4, 0, 0, 0, 0, 2, {len(wall)}, 3, {corners}, 6,-4, 9,-4, 8,4")
    first = ahead_to_the_end(ParkingEnv("tpcap", files=[case], body="kinematic"))
    stop_time = first[4]["summary"]["duration"]
    last = ahead_to_the_end(ParkingEnv("tpcap", files=[case], body="kinematic", stop_time=stop_time))
    assert is_same(first, last)
    assert last[4]["reason"] == "contact"


def test_an_episode_that_begins_in_contact_ends_with_its_first_step(tmp_path: Path) -> None:
    file = tmp_path / "near.yaml"
    file.write_text(SLOT.format(x=5.0))
    env = ParkingEnv("tpcap", files=[file])
    env.reset(seed=0)
    _, reward, over, truncated, info = env.step(np.zeros(2, dtype=np.float32))
    assert (reward, over, truncated, info["reason"]) == (-20.0, True, False, "contact")
    with pytest.raises(ResetNeeded):
        env.step(np.zeros(2, dtype=np.float32))
    cars = ParkingVectorEnv(2, "tpcap", files=[file])
    cars.reset(seed=0)
    for ends in (True, False, True):
        assert cars.step(np.zeros((2, 2), dtype=np.float32))[2].tolist() == [ends] * 2


def test_a_car_that_leaves_the_place_ends_failed() -> None:
    env = ParkingEnv("parallel", body="kinematic")
    env.reset(seed=0)
    for _ in range(200):
        *_, over, _, info = env.step(np.array([1.0, 0.0], dtype=np.float32))
        if over:
            break
    assert (over, info["outcome"], info["reason"]) == (True, "failed", "left_path")


def test_an_episode_is_truncated_at_its_stop_time() -> None:
    env = ParkingEnv("parallel", body="kinematic", stop_time=1.1)
    found = driven(env, 20, seed=0)
    assert [item[2:4] for item in found[1:]] == [(False, False)] * 5 + [(False, True)]
    assert found[-1][4]["summary"]["duration"] == 1.1


@pytest.mark.slow
@pytest.mark.parametrize("threads", [1, 3])
def test_cars_side_by_side_are_those_alone(threads: int) -> None:
    cars = ParkingVectorEnv(3, "world", threads=threads, body="kinematic")
    alone = [ParkingEnv("world", body="kinematic") for _ in range(3)]
    begun, _ = cars.reset(seed=11)
    singles = [env.reset(seed=11 + number)[0] for number, env in enumerate(alone)]
    assert is_same(begun, np.stack(singles))
    running = [True] * 3
    for step in actions(20, 3):
        seen, rewards, ended, cut, _ = cars.step(step)
        for number, env in enumerate(alone):
            if running[number]:
                one = env.step(step[number])
                assert is_same(one[:4], (seen[number], float(rewards[number]), bool(ended[number]), bool(cut[number])))
                running[number] = not (one[2] or one[3])


def wall(mode: AutoresetMode) -> ParkingVectorEnv:
    return ParkingVectorEnv(2, "parallel", mode, body="kinematic", stop_time=1.0)


def until_end(cars: ParkingVectorEnv) -> Any:
    """Return the last of five periods, at whose end both cars are at their stop time."""
    cars.reset(seed=7)
    found = [cars.step(step) for step in actions(5, 2)]
    assert [item[3].any() for item in found] == [False] * 4 + [True]
    return found[-1]


def test_autoreset_in_the_next_step() -> None:
    cars = wall(AutoresetMode.NEXT_STEP)
    assert cars.metadata["autoreset_mode"] == AutoresetMode.NEXT_STEP
    last = until_end(cars)
    assert last[4]["outcome"].tolist() == ["not_parked"] * 2
    assert last[4]["summary"]["duration"].tolist() == [1.0, 1.0]
    seen, rewards, ended, cut, infos = cars.step(np.ones((2, 2), dtype=np.float32))
    assert (rewards.tolist(), ended.any(), cut.any()) == ([0.0, 0.0], False, False)
    assert infos["_scene_seed"].all()
    assert not (seen == last[0]).all()
    fresh = ParkingEnv("parallel", body="kinematic", stop_time=1.0)
    begun, _ = fresh.reset(options={"scene_seed": int(infos["scene_seed"][1])})
    assert is_same(begun, seen[1])
    assert cars.episode(0, previous=True).duration == 1.0


def test_autoreset_in_the_same_step() -> None:
    same, other = wall(AutoresetMode.SAME_STEP), wall(AutoresetMode.NEXT_STEP)
    ended, before = until_end(same), until_end(other)
    assert is_same(np.stack(list(ended[4]["final_obs"])), before[0])
    assert ended[4]["final_info"]["outcome"].tolist() == ["not_parked"] * 2
    assert is_same(ended[0], other.step(np.zeros((2, 2), dtype=np.float32))[0])
    same.step(np.zeros((2, 2), dtype=np.float32))


def test_without_autoreset_the_caller_resets() -> None:
    cars = wall(AutoresetMode.DISABLED)
    last = until_end(cars)
    with pytest.raises(ResetNeeded):
        cars.step(np.zeros((2, 2), dtype=np.float32))
    seen, infos = cars.reset(options={"reset_mask": np.array([False, True])})
    assert is_same(seen[0], last[0][0])
    assert infos["_scene_seed"].tolist() == [False, True]
    with pytest.raises(ResetNeeded):
        cars.step(np.zeros((2, 2), dtype=np.float32))
    cars.reset(options={"reset_mask": np.array([True, False])})
    cars.step(np.zeros((2, 2), dtype=np.float32))


def test_make_vec_makes_the_compiled_cars() -> None:
    cars = gymnasium.make_vec("apa/Perpendicular-v0", num_envs=4, body="kinematic")
    assert isinstance(cars.unwrapped, ParkingVectorEnv)
    seen, _ = cars.reset(seed=1)
    assert seen.shape == (4, 24)
    cars.close()


def test_the_picture_shows_the_car_where_it_is() -> None:
    env = ParkingEnv("parallel", "rgb_array", body="kinematic")
    env.reset(seed=2)
    before = env.render()
    for _ in range(10):
        env.step(np.array([0.6, 0.0], dtype=np.float32))
    after = env.render()
    blue = np.array([0x1E, 0x6B, 0xD9], dtype=np.uint8)
    shown = [np.argwhere((image == blue).all(axis=2)) for image in (before, after)]
    assert all(len(pixels) > 1000 for pixels in shown)
    assert shown[0].mean(axis=0) != pytest.approx(shown[1].mean(axis=0), abs=1.0)


def test_a_video_is_as_fast_as_the_car() -> None:
    assert ParkingEnv().metadata["render_fps"] == 5.0
    assert ParkingEnv(period=0.1).metadata["render_fps"] == 10.0
    assert ParkingVectorEnv(period=0.1).metadata["render_fps"] == 10.0


@pytest.mark.parametrize(
    ("given", "key"),
    [
        ({"scenes": "parking"}, "scenes"),
        ({"body": "bus"}, "body"),
        ({"period": 0.015}, "period"),
        ({"period": 0.0}, "period"),
        ({"stop_time": 0.0}, "stop_time"),
        ({"files": ["a.csv"]}, "files"),
        ({"scenes": "tpcap"}, "files"),
        ({"scenes": "tpcap", "files": ["none.csv"]}, "none.csv"),
        ({"scenes": "tpcap", "files": [Path(__file__).parent]}, "no case"),
        ({"render_mode": "human"}, "render_mode"),
        ({"peddals": True}, "pedals"),
    ],
)
def test_a_bad_argument_is_refused(given: dict[str, Any], key: str) -> None:
    with pytest.raises(BadInput, match=key):
        ParkingEnv(**given).reset(seed=0)


@pytest.mark.parametrize("seed", [-1, 2**31 - 1, 1.5, True])
def test_a_bad_scene_seed_is_refused(seed: Any) -> None:
    with pytest.raises(BadInput, match="scene_seed"):
        ParkingEnv(body="kinematic").reset(options={"scene_seed": seed})


def test_the_package_without_extras_imports_no_gymnasium() -> None:
    code = "import sys, apa_cosim, orchestrator.cli; apa_cosim.run; raise SystemExit('gymnasium' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
