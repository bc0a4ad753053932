"""Observation and action spaces, and what is common to an environment of one car and of many."""

from typing import Any

import numpy as np
from gymnasium.spaces import Box, Space
from numpy.typing import NDArray

from controller_fmu.policy.model import OBSERVATION_LIMIT
from controller_fmu.policy.signals import OBSERVATION_COUNT
from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.fmu_instance import Array

Floats = NDArray[np.float32]
LARGEST_SEED = 2**31 - 1
"""Seeds of scenes are smaller."""
SCENE_SEED = "scene_seed"
OUTCOME, REASON, IS_SUCCESS, NUMBERS = "outcome", "reason", "is_success", "summary"
"""Keys of ``info`` at the end of an episode: as in ``summary.json``."""
SHOWN_NUMBERS = (
    *("duration", "manoeuvres", "min_clearance", "steering_travel"),
    *("final.longitudinal_error", "final.lateral_error", "final.heading_error", "final.outline_margin"),
)
RENDER_MODES = ["rgb_array"]


def check_render_mode(mode: str | None) -> None:
    """Raise ``BadInput`` for a way of rendering that does not exist."""
    if mode not in (None, *RENDER_MODES):
        raise BadInput(f"{mode!r}: expected {', '.join(RENDER_MODES)}", key="render_mode")


def observation_space() -> "Space[Floats]":
    """Return the space of one car's observations: see ``controller_fmu.policy.model``."""
    return _box(np.full(OBSERVATION_COUNT, -OBSERVATION_LIMIT), np.full(OBSERVATION_COUNT, OBSERVATION_LIMIT))


def action_space(pedals: bool) -> "Space[Floats]":
    """Return the space of one car's actions: speed, wheel; or accelerator (negative: reverse), wheel, brake."""
    low = [-1.0, -1.0, 0.0] if pedals else [-1.0, -1.0]
    return _box(np.array(low), np.ones(len(low)))


def _box(low: Array, high: Array) -> "Space[Floats]":
    box: Any = Box(low.astype(np.float32), high.astype(np.float32), dtype=np.float32)
    space: Space[Floats] = box
    return space
