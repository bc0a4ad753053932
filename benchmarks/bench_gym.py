"""Steps of the Gymnasium environments a second on one core, beside highway-env's parking in the same run.

A step is 0.2 s of a car with double-track body and twelve sensors; highway-env's is 0.2 s of a kinematic car. By
processor time, random actions, resets included.
"""

import importlib.util
import time
import warnings
from collections.abc import Callable

import gymnasium
import numpy as np

from apa_cosim.gym import IDS
from apa_cosim.gym.catalogue import FILE_IDS
from benchmarks.results import record, size

STEPS = size(20_000, 20)
CARS = (1, 1024)
NAMES = tuple(name for name in IDS if name not in FILE_IDS)


def main() -> None:
    """Print what was measured."""
    for name in NAMES:
        for cars in CARS:
            rate = _vector_rate(name, cars)
            print(f"{name}, {cars} cars: {rate:,.0f} steps/s")
            record(f"{name}, {cars} cars, double track, 12 sensors, processor time", rate, "1/s")
    if importlib.util.find_spec("highway_env") is None:
        print("highway-env is not installed: nothing to compare with (pip install highway-env)")
        return
    rate = _highway_rate()
    print(f"highway-env parking-v0: {rate:,.0f} steps/s")
    record("highway-env parking-v0, kinematic, processor time", rate, "1/s")


def _vector_rate(name: str, cars: int) -> float:
    env = gymnasium.make_vec(name, num_envs=cars, body="double_track")
    env.reset(seed=1)
    count = max(STEPS // cars, 2)
    actions = np.random.default_rng(1).uniform(-1.0, 1.0, (count, cars, 2)).astype(np.float32)
    rate = _rate(lambda number: env.step(actions[number]), count) * cars
    env.close()
    return rate


def _highway_rate() -> float:
    warnings.simplefilter("ignore")
    importlib.import_module("highway_env")
    env = gymnasium.make("parking-v0")
    env.reset(seed=1)
    count = max(STEPS // 20, 2)
    actions = np.random.default_rng(1).uniform(-1.0, 1.0, (count, 2)).astype(np.float32)

    def act(number: int) -> None:
        *_, ended, cut, _ = env.step(actions[number])
        if ended or cut:
            env.reset()

    return _rate(act, count)


def _rate(act: Callable[[int], object], count: int) -> float:
    act(0)
    begun = time.process_time()
    for number in range(count):
        act(number)
    return count / (time.process_time() - begun)


if __name__ == "__main__":
    main()
