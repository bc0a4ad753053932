"""Who does the runs: threads with compiled code, processes with models or FMUs, or a Dask cluster.

Every engine takes chunks and gives back (chunk, rows), as they are done. All engines give the same
bits, so a study begun with one may be finished with another.
"""

import os
import signal
import threading
import time
from collections.abc import Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from contextlib import contextmanager
from functools import partial
from importlib.util import find_spec
from multiprocessing import get_context, parent_process
from pathlib import Path

from fmus.files import live_in, own_room
from fmus.installation import missing_package
from fmus.native.compilers import can_compile
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.console import say
from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.algorithm import Interrupt
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.kinds import fastest_kind
from orchestrator.studies.sweep.batch import run_batch, run_recorded
from orchestrator.studies.sweep.engine import (
    CHUNKS_PER_WORKER,
    POLL_INTERVAL,
    ChunkTask,
    Engine,
    Result,
    cores,
    rows_or_reason,
    safe_children,
)
from orchestrator.studies.sweep.job import Chunk, Job
from orchestrator.studies.sweep.rows import why_not_compiled
from orchestrator.studies.sweep.study.imported_fmu import files_of

BATCH_CHUNK = 504
"""Most runs per chunk of the compiled batch: of case 4 about half a second."""
RECORDED_CHUNK = 8
"""Runs per chunk where each run is a recording: some seconds."""
IN_HAND = 1.0
"""How long chunks in hand may take to be done after an interrupt, where they can be cut short [s]."""


def choose_task(scenario: Scenario, fmus: str | None) -> ChunkTask:
    """Return how the runs are done: compiled where that is possible, otherwise one by one in the Python master.

    ``fmus``: with FMUs of this kind instead; ``none``: with the models in process. By default the master has the
    native ones.
    """
    if fmus == "none":
        return ChunkTask(partial(run_recorded, kind="none"), "models in process", RECORDED_CHUNK, False)
    if fmus is not None:
        fmu_files(fmus, say)
        return ChunkTask(partial(run_recorded, kind=fmus), f"{fmus} FMUs", RECORDED_CHUNK, False)
    why = why_not_compiled(scenario) or ("" if can_compile() else "there is no C compiler")
    if why:
        kind = fastest_kind() if set(files_of(scenario)) < set(scenario.places) else "none"
        return choose_task(scenario, kind)._replace(note=f"{why}: every run goes through the Python master")
    return ChunkTask(run_batch, "compiled batch", BATCH_CHUNK, True)


class LocalEngine:
    """Threads or processes of this machine."""

    def __init__(self, task: ChunkTask, workers: int | None = None) -> None:
        self.name = task.name
        self.workers = workers or cores()
        self._task = task

    def results(self, job: Job, chunks: Iterator[Chunk], interrupt: Interrupt) -> Iterator[Result]:
        """Yield chunks with their rows as they are done."""
        with safe_children(), self._executor() as executor:
            waiting: dict[Future[Array], Chunk] = {}
            until: float | None = None
            while True:
                while len(waiting) < CHUNKS_PER_WORKER * self.workers and not interrupt.requested:
                    chunk = next(chunks, None)
                    if chunk is None:
                        break
                    waiting[executor.submit(self._task.work, job, chunk)] = chunk
                if interrupt.requested:
                    until = until or time.monotonic() + IN_HAND
                    for future in [future for future in waiting if future.cancel()]:
                        del waiting[future]
                if not waiting or (until and time.monotonic() > until and not self._task.threads):
                    return
                for future in wait(waiting, timeout=POLL_INTERVAL, return_when=FIRST_COMPLETED).done:
                    chunk = waiting.pop(future)
                    yield chunk, rows_or_reason(partial(_rows, future), len(chunk.seeds))

    @contextmanager
    def _executor(self) -> Iterator[Executor]:
        if self._task.threads:
            with ThreadPoolExecutor(self.workers) as threads:
                yield threads
            return
        room = str(own_room())
        workers = ProcessPoolExecutor(
            self.workers, mp_context=get_context("spawn"), initializer=_begin_worker, initargs=(room,)
        )
        try:
            yield workers
        finally:
            for process in list((workers._processes or {}).values()):
                process.kill()
            workers.shutdown(wait=True, cancel_futures=True)


def _rows(future: "Future[Array]") -> Array:
    try:
        return future.result()
    except BrokenExecutor as error:
        raise BadInput("a worker was ended from outside; what is done is kept, --resume goes on") from error


def make_engine(task: ChunkTask, dask: str | None, workers: int | None) -> Engine:
    """Return the engine: Dask if an address or ``local`` is given. Raises ``BadInput`` if Dask is missing."""
    if dask is None:
        return LocalEngine(task, workers)
    if find_spec("distributed") is None:
        raise BadInput(missing_package("distributed", "sweep"), key="--dask")
    from orchestrator.studies.sweep.dask_engine import DaskEngine

    return DaskEngine(task, None if dask == "local" else dask, workers)


def _begin_worker(room: str) -> None:
    """Leave signals to the parent, which ends the study in order; keep folders in its room; end when it ends."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)
    live_in(Path(room))
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
