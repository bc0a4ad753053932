from typing import Any

import numpy as np
import pytest

from orchestrator.studies.sweep.job import Chunk, make_job
from orchestrator.studies.sweep.study.read_study import bind as bind_file
from orchestrator.studies.sweep.study.study_file import StudyFile

RUNS = {
    "grid": {
        "controller.system": ["ntbpt", "ntbptcwpt"],
        "vehicle.driver.profile[1].speed": {"from": "2 km/h", "to": 2.0, "steps": 4},
        "car.steering.rate_limit": ["570 deg/s", "1995 deg/s"],
    },
    "latin_hypercube": {
        "n": 12,
        "vehicle.start.y": {"uniform": ["-10 cm", "10 cm"]},
        "vehicle.start.heading": {"normal": [0, "1 deg"]},
        "vehicle.driver.complies_with_slow_down": {"choice": [True, False]},
        "stop_time": {"uniform": [8.0, 60.0]},
    },
}


@pytest.fixture
def bind() -> Any:
    """A function from a study as data to (scenario, design, job, all its runs as one chunk)."""

    def bound(**content: Any) -> Any:
        study = bind_file(StudyFile(**{"name": "test", "scenario": "guo2015-case4", "runs": RUNS, **content}))
        return study.scenario, study.design, make_job(study), Chunk(0, 0, study.design.values, study.design.seeds)

    return bound


@pytest.fixture
def some() -> Any:
    """A function from a count to a few row numbers, drawn at random."""

    def chosen(count: Any, n: Any = 8, seed: Any = 20150101) -> Any:
        return np.random.default_rng(seed).choice(count, size=min(n, count), replace=False).tolist()

    return chosen
