"""From a study's file to one line of numbers per run: grid points times samples, and a seed for each run.

The samples are the same at every grid point (common random numbers), so that a difference between
two points is the parameter's and not luck. The last grid key, then the sample, changes fastest.
"""

import itertools
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.special import ndtr, ndtri
from scipy.stats import qmc

from modelkit.variables import Variable
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.scenario.scenario import LONGEST_STEP, Scenario
from orchestrator.inputs.text.errors import BadInput, locate_errors
from orchestrator.inputs.text.quantities import number, scalar
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.sweep.fields import Field, find_field
from orchestrator.studies.sweep.study.design import Design
from orchestrator.studies.sweep.study.study_file import MOST_RUNS, Distribution, Range, Samples, StudyFile

MOST_NUMBERS = 500_000_000
"""4 GB."""


class _Column(NamedTuple):
    """Fields that share their values."""

    fields: list[Field]
    values: Array


def make_design(study: StudyFile, scenario: Scenario, file: Path | None = None) -> Design:
    """Return the design of ``study``, which stands in ``file``.

    Raises ``BadInput`` for an unknown key or a value out of range.
    """
    _check_size(study)
    grid = []
    for key, given in study.runs.grid.items():
        with locate_errors(file, f"runs.grid.{key}"):
            grid.append(_grid_column(key, given, scenario))
    sampled: list[_Column] = []
    count = 1
    for stream, kind in enumerate(("monte_carlo", "latin_hypercube")):
        samples = getattr(study.runs, kind)
        if samples is not None:
            count = samples.n
            chances = _chances(samples, kind == "latin_hypercube", [study.seed, stream])
            for (key, spread), column in zip(samples.spreads.items(), chances.T, strict=True):
                with locate_errors(file, f"runs.{kind}.{key}"):
                    sampled.append(_draw_column(key, spread, column, scenario))
    points = math.prod(len(column.values) for column in grid)
    columns = _cross_columns(grid, count) + [
        _Column(column.fields, np.tile(column.values, points)) for column in sampled
    ]
    fields = [field for column in columns for field in column.fields]
    twice = sorted({field.key for field in fields if [item.key for item in fields].count(field.key) > 1})
    if twice:
        raise BadInput("is varied twice", key=f"runs: {twice[0]}")
    lines = [column.values for column in columns for _ in column.fields]
    values = np.column_stack(lines) if lines else np.empty((points * count, 0))
    seeds = np.random.default_rng([study.seed, 2]).integers(1, 2**31 - 1, size=points * count)
    _check_times(fields, values, scenario)
    return Design(fields, np.ascontiguousarray(values), seeds)


def _check_size(study: StudyFile) -> None:
    """Raise ``BadInput`` if there are more runs, or numbers for them, than can be; before any is made."""
    runs = study.runs
    samples = [item for item in (runs.monte_carlo, runs.latin_hypercube) if item is not None]
    points = math.prod(item.steps if isinstance(item, Range) else len(item) for item in runs.grid.values())
    count = points * max((item.n for item in samples), default=1)
    numbers = count * (1 + len(runs.grid) + sum(len(item.spreads) for item in samples))
    if count > MOST_RUNS or numbers > MOST_NUMBERS:
        raise BadInput(f"{count} runs of {numbers} numbers, expected at most {MOST_RUNS} of {MOST_NUMBERS}", key="runs")


def _check_times(fields: list[Field], values: Array, scenario: Scenario) -> None:
    """Raise ``BadInput`` if a run would end before its first step, or an instance's own step is too long."""
    columns = {field.key: values[:, place] for place, field in enumerate(fields) if field.owner == "scenario"}
    steps, stops = columns.get("step", scenario.step), columns.get("stop_time", scenario.longest)
    if np.any(stops < steps):
        raise BadInput("a run has a stop_time under its step", key="runs")
    for owner in MODELS:
        if np.any(steps * columns.get(f"decimation.{owner}", scenario.decimation.get(owner, 1)) > LONGEST_STEP):
            raise BadInput(f"a run steps the {owner} by more than {LONGEST_STEP:g} s", key="runs")


def _cross_columns(grid: list[_Column], count: int) -> list[_Column]:
    points = np.array(list(itertools.product(*[column.values for column in grid])), dtype=np.float64)
    return [_Column(column.fields, np.repeat(points[:, place], count)) for place, column in enumerate(grid)]


def _grid_column(key: str, values: list[Any] | Range, scenario: Scenario) -> _Column:
    fields = _fields(key, scenario)
    first = fields[0].variable
    if isinstance(values, Range):
        unit = first.signal.unit
        ends = [number(end, unit, key=key) for end in (values.first, values.last)]
        raw: list[Any] = np.linspace(ends[0], ends[1], values.steps).tolist()
    else:
        raw = values
    if not raw:
        raise BadInput("an empty list of values", key=key)
    return _Column(fields, np.array([_check_value(item, fields) for item in raw]))


def _chances(samples: Samples, latin: bool, seed: list[int]) -> Array:
    """Return numbers (n, parameters) in [0, 1)."""
    rng, size = np.random.default_rng(seed), len(samples.spreads)
    if latin and size:
        return np.asarray(qmc.LatinHypercube(d=size, rng=rng).random(samples.n))
    return rng.random((samples.n, size))


def _draw_column(key: str, spread: Distribution, chances: Array, scenario: Scenario) -> _Column:
    fields = _fields(key, scenario)
    drawn = _quantiles(chances, spread, fields[0].variable, key)
    if spread.choice is None:
        drawn = np.round(drawn) if fields[0].variable.kind is int else drawn
        for end in (drawn.min(), drawn.max()):
            _check_value(float(end), fields)
    return _Column(fields, drawn)


def _quantiles(chances: Array, spread: Distribution, variable: Variable, key: str) -> Array:
    """Return the values of a distribution at ``chances`` in [0, 1)."""
    unit = variable.signal.unit
    if spread.choice is not None:
        values = np.array([float(scalar(item, variable._replace(name=key))) for item in spread.choice])
        return values[np.floor(chances * len(values)).astype(np.intp)]
    if variable.kind is bool:
        raise BadInput("true or false: expected choice", key=key)
    if spread.uniform is not None:
        low, high = (number(end, unit, key=key) for end in spread.uniform)
        if not low <= high:
            raise BadInput(f"uniform from {low:g} to {high:g}: expected the lower end first", key=key)
        return low + chances * (high - low)
    assert spread.normal is not None
    mean, sigma = (number(item, unit, key=key) for item in spread.normal)
    if not sigma > 0.0:
        raise BadInput(f"standard deviation {sigma:g}: expected more than 0", key=key)
    low, high = (ndtr((end - mean) / sigma) for end in (variable.signal.low, variable.signal.high))
    return np.asarray(mean + sigma * ndtri(low + (high - low) * np.clip(chances, 1e-16, None)))


def _fields(key: str, scenario: Scenario) -> list[Field]:
    return [find_field(name, scenario) for part in key.split(",") for name in _parameters_of_key(part.strip())]


def _parameters_of_key(key: str) -> list[str]:
    """Return what a key stands for: a parameter of the car belongs to both models."""
    return [f"{owner}.{key}" for owner in MODELS] if key.startswith("car.") else [key]


def _check_value(value: Any, fields: list[Field]) -> float:
    """Return a value that all of ``fields`` accept."""
    results = {float(scalar(value, field.variable._replace(name=field.key))) for field in fields}
    if len(results) != 1:
        raise BadInput(f"{value!r} means different numbers to {', '.join(field.key for field in fields)}")
    return results.pop()
