"""The runs of a falsification: points of the unit cube and seeds in, margins and words about each run out.

All that is run is kept in a journal. A resumed search asks for the same runs again and reads them from it.
"""

import io
import math
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fmus.files import whole
from orchestrator.evaluation.verdict.conditions import CONDITIONS
from orchestrator.inputs.scenario.scenario import PENETRATION, Scenario
from orchestrator.inputs.text.console import Meter, say
from orchestrator.inputs.text.errors import lacks_resources
from orchestrator.simulation.cosim.algorithm import Interrupt
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.falsification.objective import smallest
from orchestrator.studies.sweep.columns import fill_columns
from orchestrator.studies.sweep.engine import Engine, all_rows
from orchestrator.studies.sweep.job import Chunk, Job, make_job, truths
from orchestrator.studies.sweep.rows import FIRST_MEASURE
from orchestrator.studies.sweep.study.design import Design
from orchestrator.studies.sweep.study.space import Seeds, Space
from orchestrator.studies.sweep.study.study import Columns, Objective, Study
from orchestrator.studies.sweep.verdict import judge_rows, limit_value, quantities, values_in

CHUNKS_PER_WORKER = 4
"""Chunks of a batch for each worker."""


class Evaluations(NamedTuple):
    """What some runs came to."""

    margins: Array
    """0 or less: the requirement is broken."""
    words: Array
    """How each ended."""


class Stopped(Exception):  # noqa: N818 - said as it is
    """Ctrl-C: what is done is in the journal."""


class Subject:
    """What is searched in a study, and who does the runs."""

    def __init__(self, study: Study, space: Space, objective: Objective, engine: Engine, journal: Path) -> None:
        self.space, self.objective, self.runs = space, objective, 0
        self.study = study._replace(within={**study.within, OBJECTIVE_COLUMN: list(objective.limits)})
        self.job = make_job(self.study)
        self.meter: Meter | None = None
        self.interrupt = Interrupt()
        self.stage, self.broken = "", 0
        self._engine, self._journal, self._batches = engine, journal, 0

    def margins(self, shares: Array, seeds: Seeds) -> Array:
        """Return the margins of runs at points (n, factors) of the unit cube."""
        return self.see(shares, seeds).margins

    def see(self, shares: Array, seeds: Seeds) -> Evaluations:
        """Return what runs come to, from the journal if they were made before. Raises ``Stopped``."""
        part = self._journal / f"{self._batches:06d}.npz"
        self._batches += 1
        seen = _read_part(part, shares, seeds) or self._run_part(part, shares, seeds)
        self.runs += len(seeds)
        self.broken += int((seen.margins <= 0.0).sum())
        if self.meter is not None:
            self.meter.at(self.runs, f"{self.stage}, {self.broken} broken")
        return seen

    def chunk(self, shares: Array, seed: int) -> Chunk:
        """Return one run as a line of the design."""
        seeds = np.array([seed], dtype=np.int64)
        return Chunk(0, 0, self.space.values(shares[None], seeds), seeds)

    def _run_part(self, part: Path, shares: Array, seeds: Seeds) -> Evaluations:
        values = self.space.values(shares, seeds)
        design = Design(self.study.design.fields, values, seeds, self.space.values_by_name(shares))
        study = self.study._replace(design=design)
        margins, words = np.full(len(seeds), np.nan), np.full(len(seeds), "", dtype=object)
        for chunk, rows in all_rows(self._engine.results(self.job, self._chunks(design), self.interrupt)):
            here = slice(chunk.first, chunk.first + len(chunk.seeds))
            columns = fill_columns(study, self.job, chunk, rows)
            found = _margins(self.objective, self.job, chunk, rows, columns)
            margins[here] = np.where(columns["outcome"] == "aborted", np.minimum(found, -ABORTED_MARGIN), found)
            words[here] = _words(columns)
        if self.interrupt.requested and np.isnan(margins).any():
            raise Stopped
        seen = Evaluations(margins, words.astype(str))
        with whole(part) as beside, beside.open("wb") as file:
            np.savez(file, shares=shares, seeds=seeds, margins=seen.margins, words=seen.words)
        return seen

    def _chunks(self, design: Design) -> Iterator[Chunk]:
        size = max(1, math.ceil(len(design.seeds) / (CHUNKS_PER_WORKER * self._engine.workers)))
        for number, first in enumerate(range(0, len(design.seeds), size)):
            yield Chunk(number, first, design.values[first : first + size], design.seeds[first : first + size])


OBJECTIVE_COLUMN = "what is result"
ABORTED_MARGIN = 1.0
"""A run that a model has aborted is beyond its limits by this at least: nobody knows what it would have come to."""


def _read_part(part: Path, shares: Array, seeds: Seeds) -> Evaluations | None:
    """Return what is in the journal of just these runs; None if nothing is, or what is there is damaged.

    What cannot be read for lack of memory or files is not damaged: the error passes through.
    """
    if not part.is_file():
        return None
    data = io.BytesIO(part.read_bytes())
    try:
        with np.load(data) as found:
            if not (np.array_equal(found["shares"], shares) and np.array_equal(found["seeds"], seeds)):
                return None
            margins, words = found["margins"], found["words"]
    except Exception as error:  # zip, zlib, numpy's header: each has errors of its own
        if lacks_resources(error):
            raise
        say(f"apa: warning: {part}: is damaged ({type(error).__name__}); its runs are made again")
        return None
    whole = margins.shape == words.shape == seeds.shape
    if not whole or margins.dtype != np.float64 or words.dtype.kind != "U" or np.isnan(margins).any():
        say(f"apa: warning: {part}: has other contents than a search writes; its runs are made again")
        return None
    return Evaluations(margins, words)


def _margins(objective: Objective, job: Job, chunk: Chunk, rows: Array, columns: Columns) -> Array:
    if objective.margins is not None:
        return objective.margins(columns)
    truth = truths(job, chunk)
    scenario = Scenario(**job.scenario)
    results = judge_rows(scenario, truth, job.measures, rows).numbers
    has = truth.has() | quantities(scenario, results)
    found = dict(zip(job.measures, rows[:, FIRST_MEASURE:].T, strict=False))
    margins = []
    for limit in objective.limits:
        margin = CONDITIONS[limit.condition].margin(values_in(limit, results, found), limit_value(limit))
        margins.append(np.where(margin == 0.0, np.finfo(float).tiny, margin))
        if limit.where is not None:
            margins[-1] = np.where(has[limit.where], margins[-1], np.inf)
    least = np.clip(smallest(margins), -MAX_MARGIN, MAX_MARGIN)
    depth = results[PENETRATION]
    touches = np.isnan(depth) | (depth > 0.0)
    return np.where(touches & ~scenario.contact_allowed, np.minimum(least, -np.nan_to_num(depth, nan=1.0)), least)


MAX_MARGIN = 1e3


def _words(columns: Columns) -> list[str]:
    names = [name for name in ("end", "touched") if name in columns] or ["outcome"]
    parts = zip(*(np.asarray(columns[name]).tolist() for name in (*names, "reason")), strict=True)
    return [
        ", ".join(dict.fromkeys(word for word in row if word not in ("", "none", "all checks passed"))) for row in parts
    ]
