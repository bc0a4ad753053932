"""What the overview picture of a run shows, in plain numbers that go to another process."""

from typing import NamedTuple

import numpy as np

from orchestrator.evaluation.verdict.geometry import Box, CarOutline, Kerb
from orchestrator.simulation.cosim.fmu_instance import Array


class Ribbon(NamedTuple):
    """A mode over time, the first of some that changes."""

    values: Array
    states: dict[int, str]
    """Value -> name of a state."""


class Standing(NamedTuple):
    """What stands around, and where the car should go."""

    boxes: list[Box]
    polygons: list[list[tuple[float, float]]]
    kerbs: list[Kerb]
    slot: Box | None
    target: tuple[float, float, float] | None


class Overview(NamedTuple):
    """A run as the picture has it; lengths in m, angles in rad, times in s."""

    title: str
    t: Array
    signals: dict[str, Array]
    """Those that are drawn, by the names of the recording."""
    changes: list[int]
    """Rows at which the phase changes."""
    ribbon: Ribbon
    car: CarOutline
    around: Standing
    planned: Array
    """The last path that was planned, (n, 2)."""
    points: dict[str, tuple[float, float]]
    """Points that the controller had in mind, by name."""

    def signal(self, name: str) -> Array:
        """Return a signal; not-a-number all along if the run has none of that name."""
        return self.signals.get(name, np.full(len(self.t), np.nan))
