"""What an engine of studies is, and what all engines share."""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple, Protocol

from orchestrator.inputs.text.errors import RESOURCES, NotRunError
from orchestrator.inputs.text.failures import reason_of
from orchestrator.simulation.cosim.algorithm import Interrupt
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.sweep.job import Chunk, Job

Work = Callable[[Job, Chunk], Array]
Result = tuple[Chunk, Array | NotRunError]
"""A chunk with its rows, or why it has none."""
CHUNKS_PER_WORKER = 2
"""Chunks handed out per worker."""
FEWEST_CHUNKS = 16
"""Chunks of a study, so that no core waits for long while another one does the last of them."""
MOST_LANES = 8
"""Compiled runs that advance at once."""
POLL_INTERVAL = 0.2
"""How often an interrupt is looked for [s]."""


class Engine(Protocol):
    """Does chunks."""

    name: str
    workers: int

    def results(self, job: Job, chunks: Iterator[Chunk], interrupt: Interrupt) -> Iterator[Result]:
        """Yield chunks with their rows in any order; after an interrupt only those in hand."""


def rows_or_reason(result: Callable[[], Array], count: int) -> Array | NotRunError:
    """Return the rows of a chunk of ``count`` runs, or why they could not take place."""
    try:
        return result()
    except NotRunError as error:
        return error
    except RESOURCES as error:
        return NotRunError(*[reason_of(error)] * count)


def all_rows(results: Iterator[Result]) -> Iterator[tuple[Chunk, Array]]:
    """Yield chunks with their rows. Raises ``NotRunError`` at the end with the reasons of all runs that have none."""
    reasons: list[str] = []
    for chunk, rows in results:
        if isinstance(rows, NotRunError):
            reasons += rows.args
        else:
            yield chunk, rows
    if reasons:
        raise NotRunError(*reasons)


class ChunkTask(NamedTuple):
    """How one chunk is done, and how large it should be."""

    work: Work
    name: str
    chunk: int
    """Most runs of a chunk."""
    threads: bool
    """Threads are enough: the work holds no lock."""
    note: str = ""
    """Why it is not the compiled batch."""

    def chunk_of(self, count: int) -> int:
        """Return how many runs each chunk of a study of ``count`` runs has: they fill the lanes."""
        return min(self.chunk, MOST_LANES * -(-count // (MOST_LANES * FEWEST_CHUNKS)))

    @property
    def is_compiled(self) -> bool:
        """Return whether there is machine code to be made first."""
        return self.threads


@contextmanager
def safe_children() -> Iterator[None]:
    """Let no process that is begun import a module of the current folder, nor run the script that has called us."""
    before = os.environ.get("PYTHONSAFEPATH")
    os.environ["PYTHONSAFEPATH"] = "1"
    script: dict[str, Any] = vars(sys.modules["__main__"])
    hidden: dict[str, Any] = {name: script.pop(name) for name in ("__file__", "__spec__") if name in script}
    script["__spec__"] = None
    try:
        yield
    finally:
        script.update(hidden)
        if before is None:
            os.environ.pop("PYTHONSAFEPATH", None)
        else:
            os.environ["PYTHONSAFEPATH"] = before


def cores() -> int:
    """Return the number of processor cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
