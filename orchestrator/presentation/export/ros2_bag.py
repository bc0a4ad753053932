"""The messages of a run in a bag of ROS 2: frames, poses, paths, ranges, numbers, markers, lines."""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from orchestrator.evaluation.verdict.geometry import (
    PLANNED,
    CarOutline,
    find_changes,
    is_planned,
    sample_path,
    vehicle_parameters,
)
from orchestrator.evaluation.verdict.logged_scenario import read_logged_scenario
from orchestrator.presentation.drawing.scene import CAR as CAR_FRAME
from orchestrator.presentation.drawing.scene import FRONT_WHEELS, WORLD, Surroundings, still_life
from orchestrator.presentation.drawing.scene import ODOMETRY as ODOMETRY_FRAME
from orchestrator.presentation.export.ros2_messages import MessageFactory, type_name
from orchestrator.presentation.log.line import Line
from orchestrator.presentation.report.still import sensors
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.recording import Recording

CONTROLLER = "controller."
NUMBERS = ("speed", "measured_speed", "steering_wheel_angle", "front_wheel_angle", "clearance")
POSES = ("pose", "odometry")
AXES = ("x", "y", "heading")
MAX_DRIVEN_PATHS, MAX_DRIVEN_POSES = 200, 500
DRIVEN_PERIOD = 1.0
"""Time between two paths driven so far [s], as far as there are not too many."""
LEVELS = {"debug": 10, "info": 20, "warning": 30, "error": 40, "fatal": 50}
"""Of rcl_interfaces/Log."""
ULTRASOUND_TYPE = 0


class Bag:
    """A bag that is being written."""

    def __init__(self, writer: Any) -> None:
        self._writer = writer
        self._messages = MessageFactory()
        self._topics: dict[str, Any] = {}

    def write(self, t_ns: int, topic: str, kind: str, **fields: Any) -> None:
        """Write a message; ``kind`` as ``sensor_msgs/Range``."""
        if topic not in self._topics:
            self._topics[topic] = self._writer.add_connection(topic, type_name(kind), typestore=self._messages.store)
        message = self._messages.message(kind, **fields)
        self._writer.write(self._topics[topic], t_ns, self._messages.serialize(message, kind))

    def write_run(self, recording: Recording, names: Sequence[str], lines: list[Line]) -> None:
        """Write everything, part by part."""
        self._write_static(recording)
        driven = _DrivenPath(recording)
        planned: Array | None = None
        for part, first, is_last in recording.parts():
            t_ns = part.t_ns.tolist()
            for numbers in _numbers(part, names):
                for time, value in zip(t_ns, numbers.values.tolist(), strict=True):
                    self.write(time, numbers.topic, "std_msgs/Float64", data=float(value))
            self._write_poses(part, t_ns)
            self._write_ranges(part, t_ns, first)
            planned = self._write_planned(part, t_ns, planned)
            for row, points in driven.paths(part, first, is_last):
                self._write_path(t_ns[row], "/driven_path", points)
        for line in lines:
            self._write_line(line)

    def _write_poses(self, part: Recording, t_ns: list[int]) -> None:
        poses = {name: _pose(part, name) for name in POSES}
        wheel = part.signals.get("vehicle.front_wheel_angle")
        front = CarOutline.of(part.parameters_of("vehicle")).wheels()[2:]
        for row, time in enumerate(t_ns):
            frames = []
            for name, frame in zip(POSES, (CAR_FRAME, ODOMETRY_FRAME), strict=True):
                values = poses[name]
                if values is not None:
                    place = tuple(values[row].tolist())
                    header = self._messages.header(time, WORLD)
                    pose = self._messages.pose(*place)
                    self.write(time, f"/{name}", "geometry_msgs/PoseStamped", header=header, pose=pose)
                    frames.append(self._messages.transform(time, (WORLD, frame), place))
            if wheel is not None and frames:
                turn = float(wheel[row])
                for name, (x, y) in zip(FRONT_WHEELS, front, strict=True):
                    frames.append(self._messages.transform(time, (CAR_FRAME, name), (x, y, turn)))
            if frames:
                self.write(time, "/tf", "tf2_msgs/TFMessage", transforms=frames)

    def _write_ranges(self, part: Recording, t_ns: list[int], first: int) -> None:
        """Write the readings at every cycle of the sensors."""
        vehicle = part.parameters_of("vehicle")
        cycle_ns = max(round(vehicle.get("car.ultrasonic.cycle", 0.0) * 1e9), 1)
        low = vehicle.get("car.ultrasonic.min_range", 0.0)
        for number, sensor in enumerate(_sensors(part), start=1):
            readings = part.signals[sensor["signal"]].tolist()
            for row, time in enumerate(t_ns):
                if time % cycle_ns == 0 or first + row == 0:
                    self.write(
                        time,
                        f"/ultrasonic/range_{number}",
                        "sensor_msgs/Range",
                        header=self._messages.header(time, f"ultrasonic_{number}"),
                        radiation_type=ULTRASOUND_TYPE,
                        field_of_view=2.0 * sensor["half"],
                        min_range=low,
                        max_range=sensor["range"],
                        range=readings[row],
                    )

    def _write_planned(self, part: Recording, t_ns: list[int], before: Array | None) -> Array | None:
        """Write the planned path whenever it changes; return the latest values of its signals."""
        planned = is_planned(part.signals)
        names = [name for name in part.signals if PLANNED.match(name.removeprefix(CONTROLLER))]
        columns = [part.signals[name] for name in names] + ([planned] if len(planned) else [])
        if not columns or not t_ns:
            return before
        table = np.column_stack(columns)
        parameters = part.parameters_of("controller")
        for row in find_changes(table, before).tolist():
            points = sample_path(part.values_at("controller", row), parameters=parameters)
            self._write_path(t_ns[row], "/planned_path", points)
        last: Array = table[-1]
        return last

    def _write_path(self, t_ns: int, topic: str, points: Array) -> None:
        header = self._messages.header(t_ns, WORLD)
        headings = np.arctan2(*np.gradient(points, axis=0).T[::-1]) if len(points) > 1 else np.zeros(len(points))
        poses = [
            self._messages.message("geometry_msgs/PoseStamped", header=header, pose=self._messages.pose(x, y, heading))
            for (x, y), heading in zip(points[:, :2].tolist(), headings.tolist(), strict=True)
        ]
        self.write(t_ns, topic, "nav_msgs/Path", header=header, poses=poses)

    def _write_static(self, recording: Recording) -> None:
        """Write frames of the sensors, and markers, those again whenever an obstacle appears or disappears."""
        mounts = [
            self._messages.transform(0, (CAR_FRAME, f"ultrasonic_{number}"), (item["x"], item["y"], item["heading"]))
            for number, item in enumerate(_sensors(recording), start=1)
        ]
        if mounts:
            self.write(0, "/tf_static", "tf2_msgs/TFMessage", transforms=mounts)
        scenario = read_logged_scenario(recording)
        around = vehicle_parameters(scenario, recording.parameters_of("vehicle"))
        stage = Surroundings.of(scenario, around)
        for t_ns in stage.changes_ns():
            if t_ns <= recording.duration * 1e9:
                update = still_life(t_ns, CarOutline.of(around), stage)
                markers = list(self._messages.markers(t_ns, update))
                self.write(t_ns, "/markers", "visualization_msgs/MarkerArray", markers=markers)

    def _write_line(self, line: Line) -> None:
        t_ns = round(line.t * 1e9)
        self.write(
            t_ns,
            "/rosout",
            "rcl_interfaces/Log",
            stamp=self._messages.time(t_ns),
            level=LEVELS.get(line.level, LEVELS["info"]),
            name=line.name,
            msg=line.text,
            file="",
            function="",
            line=0,
        )


class _Numbers(NamedTuple):
    """A signal as Float64."""

    topic: str
    values: Array


def _numbers(part: Recording, names: Sequence[str]) -> Iterator[_Numbers]:
    for name in NUMBERS:
        if f"vehicle.{name}" in part.signals:
            yield _Numbers(f"/{name}", part.signals[f"vehicle.{name}"])
    for name in names:
        yield _Numbers(topic_of(name), part.signals[name])


def topic_of(name: str) -> str:
    """Return the topic of a signal: ``/signals/vehicle/ultrasonic_3``."""
    return "/signals/" + name.replace(".", "/").replace("[", "_").replace("]", "")


def _pose(part: Recording, name: str) -> Array | None:
    columns = [part.signals.get(f"vehicle.{name}.{axis}") for axis in AXES]
    known = [column for column in columns if column is not None]
    return np.column_stack(known) if len(known) == len(AXES) else None


def _sensors(recording: Recording) -> list[dict[str, Any]]:
    return sensors(recording.parameters_of("vehicle"), recording.signals)


class _DrivenPath:
    """The path driven so far, at some instants."""

    def __init__(self, recording: Recording) -> None:
        self._period = max(DRIVEN_PERIOD, recording.duration / MAX_DRIVEN_PATHS)
        self._stride = max(1, recording.count // MAX_DRIVEN_POSES)
        self._points: list[Array] = []
        self._next = 0.0

    def paths(self, part: Recording, first: int, is_last: bool) -> Iterator[tuple[int, Array]]:
        """Yield rows of a part, and the path until then: the points kept, and the place of the car."""
        pose = _pose(part, "pose")
        if pose is None:
            return
        for row, t in enumerate(part.t.tolist()):
            if (first + row) % self._stride == 0 or (is_last and row == part.count - 1):
                self._points.append(pose[row, :2])
            if t >= self._next or (is_last and row == part.count - 1):
                self._next = t + self._period
                yield row, np.vstack([*self._points, pose[row, :2]])
