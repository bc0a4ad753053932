"""Gymnasium environments: a car with twelve ultrasonic sensors parks, judged as every run of this project.

    import gymnasium, apa_cosim.gym

    env = gymnasium.make("apa/Parallel-v0")
    cars = gymnasium.make_vec("apa/World-v0", num_envs=1024)

Importing this registers the environments. Needs the extra ``gym``.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

import gymnasium

from apa_cosim.gym.ids import IDS

if TYPE_CHECKING:
    from apa_cosim.gym.environment import ParkingEnv
    from apa_cosim.gym.options import Reward
    from apa_cosim.gym.recorded import RecordedEpisode
    from apa_cosim.gym.vector import ParkingVectorEnv

__all__ = ["IDS", "ParkingEnv", "ParkingVectorEnv", "RecordedEpisode", "Reward"]

_HOMES = {
    "ParkingEnv": "apa_cosim.gym.environment",
    "ParkingVectorEnv": "apa_cosim.gym.vector",
    "RecordedEpisode": "apa_cosim.gym.recorded",
    "Reward": "apa_cosim.gym.options",
}


def __getattr__(name: str) -> Any:
    """Return a name of ``__all__`` from its module."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


for _id, _scenes in IDS.items():
    if _id not in gymnasium.registry:
        gymnasium.register(
            _id,
            entry_point="apa_cosim.gym.environment:ParkingEnv",
            vector_entry_point="apa_cosim.gym.vector:ParkingVectorEnv",
            kwargs={"scenes": _scenes},
        )
