"""The runs of a chunk, in one of two ways that give the same bits.

The compiled batch: every run is one call of machine code, on threads, on all cores; no FMU, no log. Or one by one
through the Python master, on FMUs or on the models in process.
"""

import threading
from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from fmus.compiled_batch import Disturbed, Ending, Kept, Rows, When, compiled_rows
from modelkit.model import Model
from orchestrator.cosim.slave import Array
from orchestrator.scenario.end_condition import SPEED
from orchestrator.scenario.scenario import Scenario
from orchestrator.session.session import run_scenario
from orchestrator.sweep.disturbed import fault_numbers, heard
from orchestrator.sweep.job import Chunk, Job, arrays, chunk_scenario
from orchestrator.sweep.rows import FIRST_MEASURE, row_of
from orchestrator.text.errors import RESOURCES, NotRunError
from orchestrator.text.failures import reason_of
from orchestrator.verdict.measures import Measure

_compiling = threading.Lock()


def run_batch(job: Job, chunk: Chunk) -> Array:
    """Return one row of measures per run of ``chunk``."""
    scenario = Scenario(**job.scenario)
    rows = compiled(tuple(job.measures), scenario)
    parameters, times = arrays(job, chunk)
    out = np.empty((len(parameters), FIRST_MEASURE + len(job.measures)))
    rows(parameters, times, fault_numbers(job, chunk, scenario), out)
    return out


def run_recorded(job: Job, chunk: Chunk, kind: str, files: Mapping[str, str] | None) -> Array:
    """Return one row of measures per run of ``chunk``, read off its recording."""
    paths = None if files is None else {name: Path(path) for name, path in files.items()}

    def row(number: int) -> Array:
        scenario = chunk_scenario(job, chunk, number)
        ran = run_scenario(scenario, paths, kind=kind)
        return row_of(ran.recording, scenario, job.measures)

    return rows_by(row, len(chunk.seeds))


def rows_by(row: Callable[[int], Array], count: int) -> Array:
    """Return the rows of ``count`` runs. Raises ``NotRunError`` with the reasons of those that could not take place."""
    rows, reasons = [], []
    for number in range(count):
        try:
            rows.append(row(number))
        except (NotRunError, *RESOURCES) as error:
            reasons.append(reason_of(error))
    if reasons:
        raise NotRunError(*reasons)
    return np.array(rows)


def compiled(measures: tuple[Measure, ...], scenario: Scenario) -> Rows:
    """Return the compiled runs of the models of ``scenario``, made once per process."""
    ending, models = scenario.ending, tuple(scenario.models.items())
    faults = tuple(item.inputs for item in heard(scenario))
    with _compiling:
        return _compiled(
            models, measures, faults, ending.signal, ending.final(), SPEED, ending.still, ending.standstill_ns
        )


@lru_cache
def _compiled(
    models: tuple[tuple[str, Model], ...], measures: tuple[Measure, ...], faults: tuple[Disturbed, ...], *ending: Any
) -> Rows:
    return compiled_rows(dict(models), Ending(*ending), [_kept(item) for item in measures], faults)


def _kept(measure: Measure) -> Kept:
    return Kept(measure.how, measure.signal, None if measure.when is None else When(*measure.when))
