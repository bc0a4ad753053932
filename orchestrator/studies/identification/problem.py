"""Residuals of the model against a measured drive, and their derivatives by the parameters."""

from collections.abc import Mapping, Sequence

import numpy as np

from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.identification.compiled_vehicle import OUTPUTS, PARAMETERS, CompiledVehicle
from orchestrator.studies.identification.frames import FrameFit, Simulated, window_count
from orchestrator.studies.identification.parameter import FitParameter
from orchestrator.studies.identification.playback import Playback
from orchestrator.studies.identification.signals import FRAMES, MeasuredDrive

DIFFERENCE_STEP = 0.25
"""Step of the differences, in useful accuracies: a lag below the internal step of the model has no effect."""


class Problem:
    """A drive, a model, and the parameters to identify (``theta``)."""

    def __init__(
        self,
        vehicle: CompiledVehicle,
        drive: MeasuredDrive,
        candidates: Sequence[FitParameter],
        known: Mapping[str, float],
    ) -> None:
        self.vehicle, self.drive, self.candidates = vehicle, drive, list(candidates)
        self.playback = Playback(drive)
        self.known = {name: float(item.start) for name, item in PARAMETERS.items()} | dict(known)
        if "odometry" in drive.frames or "measured_speed" in drive.compared:
            self.known["odometry.ideal"] = 0.0
        self.window_count = window_count(drive.duration)
        edges = np.linspace(0.0, drive.duration, self.window_count + 1)[1:-1]
        windows = {name: np.searchsorted(edges, item.t, side="right") for name, item in drive.compared.items()}
        self.windows = np.concatenate(list(windows.values()))
        """Window of each residual, in the order of :meth:`residual_vector`."""
        self._fits = {name: FrameFit(name, drive, windows, self.window_count) for name in drive.frames}
        self._last: tuple[tuple[float, ...], Simulated] | None = None

    def parameters(self, theta: Array) -> dict[str, float]:
        """Return all parameters of the model."""
        named = {item.name: float(value) for item, value in zip(self.candidates, theta, strict=True)}
        return {**self.known, **named}

    def simulation(self, theta: Array) -> Simulated:
        """Return the drive of the model with these parameters."""
        key = tuple(float(value) for value in theta)
        if self._last is None or self._last[0] != key:
            self._last = key, self._simulate(theta)
        return self._last[1]

    def _simulate(self, theta: Array) -> Simulated:
        parameters = self.parameters(theta)
        inputs = self.playback.inputs(parameters)
        rows = self.vehicle.outputs({**parameters, **self.playback.parameter_overrides}, inputs)
        t_ns = inputs.t_ns - self.playback.lead_ns
        first = int(np.searchsorted(t_ns, 0))
        return Simulated(t_ns[first:] / 1e9, rows[first:])

    def outputs(self, theta: Array, noise: Mapping[str, float]) -> dict[str, Array]:
        """Return the outputs that are compared, in the frames of the log, at the times of its samples."""
        drive = self.simulation(theta)
        found: dict[str, Array] = {}
        for frame, fit in self._fits.items():
            found |= fit.place(drive, tuple(OUTPUTS[name] for name in FRAMES[frame]), noise)
        for name, item in self.drive.compared.items():
            if name not in found:
                found[name] = np.interp(item.t, drive.t, drive.rows[:, OUTPUTS[name]])
        return {name: found[name] for name in self.drive.compared}

    def residuals(self, theta: Array, noise: Mapping[str, float]) -> dict[str, Array]:
        """Return model minus measurement of each compared signal, at the times of its samples [SI]."""
        return {name: values - self.drive.compared[name].values for name, values in self.outputs(theta, noise).items()}

    def residual_vector(self, theta: Array, noise: Mapping[str, float]) -> Array:
        """Return all residuals over their standard deviations."""
        return np.concatenate([values / noise[name] for name, values in self.residuals(theta, noise).items()])

    def jacobian(self, theta: Array, noise: Mapping[str, float]) -> Array:
        """Return the derivatives of :meth:`residual_vector` by central differences, one-sided at a bound."""
        columns = []
        for number, item in enumerate(self.candidates):
            low, high = theta.copy(), theta.copy()
            step = DIFFERENCE_STEP * item.accuracy
            low[number] = max(theta[number] - step, item.bounds[0])
            high[number] = min(theta[number] + step, item.bounds[1])
            change = self.residual_vector(high, noise) - self.residual_vector(low, noise)
            columns.append(change / (high[number] - low[number]))
        return np.column_stack(columns)
