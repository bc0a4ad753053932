"""The runs of a chunk, in one of two ways that give the same bits.

The compiled batch: every run is one call of machine code, on threads, on all cores; no FMU, no log. Or one by one
through the Python master, on FMUs or on the models in process.
"""

import threading
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from fmus.compiled_batch import (
    FaultInputs,
    RecordedSignal,
    Rows,
    SampleTime,
    StopCondition,
    compile_rows,
    in_smallest_forms,
    signals_to_read,
)
from fmus.lane_rows import compile_lane_rows
from fmus.native.compilers import find_compiler
from fmus.study_slices import StudyCode, study_slices
from modelkit.model import Model
from orchestrator.evaluation.verdict.measures import Measure
from orchestrator.inputs.scenario.end_condition import SPEED
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import RESOURCES, NotRunError
from orchestrator.inputs.text.failures import reason_of
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.sweep.disturbed import fault_numbers, fault_receivers
from orchestrator.studies.sweep.job import Chunk, Job, arrays, chunk_scenario
from orchestrator.studies.sweep.rows import FIRST_MEASURE, row_of
from orchestrator.studies.sweep.study_code import STUDY_CODE_FROM, Choices, StudyRows, choices_of, explanation

_compiling = threading.Lock()


def run_batch(job: Job, chunk: Chunk) -> Array:
    """Return one row of measures per run of ``chunk``."""
    scenario = Scenario(**job.scenario)
    parameters, times = arrays(job, chunk)
    rows = compile_models(tuple(job.measures), scenario, own_choices(job, scenario, parameters))
    out = np.empty((len(parameters), FIRST_MEASURE + len(job.measures)))
    rows(parameters, times, fault_numbers(job, chunk, scenario), out)
    return out


def own_choices(job: Job, scenario: Scenario, parameters: Array) -> Choices | None:
    """Return what the code made for a study is made for; None if it is too small for code of its own."""
    return choices_of(scenario, parameters) if job.runs >= STUDY_CODE_FROM else None


def run_recorded(job: Job, chunk: Chunk, kind: str) -> Array:
    """Return one row of measures per run of ``chunk``, read off its recording.

    The FMUs of ``kind`` (``none``: models in process) are those of the machine that runs them.
    """
    files = {} if kind == "none" else fmu_files(kind)

    def row(number: int) -> Array:
        scenario = chunk_scenario(job, chunk, number)
        ran = run_scenario(scenario, files, kind=kind)
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


def compile_models(measures: tuple[Measure, ...], scenario: Scenario, choices: Choices | None = None) -> Rows:
    """Return the compiled runs of the models of ``scenario``, made once per process.

    ``choices``: of code made for this study, for runs that choose these systems; None: of the complete models.
    """
    faults = tuple(item.inputs for item in fault_receivers(scenario))
    with _compiling:
        return _compile_rows(tuple(scenario.models.items()), measures, faults, choices, stop_condition_of(scenario))


def explain(job: Job, chunk: Chunk) -> str:
    """Return what code made for the study of ``job`` omits of its models; ``chunk``: its runs."""
    scenario = Scenario(**job.scenario)
    ending = stop_condition_of(scenario)
    models, kept = in_smallest_forms(scenario.models, ending, [signal_to_record(item) for item in job.measures])
    choices = choices_of(scenario, arrays(job, chunk)[0])
    return explanation(scenario.models, models, study_slices(models, signals_to_read(ending, kept), dict(choices)))


@lru_cache
def _compile_rows(
    models: tuple[tuple[str, Model], ...],
    measures: tuple[Measure, ...],
    faults: tuple[FaultInputs, ...],
    choices: Choices | None,
    ending: StopCondition,
) -> Rows:
    whole, kept = dict(models), [signal_to_record(item) for item in measures]
    complete = compile_rows(whole, ending, kept, faults)
    if choices is None:
        return complete
    own, kept = in_smallest_forms(whole, ending, kept)
    slices = study_slices(own, signals_to_read(ending, kept), dict(choices))
    code = StudyCode(slices, find_compiler().options_for_this_machine())
    alone = compile_rows(own, ending, kept, faults, code)
    lanes = None if faults else compile_lane_rows(own, ending, kept, code, alone)
    return StudyRows(complete, *([] if lanes is None else [lanes]), alone)


def stop_condition_of(scenario: Scenario) -> StopCondition:
    """Return when the runs of ``scenario`` are over."""
    end = scenario.stop_condition
    return StopCondition(end.signal, end.final(), SPEED, end.still, end.standstill_ns)


def signal_to_record(measure: Measure) -> RecordedSignal:
    """Return what is kept of a run for a measure."""
    return RecordedSignal(measure.how, measure.signal, None if measure.when is None else SampleTime(*measure.when))
