"""Pictures for MCAP viewers, in Foxglove's well-known message types: frames, car, wheels, slot, obstacles, path, trail.

The car and its wheels are drawn once, each fixed to its own frame; what moves are the frames.
"""

import math
import re
import struct
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from foxglove_schemas_protobuf.Color_pb2 import Color
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.LinePrimitive_pb2 import LinePrimitive
from foxglove_schemas_protobuf.Point3_pb2 import Point3
from foxglove_schemas_protobuf.Pose_pb2 import Pose
from foxglove_schemas_protobuf.PosesInFrame_pb2 import PosesInFrame
from foxglove_schemas_protobuf.Quaternion_pb2 import Quaternion
from foxglove_schemas_protobuf.SceneEntity_pb2 import SceneEntity
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3
from google.protobuf.duration_pb2 import Duration
from google.protobuf.timestamp_pb2 import Timestamp
from numpy.typing import NDArray

from orchestrator.evaluation.verdict.geometry import (
    WHEEL_RADIUS,
    WHEEL_WIDTH,
    Box,
    CarOutline,
    Kerb,
    boxes,
    edges,
    kerbs,
    slot_box,
)
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.simulation.cosim.fmu_instance import Array

WORLD = "world"
CAR = "car"
ODOMETRY = "odometry"
FRONT_WHEELS = ("front_right_wheel", "front_left_wheel")
CAR_HEIGHT = 1.4
BODY = (0.20, 0.42, 0.75, 0.85)
TYRE = (0.10, 0.10, 0.10, 1.0)
GREEN = (0.15, 0.60, 0.30, 0.9)
GREY = (0.55, 0.57, 0.60, 0.9)
DOUBLE = struct.Struct("<d")
ORANGE = (0.90, 0.50, 0.10, 1.0)


def stamp(t_ns: int) -> Timestamp:
    """Return ``t_ns`` as a protobuf timestamp."""
    return Timestamp(seconds=t_ns // 1_000_000_000, nanos=t_ns % 1_000_000_000)


def heading_rotation(heading: float) -> Quaternion:
    """Return the rotation by ``heading`` [rad] about z."""
    return Quaternion(z=math.sin(0.5 * heading), w=math.cos(0.5 * heading))


def planar_pose(x: float, y: float, heading: float, z: float = 0.0) -> Pose:
    """Return a pose in the plane, lifted by ``z`` [m]."""
    return Pose(position=Vector3(x=x, y=y, z=z), orientation=heading_rotation(heading))


class Frames:
    """The frames of the car, of its front wheels and of its pose as odometry has it.

    All messages have one layout: numbers at fixed width, zeros included, so that many are a few array operations.
    ``room``: bytes left free in front of each.
    """

    SHIFTS = np.array([0, 7, 14, 21, 28], dtype=np.int64)
    CONTINUES = np.array([0x80, 0x80, 0x80, 0x80, 0x00], dtype=np.int64)
    MARK = 1.2345e300
    """Numbers that stand in the template where values go: this one, the next one, and so on."""
    TIME_MARK = 1 << 30
    """As a varint it takes five bytes, which any number of seconds and nanoseconds fits into."""

    def __init__(self, car: CarOutline, room: int = 0) -> None:
        message, marks = FrameTransforms(), iter(range(4 * 4))
        frames = ((WORLD, CAR), (WORLD, ODOMETRY), *((CAR, name) for name in FRONT_WHEELS))
        self._marks: list[float] = []
        for number, (parent, child) in enumerate(frames):
            part = message.transforms.add(parent_frame_id=parent, child_frame_id=child)
            part.timestamp.seconds = part.timestamp.nanos = self.TIME_MARK
            if number < 2:
                part.translation.x, part.translation.y = self._mark(next(marks)), self._mark(next(marks))
            else:
                part.translation.x, part.translation.y = car.wheels()[number]
            part.rotation.z, part.rotation.w = self._mark(next(marks)), self._mark(next(marks))
        template = bytes(room) + message.SerializeToString(deterministic=True)
        self._template = np.frombuffer(template, dtype=np.uint8)[None, :]
        self._numbers = [template.index(DOUBLE.pack(mark)) for mark in self._marks]
        varint = b"\x80\x80\x80\x80\x04"
        times = [match.start() for match in re.finditer(re.escape(varint), template)]
        self._times = times[::2], times[1::2]
        self._make_room(1)

    def _make_room(self, count: int) -> None:
        """Lay out the messages, and where seconds, nanoseconds and numbers are in them."""
        self._rows = np.repeat(self._template, count, axis=0)
        stride = self._rows.shape[1:]
        self._varints = [[self._rows[:, place : place + 5] for place in places] for places in self._times]
        self._values = [np.ndarray(count, np.float64, self._rows.data, place, stride) for place in self._numbers]

    def rows(self, t_ns: NDArray[np.int64], drawn: Array) -> NDArray[np.uint8]:
        """Return the messages at times [ns], one a row. The next call writes over them.

        ``drawn`` (n, 7): x, y and heading of the car, then by its odometry, and the angle of the front wheels.
        """
        count = len(t_ns)
        if count > len(self._rows):
            self._make_room(count)
        for places, values in zip(self._varints, np.divmod(t_ns, 1_000_000_000), strict=True):
            varint = values[:, None] >> self.SHIFTS & 0x7F | self.CONTINUES
            for place in places:
                place[:count] = varint
        half = 0.5 * drawn.T[[2, 5, 6]]
        sin, cos = np.sin(half), np.cos(half)
        x, y, odometry_x, odometry_y = drawn.T[[0, 1, 3, 4]]
        wheels = (sin[2], cos[2]) * len(FRONT_WHEELS)
        columns = (x, y, sin[0], cos[0], odometry_x, odometry_y, sin[1], cos[1], *wheels)
        for place, column in zip(self._values, columns, strict=True):
            place[:count] = column
        return self._rows[:count]

    def _mark(self, number: int) -> float:
        self._marks.append(self.MARK * (1.0 + number))
        return self._marks[-1]


class Surroundings(NamedTuple):
    """What stands around the car."""

    slot: Box | None
    obstacles: list[Box]
    kerbs: list[Kerb]
    target: tuple[float, float, float] | None

    @staticmethod
    def of(scenario: Scenario, vehicle: Mapping[str, float]) -> "Surroundings":
        """Return those of a scenario; ``vehicle``: flat parameters of the vehicle in it."""
        return Surroundings(
            None if scenario.slot is None else slot_box(scenario.slot),
            boxes(vehicle),
            kerbs(vehicle) + edges(scenario.obstacles),
            None if scenario.target is None else scenario.target.pose,
        )

    def changes_ns(self) -> list[int]:
        """Return the times at which an obstacle appears or disappears, and zero, sorted."""
        times = {round(t * 1e9) for box in self.obstacles for t in (box.appear_at, box.disappear_at) if t < 1e9}
        return sorted({0, *times})


def still_life(t_ns: int, car: CarOutline, stage: Surroundings) -> SceneUpdate:
    """Return everything that stands still in its own frame: car, wheels, slot, obstacles, kerbs, target outline."""
    update = SceneUpdate()
    _draw_car(update, t_ns, car)
    _draw_stage(update, t_ns, stage)
    if stage.target is not None:
        goal = _entity(update, t_ns, "target", WORLD)
        _line(goal, car.outline(), GREEN, 0.05, planar_pose(*stage.target))
    return update


def _draw_car(update: SceneUpdate, t_ns: int, car: CarOutline) -> None:
    body = _entity(update, t_ns, "car", CAR)
    length, middle = car.front + car.rear, 0.5 * (car.front - car.rear)
    body.cubes.add(
        pose=planar_pose(middle, 0.0, 0.0, 0.5 * CAR_HEIGHT + 0.15),
        size=Vector3(x=length, y=2.0 * car.half_width, z=CAR_HEIGHT),
        color=_color((*BODY[:3], 0.45)),
    )
    _line(body, car.outline(), BODY, 0.06)
    size = Vector3(x=2.0 * WHEEL_RADIUS, y=WHEEL_WIDTH, z=2.0 * WHEEL_RADIUS)
    for x, y in car.wheels()[:2]:
        body.cubes.add(pose=planar_pose(x, y, 0.0, WHEEL_RADIUS), size=size, color=_color(TYRE))
    for name in FRONT_WHEELS:
        wheel = _entity(update, t_ns, name, name)
        wheel.cubes.add(pose=planar_pose(0.0, 0.0, 0.0, WHEEL_RADIUS), size=size, color=_color(TYRE))
    ghost = _entity(update, t_ns, "odometry", ODOMETRY)
    _line(ghost, car.outline(), (*ORANGE[:3], 0.5), 0.03)


def _draw_stage(update: SceneUpdate, t_ns: int, stage: Surroundings) -> None:
    if stage.slot is not None:
        _line(_entity(update, t_ns, "slot", WORLD), stage.slot.outline(), GREY, 0.08)
    for number, kerb in enumerate(stage.kerbs, start=1):
        line = np.array([[kerb.x1, kerb.y1], [kerb.x2, kerb.y2]])
        _line(_entity(update, t_ns, f"kerb_{number}", WORLD), line, GREY, 0.1)
    for number, box in enumerate(stage.obstacles, start=1):
        if not box.appear_at * 1e9 <= t_ns < box.disappear_at * 1e9:
            update.deletions.add(timestamp=stamp(t_ns), id=f"obstacle_{number}")
            continue
        obstacle = _entity(update, t_ns, f"obstacle_{number}", WORLD)
        size = Vector3(x=box.length, y=box.width, z=CAR_HEIGHT)
        obstacle.cubes.add(pose=planar_pose(box.x, box.y, box.heading, 0.5 * CAR_HEIGHT), size=size, color=_color(GREY))


def path_update(t_ns: int, points: Array) -> SceneUpdate:
    """Return the planned path as a line; without points, its removal."""
    update = SceneUpdate()
    if len(points):
        _line(_entity(update, t_ns, "path", WORLD), points, ORANGE, 0.05)
    else:
        update.deletions.add(timestamp=stamp(t_ns), id="path")
    return update


def trail(t_ns: int, poses: list[bytes]) -> bytes:
    """Return the message that tells where the car has been; each pose as :func:`trail_poses` made it."""
    head = PosesInFrame(timestamp=stamp(t_ns), frame_id=WORLD)
    return head.SerializeToString(deterministic=True) + b"".join(poses)


def trail_poses(poses: Array) -> list[bytes]:
    """Return poses (n, 3) as parts of a trail: fields of a protobuf message may be written one after the other."""
    rows = np.repeat(TRAIL_TEMPLATE, len(poses), axis=0)
    x, y, heading = poses.T
    for place, values in zip(TRAIL_PLACES, (x, y, np.sin(0.5 * heading), np.cos(0.5 * heading)), strict=True):
        rows[:, place : place + 8] = values.reshape(-1, 1).view(np.uint8)
    return [row.tobytes() for row in rows]


def _trail_template(values: tuple[float, ...]) -> tuple[NDArray[np.uint8], tuple[int, ...]]:
    """Return a part of a trail as bytes (1, n), and where ``values`` are: x, y, and z and w of the rotation."""
    x, y, z, w = values
    pose = Pose(position=Vector3(x=x, y=y), orientation=Quaternion(z=z, w=w))
    template = PosesInFrame(poses=[pose]).SerializeToString(deterministic=True)
    places = tuple(template.index(DOUBLE.pack(value)) for value in values)
    return np.frombuffer(template, dtype=np.uint8)[None, :], places


TRAIL_TEMPLATE, TRAIL_PLACES = _trail_template((1.25, 2.25, 3.25, 4.25))


def _entity(update: SceneUpdate, t_ns: int, name: str, frame: str) -> SceneEntity:
    return update.entities.add(timestamp=stamp(t_ns), frame_id=frame, id=name, lifetime=Duration(), frame_locked=True)


def _line(
    entity: SceneEntity, points: Array, color: tuple[float, ...], thickness: float, at: Pose | None = None
) -> None:
    line = entity.lines.add(pose=at or planar_pose(0.0, 0.0, 0.0), thickness=thickness, color=_color(color))
    rows = np.repeat(LINE_TEMPLATE, len(points), axis=0)
    for place, values in zip(LINE_PLACES, np.asarray(points, dtype=np.float64).T, strict=True):
        rows[:, place : place + 8] = np.ascontiguousarray(values)[:, None].view(np.uint8)
    line.MergeFromString(rows.tobytes())


def _line_template(x: float, y: float) -> tuple[NDArray[np.uint8], tuple[int, int]]:
    """Return a point as a part of a line, as bytes (1, n), and the places of ``x`` and ``y``."""
    template = LinePrimitive(points=[Point3(x=x, y=y, z=LINE_HEIGHT)]).SerializeToString(deterministic=True)
    places = template.index(DOUBLE.pack(x)), template.index(DOUBLE.pack(y))
    return np.frombuffer(template, dtype=np.uint8)[None, :], places


LINE_HEIGHT = 0.02
"""Of lines on the ground [m]."""
LINE_TEMPLATE, LINE_PLACES = _line_template(1.25, 2.25)


def _color(rgba: tuple[float, ...]) -> Color:
    return Color(r=rgba[0], g=rgba[1], b=rgba[2], a=rgba[3])
