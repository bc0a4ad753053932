"""One study from its file to its table: what is missing is run, written part by part, joined at the end."""

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from orchestrator.cosim.fmu_files import sources_hash
from orchestrator.cosim.interrupts import on_interrupt
from orchestrator.cosim.master import Interrupt
from orchestrator.session.session import versions
from orchestrator.sweep.batch import compiled
from orchestrator.sweep.design import Design, make_design
from orchestrator.sweep.engines import choose_task, make_engine
from orchestrator.sweep.job import Job, make_job, study_scenario
from orchestrator.sweep.store import Store, chunks, job_to
from orchestrator.sweep.study import Study
from orchestrator.sweep.verdict import RESULTS, judge
from orchestrator.text.console import Meter


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


def sweep(study: Study, folder: Path, options: Options) -> Swept:
    """Run a study, or the rest of it. Raises ``BadInput``."""
    scenario = study_scenario(study)
    design = make_design(study, scenario)
    job = make_job(study, scenario, design.fields)
    task = choose_task(scenario, job, options.fmus)
    store = Store(folder, study.name, design.fields, _numbers(job), _about(study, job, design))
    size = store.begin(options.chunk or task.chunk, resume=options.resume, restart=options.restart)
    total = len(design.seeds)
    missing = [chunk for chunk in chunks(design.values, design.seeds, size) if not store.has(chunk.number)]
    swept = Swept(None, total, total - sum(len(chunk.seeds) for chunk in missing), 0, 0, 0.0, task.name, task.note)
    interrupt = Interrupt()
    if missing and task.is_compiled:
        compiled(tuple(job.measures), scenario.ending)
    begun = time.perf_counter()
    if missing:
        engine = make_engine(task, options.dask, options.workers)
        swept.engine = f"{engine.name}, {engine.workers} at a time"
        with on_interrupt(interrupt), Meter(study.name, total, "runs") as meter:
            for chunk, rows in engine.results(job, iter(missing), interrupt):
                verdict = judge(job, chunk, rows)
                store.write(chunk, verdict)
                swept.successes += int(verdict.succeeded().sum())
                swept.done += len(rows)
                swept.made += len(rows)
                rate = swept.made / (time.perf_counter() - begun)
                meter.at(swept.done, f"{rate:.0f}/s, {100.0 * swept.successes / swept.made:.1f} % {scenario.success}")
    swept.seconds = time.perf_counter() - begun
    if swept.done == total:
        swept.table = store.finish(-(-total // size))
    return swept


def _numbers(job: Job) -> list[str]:
    """Return the columns of results: nothing that the models do not tell, no slot or kerb where there is none."""
    scenario = job.scenario
    has_kerb = any(name.startswith("scene.kerbs[") for name in scenario["vehicle"])
    absent = {"final.slot_margin"} if scenario["slot"] is None else set()
    absent |= set() if has_kerb else {"final.kerb_nearest", "final.kerb_farthest"}
    measured = {name for name, item in RESULTS.items() if item.measure is None or item.measure in job.measures}
    return [name for name in RESULTS if name in measured - absent]


def _about(study: Study, job: Job, design: Design) -> dict[str, Any]:
    """Return what a table says about itself: enough to go on with it and to run any row again."""
    return {
        "study": study.model_dump(mode="json", by_alias=True),
        "job": job_to(job),
        "design": design.digest(),
        "sources": sources_hash(),
        "versions": versions(),
    }
