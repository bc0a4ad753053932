"""Chunks on a Dask cluster: one of this machine's own, or one whose scheduler is named.

Dask hands the chunks of a worker that is lost to the others; a chunk may be done twice, its rows are
the same. Workers need this project installed, of the same version.
"""

import gc
import importlib
import queue
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.algorithm import Interrupt
from orchestrator.simulation.cosim.fmu_files import sources_hash
from orchestrator.studies.sweep.dask_cluster import PrivateCluster
from orchestrator.studies.sweep.engine import CHUNKS_PER_WORKER, POLL_INTERVAL, ChunkTask, Result, cores, rows_or_reason
from orchestrator.studies.sweep.job import Chunk, Job

distributed: Any = importlib.import_module("distributed")
CONNECT_TIMEOUT = 10.0
"""How long to look for the scheduler [s]."""


class DaskEngine:
    """Threads of Dask workers."""

    def __init__(self, task: ChunkTask, address: str | None, workers: int | None) -> None:
        self._task = task
        self._cluster = PrivateCluster(workers or cores()) if address is None else None
        try:
            place = address if self._cluster is None else self._cluster.cluster
            self._client = distributed.Client(place, timeout=CONNECT_TIMEOUT, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:  # TypeError: tls:// without certificates
            gc.collect()  # closes the client here; in the thread that another client starts, both would wait for ever
            raise BadInput(f"no scheduler answers: {error}", key=f"--dask {address}") from error
        self.name = f"{task.name} on Dask at {self._client.scheduler.address}"
        self.workers = max(1, sum(self._client.nthreads().values()))

    def results(self, job: Job, chunks: Iterator[Chunk], interrupt: Interrupt) -> Iterator[Result]:
        """Yield chunks with their rows as they are done."""
        try:
            self._check_sources()
            yield from self._results(job, chunks, interrupt)
        finally:
            self._client.close()
            if self._cluster is not None:
                self._cluster.close()

    def _results(self, job: Job, chunks: Iterator[Chunk], interrupt: Interrupt) -> Iterator[Result]:
        done: queue.SimpleQueue[Any] = queue.SimpleQueue()
        waiting: dict[Any, tuple[Any, Chunk]] = {}
        while True:
            while len(waiting) < CHUNKS_PER_WORKER * self.workers and not interrupt.requested:
                chunk = next(chunks, None)
                if chunk is None:
                    break
                future = self._client.submit(self._task.work, job, chunk, pure=False)
                waiting[future.key] = (future, chunk)
                future.add_done_callback(done.put)
            if not waiting or interrupt.requested:
                return
            with suppress(queue.Empty):
                future, chunk = waiting.pop(done.get(timeout=POLL_INTERVAL).key)
                yield chunk, rows_or_reason(future.result, len(chunk.seeds))

    def _check_sources(self) -> None:
        """Raise ``BadInput`` if a worker has other sources: its bits could differ."""
        own = sources_hash()
        others = self._client.run(sources_hash)
        different = [address for address, found in others.items() if found != own]
        if different:
            raise BadInput(f"{', '.join(different)} runs another version of this project", key="--dask")
