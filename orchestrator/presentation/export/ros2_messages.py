"""Messages of ROS 2, as rosbags builds them from the definitions it carries."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from orchestrator.presentation.drawing.scene import CAR, ODOMETRY, WORLD

FRAMES = {WORLD: "map", CAR: "base_link", ODOMETRY: "odometry"}
"""Frame of the log -> its usual name in ROS; the others keep theirs."""
CUBE, LINE_STRIP, ADD, DELETE = 1, 4, 0, 2
"""Types and actions of visualization_msgs/Marker."""


class MessageFactory:
    """Builds and serialises messages. Raises ``ImportError`` if rosbags is not installed."""

    def __init__(self) -> None:
        from rosbags.typesys import Stores, get_typestore

        self.store: Any = get_typestore(Stores.ROS2_HUMBLE)

    def serialize(self, message: Any, kind: str) -> Any:
        """Return the bytes of a message; ``kind`` as ``sensor_msgs/Range``."""
        return self.store.serialize_cdr(message, type_name(kind))

    def message(self, kind: str, **fields: Any) -> Any:
        """Return a message."""
        return self.store.types[type_name(kind)](**fields)

    def time(self, t_ns: int) -> Any:
        """Return a time [ns] as ROS has it."""
        seconds, rest = divmod(t_ns, 1_000_000_000)
        return self.message("builtin_interfaces/Time", sec=seconds, nanosec=rest)

    def header(self, t_ns: int, frame: str) -> Any:
        """Return the head of a message in a ``frame``."""
        return self.message("std_msgs/Header", stamp=self.time(t_ns), frame_id=FRAMES.get(frame, frame))

    def turn(self, heading: float) -> Any:
        """Return the rotation by ``heading`` [rad] about z."""
        z, w = math.sin(0.5 * heading), math.cos(0.5 * heading)
        return self.message("geometry_msgs/Quaternion", x=0.0, y=0.0, z=z, w=w)

    def pose(self, x: float, y: float, heading: float) -> Any:
        """Return a pose in the plane."""
        point = self.message("geometry_msgs/Point", x=x, y=y, z=0.0)
        return self.message("geometry_msgs/Pose", position=point, orientation=self.turn(heading))

    def _same_pose(self, pose: Any) -> Any:
        point = self.message("geometry_msgs/Point", x=pose.position.x, y=pose.position.y, z=pose.position.z)
        turn = {axis: getattr(pose.orientation, axis) for axis in "xyzw"}
        return self.message(
            "geometry_msgs/Pose", position=point, orientation=self.message("geometry_msgs/Quaternion", **turn)
        )

    def transform(self, t_ns: int, frames: tuple[str, str], place: tuple[float, float, float]) -> Any:
        """Return the transform from a parent to a child frame; ``place``: x [m], y [m], heading [rad]."""
        parent, child = frames
        x, y, heading = place
        shift = self.message("geometry_msgs/Vector3", x=x, y=y, z=0.0)
        return self.message(
            "geometry_msgs/TransformStamped",
            header=self.header(t_ns, parent),
            child_frame_id=FRAMES.get(child, child),
            transform=self.message("geometry_msgs/Transform", translation=shift, rotation=self.turn(heading)),
        )

    def color(self, color: tuple[float, ...]) -> Any:
        """Return a colour: red, green, blue, opacity from 0 to 1."""
        return self.message("std_msgs/ColorRGBA", **dict(zip("rgba", color, strict=True)))

    def markers(self, t_ns: int, update: Any) -> Iterator[Any]:
        """Yield the shapes of a scene as markers."""
        for entity in update.entities:
            for number, cube in enumerate(entity.cubes):
                size = (cube.size.x, cube.size.y, cube.size.z)
                yield self._marker(t_ns, entity, number, CUBE, (cube, size, []))
            for number, line in enumerate(entity.lines, start=len(entity.cubes)):
                yield self._marker(t_ns, entity, number, LINE_STRIP, (line, (line.thickness, 0.0, 0.0), line.points))
        for entity in update.deletions:
            yield self._marker(t_ns, entity, 0, CUBE, None)

    def _marker(self, t_ns: int, entity: Any, number: int, kind: int, shape: Any) -> Any:
        """Return a marker; without a ``shape`` (what is drawn, its size, its points), the removal of one."""
        drawn, size, points = shape or (None, (0.0, 0.0, 0.0), [])
        color = (drawn.color.r, drawn.color.g, drawn.color.b, drawn.color.a) if drawn else (0.0,) * 4
        time = self.message("builtin_interfaces/Time", sec=0, nanosec=0)
        return self.message(
            "visualization_msgs/Marker",
            header=self.header(t_ns, entity.frame_id if drawn else WORLD),
            ns=entity.id,
            id=number,
            type=kind,
            action=ADD if drawn else DELETE,
            pose=self._same_pose(drawn.pose) if drawn else self.pose(0.0, 0.0, 0.0),
            scale=self.message("geometry_msgs/Vector3", **dict(zip("xyz", size, strict=True))),
            color=self.color(color),
            lifetime=self.message("builtin_interfaces/Duration", sec=0, nanosec=0),
            frame_locked=True,
            points=[self.message("geometry_msgs/Point", x=item.x, y=item.y, z=item.z) for item in points],
            colors=[],
            texture_resource="",
            texture=self.message(
                "sensor_msgs/CompressedImage",
                header=self.message("std_msgs/Header", stamp=time, frame_id=""),
                format="",
                data=np.empty(0, dtype=np.uint8),
            ),
            uv_coordinates=[],
            text="",
            mesh_resource="",
            mesh_file=self.message("visualization_msgs/MeshFile", filename="", data=np.empty(0, dtype=np.uint8)),
            mesh_use_embedded_materials=False,
        )


def type_name(kind: str) -> str:
    """Return the full name of a type: ``sensor_msgs/msg/Range``."""
    return kind.replace("/", "/msg/")
