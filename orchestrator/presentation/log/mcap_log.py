"""The log of a run: every exchange of every instance, parameters, pictures and messages, in one MCAP file.

Channels: ``/vehicle``, ``/controller`` (outputs as they are, inputs as they were seen, at each exchange); of their
large structures ``/controller/guo2015`` and so on (on change, and at the first exchange of a chunk);
``/vehicle/parameters``, ``/controller/parameters`` (once), ``/tf``, ``/scene``, ``/path``, ``/trail``
(Foxglove types, at 20 Hz; a path on change, at 5 Hz at most) and ``/log``. Times are simulated time from zero;
nothing in the file depends on real time, so the same run gives the same bytes.
"""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.Log_pb2 import Log
from foxglove_schemas_protobuf.PosesInFrame_pb2 import PosesInFrame
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

from orchestrator.evaluation.verdict.geometry import (
    ON_ROAD,
    PLANNED,
    CarOutline,
    find_changes,
    sample_path,
    vehicle_parameters,
)
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.presentation.drawing import scene
from orchestrator.presentation.log.line import MAX_LINES, Line, line_of
from orchestrator.presentation.log.mcap_file import HEADER_SIZE, McapFile
from orchestrator.presentation.log.protobuf_rows import Encoder
from orchestrator.presentation.log.read_log import with_checksum
from orchestrator.presentation.log.schema import PARAMETERS
from orchestrator.presentation.log.signal_channels import RowChanges, SignalChannels, add_channel, message_name
from orchestrator.presentation.log.sink import MessageSink, Sink
from orchestrator.simulation.cosim.algorithm import Termination
from orchestrator.simulation.cosim.fmu_instance import Array, FmuInstance, Ports, all_values, places_of
from orchestrator.simulation.cosim.signal_blocks import Times

SCENE_PERIOD_NS = 50_000_000
PATH_PERIOD_NS = 200_000_000
TRAIL_PERIOD_NS = 1_000_000_000
TRAIL_STEP_NS = 200_000_000
TRAIL_POSES = 100
MAX_TRAIL_POSES = 20_000
"""Kept of a run of any length; the first hour has fewer."""
AXES = ("x", "y", "heading")


class McapLog:
    """Observer that writes the log to a file, or streams it."""

    def __init__(
        self, to: Path | Sink, instances: Sequence[FmuInstance], scenario: Scenario, info: dict[str, Any]
    ) -> None:
        self._file: Sink = McapFile(to) if isinstance(to, Path) else to
        self._file.metadata("apa", with_checksum(info))
        self.lines: list[Line] = []
        """Of ``/log``."""
        is_file = isinstance(to, Path)  # each of its chunks can be read without the one before
        self._signals = SignalChannels(self._file, instances, is_repeated=is_file)
        self._log = self._file.add_channel("/log", Log)
        for instance in instances:
            self._write_parameters(instance)
        self._pictures: list[_Pictures] = []
        if _frame_columns(instances):
            self._pictures.append(_Pictures(self._file, instances, scenario))
        self.rows_per_chunk = rows = self._signals.rows_per_chunk() if is_file else 1
        self._values = all_values(instances)
        self._rows = np.empty((rows, len(self._values)))
        self._times = np.empty(rows, dtype=np.int64)
        self._count = 0
        self._latest: Array | None = None
        """The last row that is written."""
        self._file.flush()

    def on_communication_point(self, t_ns: int) -> None:
        """Keep a row; a chunk's worth of them goes to the file at once."""
        self.observe_rows(np.array([t_ns], dtype=np.int64), self._values[None, :].copy())

    def observe_rows(self, t_ns: Times, rows: Array) -> None:
        """Take many rows; those that do not fill a chunk are kept."""
        begin, most = 0, len(self._times)
        while begin < len(t_ns):
            rest = len(t_ns) - begin
            if self._count == 0 and rest >= most:
                end = begin + most
                self._write_rows(t_ns[begin:end], rows[begin:end])
                self._file.flush()
            else:
                end = begin + min(rest, most - self._count)
                filled = self._count + end - begin
                self._times[self._count : filled], self._rows[self._count : filled] = t_ns[begin:end], rows[begin:end]
                self._count = filled
                if filled == most:
                    self._write_kept()
                    self._file.flush()
            begin = end

    def say(self, t_ns: int, level: int, name: str, text: str) -> None:
        """Write one line to ``/log``."""
        if self._file.open:
            line = Log(timestamp=scene.stamp(t_ns), level=level, message=text, name=name)  # type: ignore[arg-type]
            self._file.write(self._log, t_ns, line.SerializeToString(deterministic=True))
            if len(self.lines) < MAX_LINES:
                self.lines.append(line_of(t_ns, level, name, text))

    def discard(self) -> None:
        """Leave no file: nothing has run."""
        if isinstance(self._file, McapFile):
            self._file.discard()

    def on_terminate(self, end: Termination) -> None:
        """Write how the run ended and give the file its name."""
        self._write_kept()
        for pictures in self._pictures:
            self._file.later(partial(pictures.on_terminate, t_ns=end.t_ns))
        self._file.flush()
        self._file.metadata("end", with_checksum({"reason": end.reason, "t_ns": end.t_ns}))
        self._file.close()

    def _write_kept(self) -> None:
        if self._count:
            self._write_rows(self._times[: self._count], self._rows[: self._count])
            self._count = 0
            self._rows, self._times = np.empty_like(self._rows), np.empty_like(self._times)

    def _write_rows(self, t_ns: Times, rows: Array) -> None:
        self._file.later(lambda to: self._draw_and_encode(to, t_ns, rows))

    def _draw_and_encode(self, to: MessageSink, t_ns: Times, rows: Array) -> None:
        changes = RowChanges(rows, self._latest)
        for pictures in self._pictures:
            pictures.write(to, t_ns, rows, changes)
        self._signals.write(to, t_ns, rows, changes)
        self._latest = rows[-1].copy()

    def _write_parameters(self, instance: FmuInstance) -> None:
        ports: Ports = instance.parameters
        notes = ["parameter"] * len(ports.names)
        message = message_name(instance.name, PARAMETERS)
        channel = add_channel(self._file, f"/{instance.name}/{PARAMETERS}", message, ports.variables, notes)
        self._file.write(channel, 0, Encoder(ports.variables).encode(ports.values))


class _Pictures:
    """Frames and scene, as far as the instances have the signals for them."""

    def __init__(self, file: Sink, instances: Sequence[FmuInstance], scenario: Scenario) -> None:
        self._drawn = _frame_columns(instances)
        self._known = [place for place, column in enumerate(self._drawn) if column is not None]
        self._known_columns = [column for column in self._drawn if column is not None]
        named = {instance.name: instance for instance in instances}
        self._controller = named.get("controller")
        outputs = dict(zip(named, places_of(instances)[1::2], strict=True))
        self._controller_outputs = outputs.get("controller", slice(0, 0))
        around = vehicle_parameters(scenario, _values_by_name(named["vehicle"].parameters))
        self._car = CarOutline.of(around)
        self._frames = scene.Frames(self._car, HEADER_SIZE)
        self._transforms = file.add_channel("/tf", FrameTransforms)
        self._scene = file.add_channel("/scene", SceneUpdate)
        self._path = file.add_channel("/path", SceneUpdate)
        self._trail = file.add_channel("/trail", PosesInFrame)
        self._poses: list[bytes] = []
        self._trail_count, self._trail_stride = 0, 1
        self._last_period = -1
        self._path_places = _path_places(self._controller.outputs) if self._controller else np.empty(0, np.intp)
        self._path_columns = self._controller_outputs.start + self._path_places
        road = self._controller.outputs.index.get(ON_ROAD) if self._controller else None
        self._road_columns = np.array([] if road is None else [self._controller_outputs.start + road], dtype=np.intp)
        names = self._controller.outputs.names if self._controller else []
        self._path_names = [*(names[place] for place in self._path_places), *([] if road is None else [ON_ROAD])]
        self._path_and_road = np.append(self._path_columns, self._road_columns)
        self._path_values: Array | None = None
        """Outputs that the path is made of which is drawn."""
        self._path_is_drawn = False
        self._stage = scene.Surroundings.of(scenario, around)
        self._changes = self._stage.changes_ns()

    def write(self, to: MessageSink, t_ns: Times, rows: Array, changes: RowChanges) -> None:
        """Draw what is due at these exchanges."""
        path_changes = changes.rows_of(self._path_and_road)
        self._path_is_drawn &= not len(path_changes)
        periods = t_ns // SCENE_PERIOD_NS
        due = np.flatnonzero(periods > np.append(self._last_period, periods[:-1]))
        self._last_period = int(periods[-1])
        if not len(due):
            return
        times, drawn = t_ns[due], np.zeros((len(due), len(self._drawn)))
        drawn[:, self._known] = rows[due[:, None], self._known_columns]
        self._write_poses(to, times, drawn)
        while self._changes and times[-1] >= self._changes[0]:
            self._draw_stage(to, int(times[np.searchsorted(times, self._changes[0])]))
        shown = due[times % PATH_PERIOD_NS < SCENE_PERIOD_NS]
        if not self._path_is_drawn and len(shown):
            self._draw_paths(to, t_ns[shown], rows.take(shown, axis=0))
            self._path_is_drawn = not len(path_changes) or bool(path_changes[-1] <= shown[-1])

    def _draw_stage(self, to: MessageSink, t_ns: int) -> None:
        self._changes = [change for change in self._changes if change > t_ns]
        still = scene.still_life(t_ns, self._car, self._stage)
        to.write(self._scene, t_ns, still.SerializeToString(deterministic=True))

    def on_terminate(self, to: MessageSink, t_ns: int) -> None:
        if self._last_period >= 0:
            self._draw_trail(to, t_ns)

    def _write_poses(self, to: MessageSink, times: Times, drawn: Array) -> None:
        """Write the frames at ``times``, and the trail where it is due. ``drawn``: see ``scene.Frames.rows``."""
        to.write_rows(self._transforms, times, self._frames.rows(times, drawn))
        in_trail = np.flatnonzero(times % TRAIL_STEP_NS < SCENE_PERIOD_NS)
        for time, pose in zip(times[in_trail].tolist(), scene.trail_poses(drawn[in_trail, :3]), strict=True):
            self._add_to_trail(pose)
            if time % TRAIL_PERIOD_NS < SCENE_PERIOD_NS:
                self._draw_trail(to, time)

    def _add_to_trail(self, pose: bytes) -> None:
        """Keep a pose; of a long run every second one, every fourth, and so on."""
        if self._trail_count % self._trail_stride == 0:
            self._poses.append(pose)
        self._trail_count += 1
        if len(self._poses) > MAX_TRAIL_POSES:
            del self._poses[1::2]
            self._trail_stride *= 2

    def _draw_trail(self, to: MessageSink, t_ns: int) -> None:
        to.write(self._trail, t_ns, scene.trail(t_ns, self._poses[:: max(1, len(self._poses) // TRAIL_POSES)]))

    def _draw_paths(self, to: MessageSink, t_ns: Times, rows: Array) -> None:
        """Draw the planned path wherever it changes."""
        if self._controller is None:
            return
        on_road = rows[:, self._road_columns] > 0.0
        values = np.hstack([rows.take(self._path_columns, axis=1), on_road])
        changes = find_changes(values, self._path_values)
        self._path_values = values[-1]
        for row in changes.tolist():
            named = dict(zip(self._path_names, values[row].tolist(), strict=True))
            parameters = _values_by_name(self._controller.parameters) if on_road[row].any() else None
            points = sample_path(named, parameters=parameters)
            update = scene.path_update(int(t_ns[row]), points)
            to.write(self._path, int(t_ns[row]), update.SerializeToString(deterministic=True))


def _frame_columns(instances: Sequence[FmuInstance]) -> list[int | None]:
    """Return where pose, odometry and angle of the front wheels are among all values; empty without a pose.

    The frames are made of them. They are outputs of the vehicle, or inputs of its name. Absent odometry is the pose.
    """
    parts = places_of(instances)
    columns: dict[str, int] = {}
    for number, instance in enumerate(instances):
        if instance.name == "vehicle":
            for ports, part in ((instance.inputs, parts[2 * number]), (instance.outputs, parts[2 * number + 1])):
                columns |= {name: part.start + place for place, name in enumerate(ports.names)}
    poses = [columns.get(f"pose.{axis}") for axis in AXES]
    if None in poses:
        return []
    odometry = [columns.get(f"odometry.{axis}", pose) for axis, pose in zip(AXES, poses, strict=True)]
    return [*poses, *odometry, columns.get("front_wheel_angle")]


def _values_by_name(ports: Ports) -> dict[str, float]:
    return dict(zip(ports.names, ports.values.tolist(), strict=True))


def _path_places(ports: Ports) -> np.ndarray[Any, np.dtype[np.intp]]:
    """Return where the outputs are that the planned path is drawn from (see ``geometry.sample_path``)."""
    chosen = [place for place, name in enumerate(ports.names) if PLANNED.match(name)]
    return np.array(chosen, dtype=np.intp)
