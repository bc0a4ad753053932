"""One car that parks: a Gymnasium environment."""

from typing import Any, Unpack

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded

from apa_cosim.gym.catalogue import scene_source
from apa_cosim.gym.episodes import Episodes, Results, take_step
from apa_cosim.gym.ids import Scenes
from apa_cosim.gym.options import GivenOptions, options_of
from apa_cosim.gym.recorded import RecordedEpisode
from apa_cosim.gym.spaces import (
    IS_SUCCESS,
    LARGEST_SEED,
    NUMBERS,
    OUTCOME,
    REASON,
    RENDER_MODES,
    SCENE_SEED,
    SHOWN_NUMBERS,
    Floats,
    action_space,
    check_render_mode,
    observation_space,
)
from fmus.policy_fmu import ACTION_PERIOD
from orchestrator.inputs.scenario.scenario import DONE
from orchestrator.inputs.text.errors import BadInput

ONE = np.zeros(1, dtype=np.int64)


class ParkingEnv(gymnasium.Env[Floats, Floats]):
    """Park a car with twelve ultrasonic sensors in a slot.

    **Observation** (24, scaled to about 1): pose in the target's frame, speed, steering wheel, twelve ranges, slot; see
    ``controller_fmu.policy.model``. **Action**: speed and steering wheel as shares of their limits, held for ``period``
    [s]; with ``pedals`` accelerator (negative: reverse), steering wheel, brake. **Reward**: see ``Reward``.
    **End**: terminated when the car stands parked, touches something or has left the place; truncated at
    ``stop_time``; ``info`` has the verdict: ``outcome``, ``reason``, ``is_success``, ``summary``. **Scene**: drawn from
    the seed; ``options={"scene_seed": n}`` of ``reset`` is one scene for ever.

    Further arguments: ``EnvironmentOptions``. Raises ``BadInput``.
    """

    metadata = {"render_modes": RENDER_MODES, "render_fps": 1.0 / ACTION_PERIOD}  # noqa: RUF012 - so in Gymnasium

    def __init__(
        self, scenes: Scenes = "parallel", render_mode: str | None = None, **options: Unpack[GivenOptions]
    ) -> None:
        check_render_mode(render_mode)
        given = options_of(options)
        self.render_mode = render_mode
        self.observation_space = observation_space()
        self.action_space = action_space(given.pedals)
        self._reward = given.reward
        self.episodes = Episodes(scene_source(scenes, given), 1, given.period)
        self.metadata = {**self.metadata, "render_fps": 1.0 / given.period}

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Floats, dict[str, Any]]:
        """Begin an episode; ``options``: ``scene_seed`` of its scene."""
        super().reset(seed=seed)
        chosen = (options or {}).get(SCENE_SEED)
        scene = int(self.np_random.integers(LARGEST_SEED)) if chosen is None else scene_seed(chosen)
        self.episodes.begin(ONE, np.array([scene]))
        return self.episodes.observations[0], {SCENE_SEED: scene}

    def step(self, action: Floats) -> tuple[Floats, float, bool, bool, dict[str, Any]]:
        """Act for a period. Raises ``ResetNeeded`` where no episode runs."""
        if self.episodes.is_reported[0]:
            raise ResetNeeded("no episode is running: call reset first")
        done = take_step(self.episodes, np.asarray(action, dtype=np.float64)[None], self._reward)
        info = {} if done.results is None else infos_of(done.results)[0]
        seen = self.episodes.observations[0]
        return seen, float(done.rewards[0]), bool(done.terminated[0]), bool(done.truncated[0]), info

    def render(self) -> Any:
        """Return the scene from above, (height, width, 3); None without ``render_mode``."""
        if self.render_mode is None:
            gymnasium.logger.warn("render() needs render_mode='rgb_array' of gymnasium.make")
            return None
        from apa_cosim.gym.rendering import picture

        return picture(self.episodes, 0)

    def episode(self, previous: bool = False) -> RecordedEpisode:
        """Return the episode so far, or the one before it, to be recorded: ``episode().run(log="run.mcap")``."""
        return self.episodes.record(0, previous)

    def close(self) -> None:
        """Free the memory of the car."""
        self.episodes.close()


def scene_seed(value: Any) -> int:
    """Return the seed of a scene. Raises ``BadInput``."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or not 0 <= value < LARGEST_SEED:
        raise BadInput(f"{value!r}: expected a whole number from 0 to {LARGEST_SEED - 1}", key=SCENE_SEED)
    return int(value)


def infos_of(results: Results) -> list[dict[str, Any]]:
    """Return the verdict of each episode that has ended, for ``info``."""
    return [
        {
            OUTCOME: outcome,
            REASON: reason,
            IS_SUCCESS: outcome in DONE,
            NUMBERS: {name: float(results.numbers[name][place]) for name in SHOWN_NUMBERS},
        }
        for place, (outcome, reason) in enumerate(zip(results.outcomes, results.reasons, strict=True))
    ]
