"""``apa export ros2``: read back with rosbags, and with mcap alone, the values are those of the log."""

import math
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader

from orchestrator.cli import main
from orchestrator.evaluation.verdict.geometry import sample_path
from orchestrator.presentation.log.read_log import read_log
from orchestrator.simulation.cosim.recording import Recording

rosbags = pytest.importorskip("rosbags.highlevel", reason="the package rosbags is not installed")
FLOATS = ("speed", "measured_speed", "steering_wheel_angle", "front_wheel_angle")


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("ros2") / "run"
    assert main(["run", "guo2015-case4", "--out", str(folder), "--no-page", "--quiet"]) == 0
    assert main(["export", "ros2", str(folder), "--signals", "vehicle.ultrasonic[3]"]) == 0
    return folder


@pytest.fixture(scope="module")
def log(run: Path) -> Recording:
    return read_log(run / "run.mcap")


@pytest.fixture(scope="module")
def bag(run: Path) -> dict[str, list[tuple[int, Any]]]:
    """Topic -> (time, message)."""
    found: dict[str, list[tuple[int, Any]]] = defaultdict(list)
    with rosbags.AnyReader([run / "run_ros2"]) as reader:
        for connection, time, data in reader.messages():
            found[connection.topic].append((time, reader.deserialize(data, connection.msgtype)))
    return found


def yaw(turn: Any) -> float:
    return 2.0 * math.atan2(turn.z, turn.w)


def test_numbers_are_those_of_the_log(bag: dict[str, list[tuple[int, Any]]], log: Recording) -> None:
    for name in FLOATS:
        assert [time for time, _ in bag[f"/{name}"]] == log.t_ns.tolist()
        assert [message.data for _, message in bag[f"/{name}"]] == log.signals[f"vehicle.{name}"].tolist()
    third = [message.data for _, message in bag["/signals/vehicle/ultrasonic_3"]]
    assert third == log.signals["vehicle.ultrasonic[3]"].tolist()


@pytest.mark.parametrize("name", ["pose", "odometry"])
def test_poses_are_those_of_the_log(bag: dict[str, list[tuple[int, Any]]], log: Recording, name: str) -> None:
    messages = [message for _, message in bag[f"/{name}"]]
    assert {message.header.frame_id for message in messages} == {"map"}
    stamps = [message.header.stamp.sec * 10**9 + message.header.stamp.nanosec for message in messages]
    assert stamps == log.t_ns.tolist()
    for axis in "xy":
        values = [getattr(message.pose.position, axis) for message in messages]
        assert values == log.signals[f"vehicle.{name}.{axis}"].tolist()
    headings = [yaw(message.pose.orientation) for message in messages]
    np.testing.assert_allclose(headings, log.signals[f"vehicle.{name}.heading"], atol=1e-12)


def test_frames_hang_together(bag: dict[str, list[tuple[int, Any]]], log: Recording) -> None:
    mounts = {item.child_frame_id: item.header.frame_id for item in bag["/tf_static"][0][1].transforms}
    assert mounts == {f"ultrasonic_{number}": "base_link" for number in range(1, 13)}
    assert len(bag["/tf"]) == log.count
    _, last = bag["/tf"][-1]
    parents = {item.child_frame_id: item for item in last.transforms}
    assert parents["base_link"].header.frame_id == "map"
    assert parents["base_link"].transform.translation.x == log.signals["vehicle.pose.x"][-1]
    wheel = parents["front_left_wheel"]
    assert wheel.header.frame_id == "base_link"
    assert yaw(wheel.transform.rotation) == pytest.approx(log.signals["vehicle.front_wheel_angle"][-1], abs=1e-12)


def test_ranges_are_those_of_twelve_sensors(bag: dict[str, list[tuple[int, Any]]], log: Recording) -> None:
    rows = {time: row for row, time in enumerate(log.t_ns.tolist())}
    for number in range(1, 13):
        messages = bag[f"/ultrasonic/range_{number}"]
        assert len(messages) == len([time for time in rows if time % 40_000_000 == 0])
        values = log.signals[f"vehicle.ultrasonic[{number}]"]
        for time, message in messages:
            assert np.float32(message.range) == np.float32(values[rows[time]])
            assert np.float32(message.max_range) == np.float32(5.0)
            assert message.header.frame_id == f"ultrasonic_{number}"


def test_paths_are_those_planned_and_driven(bag: dict[str, list[tuple[int, Any]]], log: Recording) -> None:
    time, path = bag["/planned_path"][-1]
    row = int(np.searchsorted(log.t_ns, time))
    points = [[pose.pose.position.x, pose.pose.position.y] for pose in path.poses]
    planned = sample_path(log.values_at("controller", row), parameters=log.parameters_of("controller"))
    assert len(points) > 10
    assert points == planned[:, :2].tolist()
    time, driven = bag["/driven_path"][-1]
    assert time == log.t_ns[-1]
    end = driven.poses[-1].pose.position
    assert (end.x, end.y) == (log.signals["vehicle.pose.x"][-1], log.signals["vehicle.pose.y"][-1])


def test_the_scene_and_the_messages_are_there(bag: dict[str, list[tuple[int, Any]]]) -> None:
    names = {marker.ns for _, array in bag["/markers"] for marker in array.markers}
    assert {"car", "target", "front_left_wheel"} <= names
    assert all(message.msg for _, message in bag["/rosout"])


def test_definitions_are_in_the_file(run: Path) -> None:
    with (run / "run_ros2" / "run_ros2.mcap").open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    assert {schema.encoding for schema in summary.schemas.values()} == {"ros2msg"}
    texts = {schema.name: schema.data.decode() for schema in summary.schemas.values()}
    assert "float32 field_of_view" in texts["sensor_msgs/msg/Range"]
    assert "MSG: geometry_msgs/Pose" in texts["geometry_msgs/msg/PoseStamped"]
    assert {channel.message_encoding for channel in summary.channels.values()} == {"cdr"}


def test_a_bag_is_replaced_and_nothing_else(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", "ros2", str(run)]) == 0
    other = run.parent / "other"
    other.mkdir()
    (other / "mine.txt").write_text("mine", encoding="utf-8")
    assert main(["export", "ros2", str(run), "--out", str(other)]) == 2
    assert "exists and is no bag" in capsys.readouterr().err
    assert sorted(item.name for item in run.parent.iterdir()) == ["other", "run"]
