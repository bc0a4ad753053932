import numpy as np
import pytest

from orchestrator.sweep.design import make_design
from orchestrator.sweep.job import Chunk, make_job, study_scenario
from orchestrator.sweep.study import Study

RUNS = {
    "grid": {
        "controller.system": ["ntbpt", "ntbptcwpt"],
        "vehicle.driver.profile[1].speed": {"from": "2 km/h", "to": 2.0, "steps": 4},
        "vehicle.steering.rate_limit, controller.steering_wheel_rate": ["570 deg/s", "1995 deg/s"],
    },
    "latin_hypercube": {
        "n": 12,
        "vehicle.start.y": {"uniform": ["-10 cm", "10 cm"]},
        "vehicle.start.heading": {"normal": [0, "1 deg"]},
        "vehicle.driver.obeys_slow_down": {"choice": [True, False]},
        "stop_time": {"uniform": [8.0, 60.0]},
    },
}


@pytest.fixture
def bind():
    """A function from a study as data to (scenario, design, job, all its runs as one chunk)."""

    def bound(**content):
        study = Study(**{"name": "test", "scenario": "guo2015-case4", "runs": RUNS, **content})
        scenario = study_scenario(study)
        design = make_design(study, scenario)
        job = make_job(study, scenario, design.fields)
        return scenario, design, job, Chunk(0, 0, design.values, design.seeds)

    return bound


@pytest.fixture
def some():
    """A function from a count to a few row numbers, drawn at random."""

    def chosen(count, n=8, seed=20150101):
        return np.random.default_rng(seed).choice(count, size=min(n, count), replace=False).tolist()

    return chosen
