"""What observers and endings make of many exchanges at once is what they make of one after the other."""

import threading
from collections import defaultdict
from pathlib import Path

import numpy as np
import pytest
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.PosesInFrame_pb2 import PosesInFrame
from mcap.reader import make_reader

from orchestrator.evaluation.verdict.geometry import CarOutline
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.presentation.drawing.scene import Frames, planar_pose, trail, trail_poses
from orchestrator.presentation.log import mcap_log
from orchestrator.session.session import Messages, make_instances, run_scenario
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.simulation.cosim.fmu_instance import all_values
from orchestrator.simulation.cosim.stop_conditions import standstill


def messages(path: Path) -> dict[str, list[tuple[int, bytes]]]:
    found: dict[str, list[tuple[int, bytes]]] = defaultdict(list)
    with path.open("rb") as stream:
        for _, channel, message in make_reader(stream).iter_messages():
            found[channel.topic].append((message.log_time, message.data))
    return found


@pytest.mark.parametrize("name", ["guo2015-case4", "apa-parallel"])
def test_logs_of_both_masters_have_the_same_messages(tmp_path: Path, name: str) -> None:
    scenario, files = load_scenario(name), fmu_files("native")
    logs = {}
    for kind in ("python", "native"):  # of the same FMUs: the kind chooses the master
        run_scenario(scenario, files, kind=kind, log=tmp_path / f"{kind}.mcap")
        logs[kind] = messages(tmp_path / f"{kind}.mcap")
    assert {"/tf", "/trail", "/path", "/log"} <= logs["native"].keys()
    for topic, expected in logs["python"].items():
        assert logs["native"][topic] == expected, topic


def test_the_thread_that_drives_draws_and_encodes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    threads: dict[str, set[int]] = defaultdict(set)

    def note_threads(name: str) -> None:
        call = getattr(mcap_log, name)

        def noted(*arguments: object, **named: object) -> object:
            threads[name].add(threading.get_ident())
            return call(*arguments, **named)

        monkeypatch.setattr(mcap_log, name, noted)

    note_threads("RowChanges")
    note_threads("sample_path")
    run_scenario(load_scenario("guo2015-case4"), log=tmp_path / "log.mcap")
    assert threads.keys() == {"RowChanges", "sample_path"}
    assert threading.get_ident() not in set.union(*threads.values())


def test_an_ending_finds_the_same_exchange_in_blocks() -> None:
    random = np.random.default_rng(46)
    scenario = load_scenario("guo2015-case4")
    instances = make_instances(scenario, None, Messages())
    values = all_values(instances)
    final = scenario.stop_condition.final()
    for _ in range(50):
        one, block = (standstill(scenario.stop_condition, instances) for _ in range(2))
        assert one is not None
        assert block is not None
        rows = np.zeros((400, len(values)))
        mode, speed = block._columns
        rows[:, mode] = np.repeat(random.choice([*final, 0], 20), 20)
        rows[:, speed] = np.repeat(random.choice([0.0, 0.0, 0.0, 1.0], 40), 10)
        t_ns = np.arange(400, dtype=np.int64) * 10_000_000
        expected = None
        for row in range(400):
            values[:] = rows[row]
            if expected is None and one.stop_reason(int(t_ns[row])):
                expected = row
        found = None
        for begin in range(0, 400, 70):
            reached = block.first_reached(t_ns[begin : begin + 70], rows[begin : begin + 70])
            if found is None and reached is not None:
                found = begin + reached[0]
                break
        assert found == expected


def test_frames_have_the_numbers_they_are_given() -> None:
    car = CarOutline.of({})
    drawn = np.array([[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], [1.5, -2.5, 0.3, 1.25, -2.75, 0.4, -0.2]])
    rows = Frames(car).rows(np.array([0, 12_345_678_901], dtype=np.int64), drawn)
    first, second = (FrameTransforms.FromString(row.tobytes()) for row in rows)
    assert all(part.timestamp.ToNanoseconds() == 0 for part in first.transforms)
    assert all(part.timestamp.ToNanoseconds() == 12_345_678_901 for part in second.transforms)
    names = [(part.parent_frame_id, part.child_frame_id) for part in second.transforms]
    assert names == [("world", "car"), ("world", "odometry"), ("car", "front_right_wheel"), ("car", "front_left_wheel")]
    assert [(part.translation.x, part.translation.y) for part in second.transforms[:2]] == [(1.5, -2.5), (1.25, -2.75)]
    places = [(part.translation.x, part.translation.y) for part in second.transforms[2:]]
    assert places == [pytest.approx(place) for place in car.wheels()[2:]]
    turns = [2.0 * np.arctan2(part.rotation.z, part.rotation.w) for part in second.transforms]
    assert turns == pytest.approx([0.3, 0.4, -0.2, -0.2])


def test_a_trail_has_the_poses_it_is_given() -> None:
    poses = [(0.0, 0.0, 0.0), (1.5, -2.5, 0.3), (-0.0, 1e9, -3.0)]
    message = PosesInFrame.FromString(trail(1_500_000_000, trail_poses(np.array(poses))))
    assert message.timestamp.ToNanoseconds() == 1_500_000_000
    assert list(message.poses) == [planar_pose(*pose) for pose in poses]


def test_a_block_without_a_point_of_the_trail_adds_none() -> None:
    assert trail_poses(np.empty((0, 3))) == []
