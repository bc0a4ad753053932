"""Many cars that park, each for itself: a Gymnasium vector environment that steps all in one call of machine code."""

from collections.abc import Sequence
from typing import Any, Unpack

import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.utils.seeding import np_random
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from apa_cosim.gym.catalogue import scene_source
from apa_cosim.gym.environment import infos_of, scene_seed
from apa_cosim.gym.episodes import Bools, Episodes, Integers, take_step
from apa_cosim.gym.ids import Scenes
from apa_cosim.gym.options import GivenOptions, options_of
from apa_cosim.gym.recorded import RecordedEpisode
from apa_cosim.gym.spaces import (
    LARGEST_SEED,
    RENDER_MODES,
    SCENE_SEED,
    Floats,
    action_space,
    check_render_mode,
    observation_space,
)
from orchestrator.inputs.text.errors import BadInput

Doubles = NDArray[np.float64]
SCENE_SEEDS, RESET_MASK = "scene_seeds", "reset_mask"
"""Options of ``reset``."""


class ParkingVectorEnv(VectorEnv[Floats, Floats, NDArray[Any]]):
    """``num_envs`` cars as :class:`ParkingEnv` has one; car ``i`` of seed ``s`` is that of seed ``s + i`` alone.

    ``autoreset_mode``: Gymnasium's ``NEXT_STEP``, ``SAME_STEP`` or ``DISABLED``, or their values. ``threads``: on which
    the cars are stepped; the bits do not depend on it. Raises ``BadInput``.
    """

    def __init__(
        self,
        num_envs: int = 1,
        scenes: Scenes = "parallel",
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int = 1,
        render_mode: str | None = None,
        **options: Unpack[GivenOptions],
    ) -> None:
        if num_envs < 1 or threads < 1:
            raise BadInput(f"{num_envs} cars on {threads} threads: expected 1 or more of each", key="num_envs")
        self._mode = AutoresetMode(autoreset_mode)
        check_render_mode(render_mode)
        given = options_of(options)
        self.num_envs, self.render_mode = num_envs, render_mode
        self.single_observation_space, self.single_action_space = observation_space(), action_space(given.pedals)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._reward = given.reward
        self.episodes = Episodes(scene_source(scenes, given), num_envs, given.period, threads)
        fps = 1.0 / given.period
        self.metadata = {"render_modes": RENDER_MODES, "render_fps": fps, "autoreset_mode": self._mode}
        self._random = [np_random()[0] for _ in range(num_envs)]

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Floats, dict[str, Any]]:
        """Begin an episode of each car; ``options``: ``reset_mask`` of the cars meant, ``scene_seeds`` of theirs."""
        given = options or {}
        mask = np.asarray(given.get(RESET_MASK, np.ones(self.num_envs, dtype=bool)))
        if mask.shape != (self.num_envs,) or mask.dtype != bool or not mask.any():
            raise BadInput(f"expected {self.num_envs} truth values, one of them true", key=RESET_MASK)
        which = np.flatnonzero(mask)
        self._seed(seed, which)
        chosen = given.get(SCENE_SEEDS)
        if chosen is not None and len(chosen) != len(which):
            raise BadInput(f"{len(chosen)} seeds for {len(which)} cars", key=SCENE_SEEDS)
        seeds = None if chosen is None else np.array([scene_seed(value) for value in chosen])
        self._begin(which, seeds)
        return self.episodes.observations, self._scene_seeds(which)

    def step(self, actions: Floats) -> tuple[Floats, Doubles, Bools, Bools, dict[str, Any]]:
        """Act for a period with all cars."""
        again = np.flatnonzero(self.episodes.is_reported)
        if len(again) and self._mode != AutoresetMode.NEXT_STEP:
            raise ResetNeeded(f"cars {again.tolist()[:5]} have no running episode: reset them first")
        if actions.shape != self.action_space.shape:
            raise BadInput(f"actions of shape {actions.shape}: expected {self.action_space.shape}")
        done = take_step(self.episodes, np.asarray(actions, dtype=np.float64), self._reward)
        ended = np.flatnonzero(done.terminated | done.truncated)
        infos: dict[str, Any] = {}
        last = self.episodes.observations
        for number, info in zip(ended.tolist(), [] if done.results is None else infos_of(done.results), strict=True):
            if self._mode == AutoresetMode.SAME_STEP:
                info = {"final_obs": last[number], "final_info": info}
            infos = self._add_info(infos, info, number)
        if self._mode == AutoresetMode.SAME_STEP:
            again = ended
        if len(again):
            self._begin(again)
            infos |= self._scene_seeds(again)
        return self.episodes.observations, done.rewards, done.terminated, done.truncated, infos

    def render(self) -> Any:
        """Return the scene of each car from above; None without ``render_mode``."""
        if self.render_mode is None:
            return None
        from apa_cosim.gym.rendering import picture

        return tuple(picture(self.episodes, number) for number in range(self.num_envs))

    def episode(self, number: int, previous: bool = False) -> RecordedEpisode:
        """Return an episode of a car, as :meth:`ParkingEnv.episode`."""
        return self.episodes.record(number, previous)

    def close_extras(self, **kwargs: Any) -> None:
        """Free the memory of the cars."""
        self.episodes.close()

    def _seed(self, seed: int | Sequence[int | None] | None, which: Integers) -> None:
        seeds = (
            [None if seed is None else seed + number for number in range(self.num_envs)]
            if (seed is None or isinstance(seed, (int, np.integer)))
            else list(seed)
        )
        if len(seeds) != self.num_envs:
            raise BadInput(f"{len(seeds)} seeds for {self.num_envs} cars", key="seed")
        for number in which.tolist():
            if seeds[number] is not None:
                self._random[number], _ = np_random(int(seeds[number]))

    def _begin(self, which: Integers, seeds: Integers | None = None) -> None:
        if seeds is None:
            seeds = np.array([self._random[number].integers(LARGEST_SEED) for number in which.tolist()])
        self.episodes.begin(which, seeds)

    def _scene_seeds(self, which: Integers) -> dict[str, Any]:
        mask = np.zeros(self.num_envs, dtype=bool)
        mask[which] = True
        return {SCENE_SEED: np.where(mask, self.episodes.seeds, 0), f"_{SCENE_SEED}": mask}
