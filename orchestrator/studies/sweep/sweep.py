"""A study from its design to its table: what is missing is run, written part by part, joined at the end."""

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from orchestrator.inputs.scenario.plausible import implausible, is_implausible
from orchestrator.inputs.text.console import Meter, say
from orchestrator.inputs.text.errors import BadInput, NotRunError, suggestion
from orchestrator.session.provenance import versions
from orchestrator.simulation.cosim.algorithm import Interrupt
from orchestrator.simulation.cosim.fmu_files import sources_hash
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.interrupts import on_interrupt
from orchestrator.studies.sweep.batch import compile_models, own_choices
from orchestrator.studies.sweep.columns import columns_of, fill_columns
from orchestrator.studies.sweep.engine import Engine
from orchestrator.studies.sweep.engines import choose_task, make_engine
from orchestrator.studies.sweep.job import Chunk, Job, arrays, chunks, make_job
from orchestrator.studies.sweep.store import Store
from orchestrator.studies.sweep.study.imported_fmu import hashes_of
from orchestrator.studies.sweep.study.study import Study


@dataclass
class Options:
    """How a study is run; none of it changes a bit of the table."""

    fmus: str | None = None
    dask: str | None = None
    """Address of a scheduler, or ``local``."""
    workers: int | None = None
    chunk: int | None = None
    resume: bool = False
    restart: bool = False


@dataclass
class Swept:
    """What came of it."""

    table: Path | None
    """None if interrupted."""
    count: int
    """Runs of the study."""
    done: int
    """Runs in the table or in its parts."""
    made: int
    """Runs made now."""
    successes: int
    """Of those made now: how many have done their task."""
    seconds: float
    engine: str
    note: str
    not_run: NotRunError | None = None
    """Runs that could not take place; what is done of the study is kept."""
    aborted: int = 0
    """Of those made now: how many a model has aborted."""


def sweep(study: Study, folder: Path, options: Options) -> Swept:
    """Run a study, or the rest of it. Raises ``BadInput``."""
    design, job = study.design, make_job(study)
    task = choose_task(study.scenario, options.fmus)
    columns = columns_of(study, job)
    _check_map(study, [column.name for column in columns])
    _say_what_is_hardly_meant(study)
    store = Store(folder, study.name, columns, about(study, job))
    total = len(design.seeds)
    if options.resume and store.is_finished():
        return Swept(store.table, total, total, 0, 0, 0.0, task.name, task.note)
    size = store.begin(options.chunk or task.chunk_of(total), resume=options.resume, restart=options.restart)
    missing = [chunk for chunk in chunks(design, size) if not store.has(chunk.number)]
    swept = Swept(None, total, total - sum(len(chunk.seeds) for chunk in missing), 0, 0, 0.0, task.name, task.note)
    if missing and task.is_compiled:
        parameters = arrays(job, missing[0])[0]
        compile_models(tuple(job.measures), study.scenario, own_choices(job, study.scenario, parameters))
    if missing:
        _run(study, job, missing, make_engine(task, options.dask, options.workers), store, swept)
    if swept.done == total:
        swept.table = store.finish(-(-total // size))
    return swept


def _say_what_is_hardly_meant(study: Study) -> None:
    """Say which values of a study are allowed but beyond what is plausible, and what a very large one takes."""
    ends = list(zip(study.design.fields, study.design.values.T, strict=True))
    said = [
        is_implausible(end, field.variable._replace(name=field.key)) for field, values in ends for end in _ends(values)
    ]
    for text in dict.fromkeys([*implausible(study.scenario), *said]):
        if text:
            say(f"apa: warning: {text}")
    if len(study.design.seeds) > MANY_RUNS:
        runs = len(study.design.seeds)
        say(f"apa: {runs:,} runs: about {runs / 1e6 * ROW_KILOBYTES:.1f} GB of table")


def _ends(values: Array) -> list[float]:
    """Return the least and the greatest number of a column; a fault's value may be none."""
    numbers = values[np.isfinite(values)]
    return [float(numbers.min()), float(numbers.max())] if len(numbers) else []


MANY_RUNS = 1_000_000
ROW_KILOBYTES = 0.4
"""Size of a row in parts and table [kB], about."""


def _check_map(study: Study, known: list[str]) -> None:
    """Raise ``BadInput`` if the map of the study shows what its table will not have."""
    for side, name in (study.content.get("map") or {}).items():
        if name is not None and name not in known:
            raise BadInput(f"{name} is no column of the table{suggestion(name, known)}", key=f"map.{side}")


def _run(study: Study, job: Job, missing: list[Chunk], engine: Engine, store: Store, swept: Swept) -> None:
    """Do the ``missing`` chunks, write their parts, and note in ``swept`` what was done."""
    begun, interrupt = time.perf_counter(), Interrupt()
    swept.engine = f"{engine.name}, {engine.workers} at a time"
    with on_interrupt(interrupt), Meter(study.name, swept.count, "runs") as meter:
        for chunk, rows in engine.results(job, iter(missing), interrupt):
            if isinstance(rows, NotRunError):
                swept.not_run = NotRunError(*(swept.not_run.args if swept.not_run else ()), *rows.args)
                continue
            columns = fill_columns(study, job, chunk, rows)
            store.write(chunk.number, columns)
            swept.successes += int((columns[study.ends] == study.scenario.success).sum())
            swept.aborted += int((columns["outcome"] == "aborted").sum())
            swept.done += len(rows)
            swept.made += len(rows)
            rate = swept.made / (time.perf_counter() - begun)
            meter.at(swept.done, f"{rate:.0f}/s, {100.0 * swept.successes / swept.made:.1f} % {study.scenario.success}")
    swept.seconds = time.perf_counter() - begun


def about(study: Study, job: Job) -> dict[str, Any]:
    """Return what a table says about itself: enough to go on with it and to run any row again."""
    return {
        "study": {**study.content, "labels": [*study.design.labels], "ends": study.ends},
        "job": job._asdict(),
        "design": study.design.digest(),
        "sources": sources_hash(),
        **({"fmus": hashes_of(study.scenario)} if study.scenario.system is not None else {}),
        "versions": versions(),
    }
