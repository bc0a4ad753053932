"""Poses by flat name, and a pose as it is seen in the frame of another."""

import math
from collections.abc import Mapping


def pose_of(values: Mapping[str, float], prefix: str) -> tuple[float, float, float] | None:
    """Return the pose called ``prefix`` among flat values, or None if it is not there."""
    names = [f"{prefix}.{axis}" for axis in ("x", "y", "heading")]
    if not all(name in values for name in names):
        return None
    x, y, heading = (values[name] for name in names)
    return x, y, heading


def pose_at(values: Mapping[str, float], prefix: str) -> tuple[float, float, float]:
    """Return the pose called ``prefix`` among flat values, zeros for what lacks."""
    x, y, heading = (values.get(f"{prefix}.{axis}", 0.0) for axis in ("x", "y", "heading"))
    return x, y, heading


def in_frame(x: float, y: float, heading: float, frame: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return (longitudinal [m], lateral [m], heading [rad, wrapped]) of a pose in the frame of another."""
    dx, dy = x - frame[0], y - frame[1]
    c, s = math.cos(frame[2]), math.sin(frame[2])
    turn = heading - frame[2]
    return c * dx + s * dy, c * dy - s * dx, math.atan2(math.sin(turn), math.cos(turn))
