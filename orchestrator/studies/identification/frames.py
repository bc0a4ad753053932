"""Poses of the model in the frame of the log: shift and turn of each window, by weighted least squares.

What the model lacks, and the noise of what it follows, adds up along a drive like a random walk: the pose at its end
would outweigh all else. Within a window it is small. The frames of the windows also stand for the origin of the log.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.identification.signals import FRAMES, MeasuredDrive

WINDOW_TIME, MIN_WINDOWS, MAX_WINDOWS = 4.0, 6, 40
"""Length of a window [s], as far as there are so many."""
GAUSS_NEWTON_STEPS = 2
"""Of Gauss-Newton: only the turn is not linear, and it begins close."""


class Simulated(NamedTuple):
    """A drive of the model."""

    t: Array
    """Times of the log [s] (n)."""
    rows: Array
    """All outputs (n, outputs)."""


def window_count(duration: float) -> int:
    """Return into how many windows a drive of ``duration`` [s] is divided."""
    return int(np.clip(duration / WINDOW_TIME, MIN_WINDOWS, MAX_WINDOWS))


class FrameFit:
    """Fits one pose of the model to that of the log."""

    def __init__(self, frame: str, drive: MeasuredDrive, windows: Mapping[str, np.ndarray], count: int) -> None:
        self.names = FRAMES[frame]
        self._count = count
        self._windows = {name: windows[name] for name in self.names if name in windows}
        self._measured = {name: drive.compared[name].values for name in self._windows}
        self._t = {name: drive.compared[name].t for name in self._windows}

    def place(self, drive: Simulated, columns: tuple[int, ...], noise: Mapping[str, float]) -> dict[str, Array]:
        """Return the pose of the model at the samples of the log, window by window moved to it.

        ``columns``: where x, y and heading are in the outputs.
        """
        poses = {
            name: [np.interp(t, drive.t, drive.rows[:, column]) for column in columns] for name, t in self._t.items()
        }
        frames = np.zeros((self._count, 3))
        frames[:, 2] = self._first_turn(poses)
        for _ in range(GAUSS_NEWTON_STEPS):
            frames += self._step(poses, frames, noise)
        return {name: _move(poses[name], frames[self._windows[name]])[self.names.index(name)] for name in poses}

    def _first_turn(self, poses: Mapping[str, list[Array]]) -> Array:
        """Return the turn of each window [rad]: the mean of headings, else between the directions of the drives."""
        heading = self.names[2]
        if heading in poses:
            windows = self._windows[heading]
            turns = self._measured[heading] - poses[heading][2]
            counts = np.bincount(windows, minlength=self._count)
            mean: Array = np.bincount(windows, turns, self._count) / np.maximum(counts, 1)
            return np.where(counts > 0, mean, turns.mean())
        if len(poses) < 2:
            return np.zeros(self._count)
        x_name, y_name = self.names[:2]
        x, y = self._measured[x_name], np.interp(self._t[x_name], self._t[y_name], self._measured[y_name])
        ours_x, ours_y = poses[x_name][:2]
        far = int(np.argmax((x - x[0]) ** 2 + (y - y[0]) ** 2))
        course = math.atan2(y[far] - y[0], x[far] - x[0])
        return np.full(self._count, course - math.atan2(ours_y[far] - ours_y[0], ours_x[far] - ours_x[0]))

    def _step(self, poses: Mapping[str, list[Array]], frames: Array, noise: Mapping[str, float]) -> Array:
        """Return the change of all frames by one step of Gauss-Newton."""
        matrix, vector = np.zeros((self._count, 3, 3)), np.zeros((self._count, 3))
        for name, pose in poses.items():
            axis, windows, weight = self.names.index(name), self._windows[name], 1.0 / noise[name] ** 2
            x, y, turn = pose[0], pose[1], frames[windows, 2]
            levers = (-np.sin(turn) * x - np.cos(turn) * y, np.cos(turn) * x - np.sin(turn) * y, np.ones(len(x)))
            parts = {2: levers[axis]} if axis == 2 else {axis: np.ones(len(x)), 2: levers[axis]}
            error = self._measured[name] - _move(pose, frames[windows])[axis]
            for row, first in parts.items():
                vector[:, row] += weight * np.bincount(windows, first * error, self._count)
                for column, second in parts.items():
                    matrix[:, row, column] += weight * np.bincount(windows, first * second, self._count)
        scale = 1.0 / np.sqrt(np.maximum(np.einsum("kii->ki", matrix), 1e-30))
        scaled = matrix * scale[:, :, None] * scale[:, None, :]
        change: Array = scale * np.einsum("kij,kj->ki", np.linalg.pinv(scaled, 1e-9, hermitian=True), scale * vector)
        return change


def _move(pose: list[Array], frame: Array) -> tuple[Array, Array, Array]:
    x, y, heading = pose
    cos, sin = np.cos(frame[:, 2]), np.sin(frame[:, 2])
    return cos * x - sin * y + frame[:, 0], sin * x + cos * y + frame[:, 1], heading + frame[:, 2]
