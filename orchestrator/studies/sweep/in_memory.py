"""A study without a file: its columns, for who wants to do with them what no table does."""

from typing import Any

import numpy as np

from orchestrator.simulation.cosim.algorithm import Interrupt
from orchestrator.studies.sweep.batch import compile_models
from orchestrator.studies.sweep.columns import fill_columns
from orchestrator.studies.sweep.engine import all_rows
from orchestrator.studies.sweep.engines import choose_task, make_engine
from orchestrator.studies.sweep.job import chunks, make_job
from orchestrator.studies.sweep.study.study import Study


def columns_in_memory(study: Study) -> dict[str, Any]:
    """Return the columns of a study's table without a file, from as many threads or processes as there are cores."""
    job = make_job(study)
    task = choose_task(study.scenario, None)
    if task.is_compiled:
        compile_models(tuple(job.measures), study.scenario)
    todo = chunks(study.design, task.chunk_of(len(study.design.seeds)))
    found = sorted(
        all_rows(make_engine(task, None, None).results(job, todo, Interrupt())), key=lambda item: item[0].number
    )
    parts = [fill_columns(study, job, chunk, rows) for chunk, rows in found]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
