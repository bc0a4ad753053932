"""What makes the values of inputs from those of outputs, where they are not the same: gains, maps, frames."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from modelkit.variables import Variable
from orchestrator.inputs.scenario.wiring.system_text import PoseFrame
from orchestrator.simulation.cosim.fmu_instance import Array


class Affine:
    """Factor and offset for each signal; integers are rounded, booleans are whether it is not zero."""

    def __init__(self, gains: Sequence[float], offsets: Sequence[float], taken: Sequence[Variable]) -> None:
        self._gains = np.array(gains)
        self._offsets = np.array(offsets)
        self._whole = np.array([item.kind is int for item in taken])
        self._bits = np.array([item.kind is bool for item in taken])

    def __call__(self, values: Array) -> Array:
        """Return the values of the inputs."""
        made: Array = values * self._gains + self._offsets
        if self._whole.any():
            made[self._whole] = np.rint(np.nan_to_num(made[self._whole]))
        if self._bits.any():
            made[self._bits] = made[self._bits] != 0.0
        return made


class ValueMap:
    """A value of the input for each value of the signal, and one for all others."""

    def __init__(self, values: Mapping[float, float], otherwise: float) -> None:
        self._values = dict(values)
        self._otherwise = otherwise

    def __call__(self, values: Array) -> Array:
        """Return the values of the inputs."""
        return np.array([self._values.get(value, self._otherwise) for value in values.tolist()])


class PoseChange:
    """A pose of ours as another frame counts it, or the other way round; then units of each of the three numbers."""

    def __init__(self, frame: PoseFrame, is_into: bool, before: Affine, after: Affine) -> None:
        self._change = into if is_into else out_of
        self._frame = frame
        self._before, self._after = before, after

    def __call__(self, values: Array) -> Array:
        """Return x, y and heading of the inputs."""
        x, y, heading = self._before(values).tolist()
        return self._after(np.array(self._change(self._frame, x, y, heading)))


def into(frame: PoseFrame, x: float, y: float, heading: float) -> tuple[float, float, float]:
    """Return a pose of ours (rear axle [m, m, rad], ISO 8855) as ``frame`` counts it."""
    origin, side = frame.origin, 1.0 if frame.y == "left" else -1.0
    dx = x + frame.ahead * math.cos(heading) - origin.x
    dy = y + frame.ahead * math.sin(heading) - origin.y
    c, s = math.cos(origin.heading), math.sin(origin.heading)
    return c * dx + s * dy, side * (c * dy - s * dx), side * (heading - origin.heading)


def out_of(frame: PoseFrame, x: float, y: float, heading: float) -> tuple[float, float, float]:
    """Return a pose that ``frame`` counts as ours: the inverse of :func:`into`."""
    origin, side = frame.origin, 1.0 if frame.y == "left" else -1.0
    c, s = math.cos(origin.heading), math.sin(origin.heading)
    turned = side * heading + origin.heading
    back_x = origin.x + c * x - s * side * y - frame.ahead * math.cos(turned)
    back_y = origin.y + s * x + c * side * y - frame.ahead * math.sin(turned)
    return back_x, back_y, turned
