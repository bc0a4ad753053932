"""Arguments of the environments beside their scenes."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypedDict

from apa_cosim.gym.ids import Body
from fmus.policy_fmu import ACTION_PERIOD
from orchestrator.inputs.text.errors import BadInput, suggestion_or_choices


class Reward(NamedTuple):
    """What an environment rewards: progress towards the target, and the verdict of the episode."""

    progress: float = 1.0
    """For each metre that the cost to go has fallen."""
    time: float = -0.05
    """For each second."""
    parked: float = 20.0
    """An episode that ends parked."""
    contact: float = -20.0
    """One that ends in contact."""
    otherwise: float = -10.0
    """One that ends in another way before its stop time."""


class EnvironmentOptions(NamedTuple):
    """Arguments of an environment, complete."""

    body: Body | None = None
    """Equations of motion; None: double-track, in apa/World-v0 as drawn."""
    period: float = ACTION_PERIOD
    """Between two actions [s], a whole number of communication steps."""
    stop_time: float | None = None
    """When an episode is truncated [s]; None: that of the environment."""
    pedals: bool = False
    """Actions are accelerator (negative: reverse), steering wheel and brake; else speed and steering wheel."""
    reward: Reward = Reward()
    files: Sequence[str | Path] = ()
    """apa/TPCAP-v0, apa/ParkBench-v0: their cases, or folders of them."""


class GivenOptions(TypedDict, total=False):
    """Arguments of an environment as they are given: see ``EnvironmentOptions``."""

    body: Body | None
    period: float
    stop_time: float | None
    pedals: bool
    reward: Reward
    files: Sequence[str | Path]


def options_of(given: Any) -> EnvironmentOptions:
    """Return the arguments, complete. Raises ``BadInput`` for one that does not exist."""
    for key in given:
        if key not in EnvironmentOptions._fields:
            raise BadInput(f"no such argument{suggestion_or_choices(key, list(EnvironmentOptions._fields))}", key=key)
    return EnvironmentOptions(**given)
