"""Runs of which only a few numbers are kept, as compiled code where that is possible."""

from collections.abc import Iterable, Sequence
from importlib.util import find_spec

import numpy as np

from modelkit.variables import flatten, with_values
from orchestrator.models import MODELS
from orchestrator.scenario import Scenario
from orchestrator.slave import Array
from orchestrator.sweep.batch import compiled
from orchestrator.sweep.kept import FIRST_KEPT, Kept


def parameters_of(scenario: Scenario) -> list[float]:
    """Return the parameters of all models of a scenario, one after the other, as doubles."""
    numbers: list[float] = []
    for owner, model in MODELS.items():
        values = flatten(with_values(model.params, dict(getattr(scenario, owner))))
        numbers += [float(value) for value in values]
    return numbers


def measure(scenarios: Iterable[Scenario], kept: Sequence[Kept]) -> Array:
    """Return one row of ``kept`` numbers per scenario. Compiles the models first if sources changed."""
    runs = list(scenarios)
    rows = compiled(tuple(kept))
    parameters = np.array([parameters_of(run) for run in runs])
    times = np.array([[run.step_ns, run.stop_ns, *(run.every.get(name, 1) for name in MODELS)] for run in runs])
    out = np.empty((len(runs), FIRST_KEPT + len(kept)))
    rows(parameters, times.astype(np.int64), out)
    return out[:, FIRST_KEPT:]


def available() -> bool:
    """Return whether models can be compiled here."""
    return all(find_spec(name) is not None for name in ("llvmlite", "numba", "ziglang"))
