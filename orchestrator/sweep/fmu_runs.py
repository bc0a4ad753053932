"""Runs one by one through the Python master, on FMUs or on the models in process; with faults if there are any."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from orchestrator.cosim.slave import Array
from orchestrator.session.session import run_scenario
from orchestrator.sweep.job import Chunk, Job, chunk_scenario
from orchestrator.sweep.rows import row_of


def run_recorded(job: Job, chunk: Chunk, kind: str, files: Mapping[str, str] | None) -> Array:
    """Return one row of measures per run of ``chunk``, read off its recording."""
    paths = None if files is None else {name: Path(path) for name, path in files.items()}
    rows = []
    for number in range(len(chunk.seeds)):
        scenario = chunk_scenario(job, chunk, number)
        ran = run_scenario(scenario, paths, kind=kind)
        rows.append(row_of(ran.recording, scenario, job.measures))
    return np.array(rows)
