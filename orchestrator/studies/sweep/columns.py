"""The columns of a study's table: what each means, and what a chunk of runs puts into them."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from modelkit.signal import Signal
from orchestrator.evaluation.verdict.conditions import CONDITIONS
from orchestrator.evaluation.verdict.measures import Measure
from orchestrator.evaluation.verdict.numbers import Metric
from orchestrator.evaluation.verdict.truth import Bools
from orchestrator.inputs.scenario.requirements import Requirement
from orchestrator.inputs.scenario.scenario import PENETRATION
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.sweep.job import Chunk, Job, truths
from orchestrator.studies.sweep.rows import FIRST_MEASURE
from orchestrator.studies.sweep.study.imported_fmu import signals_of
from orchestrator.studies.sweep.study.study import Study
from orchestrator.studies.sweep.verdict import RESULTS, judge, limit_value, quantities, values_in

WITHIN = "within {}"
"""Name of the column that says whether a run is within a set of limits; one in contact is within none."""
COUNTS = ("manoeuvres",)
"""Numbers that are counts."""
KINDS = {"U": str, "f": float, "i": int, "b": bool}
"""Kind of a numpy array -> type of what it holds."""


class TableColumn(NamedTuple):
    """What one column of a table holds."""

    name: str
    kind: type
    """``float``, ``int``, ``bool`` or ``str``."""
    signal: Signal
    choices: Sequence[str] = ()
    """Names of the values 0, 1, 2 ..., if it has but these."""


def columns_of(study: Study, job: Job) -> list[TableColumn]:
    """Return the columns of the table of a study, in order."""
    return [
        TableColumn("row", int, Signal("1", "number of the run, from 0")),
        *_labels(study),
        *(TableColumn(field.key, field.variable.kind, field.variable.signal) for field in study.design.fields),
        TableColumn("run_seed", int, Signal("1", "random seed of the run")),
        TableColumn("outcome", str, Signal("1", "as in summary.json")),
        TableColumn("reason", str, Signal("1", "as in summary.json")),
        *(
            _number(name, item)
            for name, item in RESULTS.items()
            if item.measure is None or item.measure in job.measures
        ),
        *_measures(study),
        *(TableColumn(WITHIN.format(name), bool, Signal("1", _words(items))) for name, items in study.within.items()),
        *(_number(name, item) for name, item in study.derived.columns.items()),
        *(TableColumn(name, str, Signal("1", text)) for name, text in study.derived.words.items()),
    ]


def fill_columns(study: Study, job: Job, chunk: Chunk, rows: Array) -> dict[str, Any]:
    """Return the columns of a chunk by name, from what was kept of its runs."""
    truth = truths(job, chunk)
    verdict = judge(job, truth, rows)
    found = dict(zip(job.measures, rows[:, FIRST_MEASURE:].T, strict=False))
    touches = np.nan_to_num(verdict.numbers[PENETRATION]) > 0.0
    free = ~touches | study.scenario.contact_allowed
    has = truth.has() | quantities(study.scenario, verdict.numbers)
    here = slice(chunk.first, chunk.first + len(chunk.seeds))
    given = zip(study.design.fields, chunk.values.T, strict=True)
    values: dict[str, Any] = {
        "row": np.arange(here.start, here.stop),
        **{key: words[here] for key, words in study.design.labels.items()},
        **{field.key: column.astype(field.variable.kind) for field, column in given},
        "run_seed": chunk.seeds,
        "outcome": verdict.words(),
        "reason": np.array(verdict.reason, dtype=object),
        **{name: _whole(numbers) if name in COUNTS else numbers for name, numbers in verdict.numbers.items()},
        **{name: found[measure] for name, measure in study.measures.items()},
        **{
            WITHIN.format(name): free & _is_within(items, verdict.numbers, found, has)
            for name, items in study.within.items()
        },
    }
    return {**values, **study.derived.make(values)}


def _is_within(
    limits: list[Requirement], numbers: Mapping[str, Array], found: Mapping[Measure, Array], has: Mapping[str, Bools]
) -> Bools:
    """Return which runs meet all of ``limits`` that are asked of them."""
    good = np.ones(len(numbers["duration"]), dtype=bool)
    for limit in limits:
        met = CONDITIONS[limit.condition].margin(values_in(limit, numbers, found), limit_value(limit)) >= 0.0
        good &= met if limit.where is None else met | ~has[limit.where]
    return good


def _labels(study: Study) -> Iterator[TableColumn]:
    factors = {factor.name: factor for factor in study.space.factors} if study.space is not None else {}
    for key, words in study.design.labels.items():
        factor = factors.get(key)
        signal, choices = (Signal("1", ""), ()) if factor is None else (factor.signal, factor.choices)
        yield TableColumn(key, KINDS[words.dtype.kind], signal, choices)


def _number(name: str, item: Metric) -> TableColumn:
    return TableColumn(name, int if name in COUNTS else float, Signal(item.unit, item.text))


def _measures(study: Study) -> Iterator[TableColumn]:
    known = signals_of(study.scenario)
    for name, measure in study.measures.items():
        signal = known[measure.signal]
        yield TableColumn(name, float, signal._replace(text=f"{measure.how} of {measure.signal}: {signal.text}"))


def _words(limits: list[Requirement]) -> str:
    return "within " + ", ".join(f"{item.id} ({item.source})" for item in limits)


def _whole(values: Array) -> NDArray[np.int64]:
    return np.nan_to_num(values).astype(np.int64)
