"""What a table says: success rates over two parameters, what the result depends on, which runs are worst."""

import math
from collections import Counter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import rankdata

from orchestrator.evaluation.verdict.conditions import CONDITIONS
from orchestrator.evaluation.verdict.confidence import wilson
from orchestrator.evaluation.verdict.limit_text import requirement_text
from orchestrator.inputs.scenario.scenario import DONE, MISSED, SUCCESS
from orchestrator.inputs.text.quantities import RAD_PER_DEGREE
from orchestrator.inputs.text.readable import readable
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.sweep.study.study_file import Axes
from orchestrator.studies.sweep.table import Table
from orchestrator.studies.sweep.verdict import RESULTS

MOST_VALUES = 60
"""An axis with more different values than this is divided into bins."""
HISTOGRAM_BINS = 24


class Axis(NamedTuple):
    """One parameter cut into cells."""

    name: str
    unit: str
    text: str
    edges: Array
    """One more than cells; for single values halfway between them."""
    labels: list[str]
    """One for each cell."""
    cell: NDArray[np.intp]
    """Cell of every run."""


class Map(NamedTuple):
    """Success over two parameters, for one value of a third."""

    title: str
    x: Axis
    y: Axis
    done: NDArray[np.intp]
    """(cells of y, cells of x)."""
    runs: NDArray[np.intp]


class Influence(NamedTuple):
    """What one parameter does."""

    name: str
    share: dict[str, float]
    """Result -> share of its variance that goes with this parameter alone, 0 to 1."""
    rank: dict[str, float]
    """Result -> Spearman's rank correlation, -1 to 1."""


def for_people(unit: str) -> tuple[float, str]:
    """Return (factor, unit) in which people read an SI unit: degrees for radians."""
    return (1.0 / RAD_PER_DEGREE, unit.replace("rad", "deg")) if unit.startswith("rad") else (1.0, unit)


def value_text(table: Table, key: str, value: Any) -> str:
    """Return a parameter or label of a run for people: a state by its name, a number with its unit."""
    unit, _, states = table.note(key)
    if states and float(value).is_integer():
        return states.get(str(int(value)), f"{value:g}").lower()
    if isinstance(value, bool | np.bool_):
        return "yes" if value else "no"
    factor, name = for_people(unit)
    number = f"{float(value) * factor:.4g}" if isinstance(value, float | int | np.number) else str(value)
    return number if name == "1" else f"{number} {name}"


def outcome_kind(outcome: str) -> str:
    """Return how a page colours an outcome."""
    return "good" if outcome in DONE else "warn" if outcome in MISSED.values() else "bad"


def varying_columns(table: Table) -> list[str]:
    """Return what tells the runs apart: labels, or else the parameters that differ; of those that agree the first."""
    found: dict[str, Any] = {}
    for key in table.labels or table.job.keys:
        values = table.column(key)
        if len(np.unique(values)) > 1 and not any(np.array_equal(values, other) for other in found.values()):
            found[key] = values
    return list(found)


def success_mask(table: Table) -> NDArray[np.bool_]:
    """Return which runs have done their task."""
    found: NDArray[np.bool_] = np.isin(table.column(table.ends).astype(str), list(DONE))
    return found


class OutcomeCount(NamedTuple):
    """How many runs of a table ended alike."""

    outcome: str
    reason: str
    runs: int
    share: float
    """Of all runs, 0 to 1."""
    low: float
    """Lower end of Wilson's 95 % confidence interval of the share."""
    high: float
    """Upper end of it."""


def outcome_counts(table: Table, most: int = 20) -> list[OutcomeCount]:
    """Return the ``most`` frequent outcomes with their reasons, most frequent first."""
    pairs = zip(table.column(table.ends).tolist(), reasons(table), strict=True)
    return [
        OutcomeCount(outcome, reason, count, count / table.count, *wilson(count, table.count))
        for (outcome, reason), count in Counter(pairs).most_common(most)
    ]


def reasons(table: Table) -> list[str]:
    """Return the reason of each run; none where a study that judges itself, or the summary, finds its task done."""
    given = table.column("reason").tolist()
    if table.ends == "outcome":
        return list(given)
    done = success_mask(table) | np.isin(table.column("outcome").astype(str), list(DONE))
    return ["" if is_done else reason for reason, is_done in zip(given, done.tolist(), strict=True)]


def deciding_limit(table: Table, number: int) -> str:
    """Return the required limit that row ``number`` violates most, with its value: margin over limit decides.

    Only limits on numbers that the table has are compared. Empty if none of these is violated.
    """
    row = table.row(number)
    worst_share, text = 0.0, ""
    for limit in table.requirements:
        value = row.get(limit.signal)
        if not limit.required or value is None or isinstance(limit.limit, str):
            continue
        margin = float(CONDITIONS[limit.condition].margin(np.array([float(value)]), limit.limit)[0])
        violation = -margin / abs(limit.limit) if limit.limit else -margin
        if violation > worst_share:
            unit = RESULTS[limit.signal].unit if limit.signal in RESULTS else "1"
            worst_share, text = violation, f"{limit.id}: {readable(float(value), unit)} ({requirement_text(limit)})"
    return text


def word(table: Table) -> str:
    """Return what a run of this table is that has done its task: parked, or finished."""
    return SUCCESS[table.job.scenario.get("task", "park")]


def axis(table: Table, name: str) -> Axis:
    """Return a parameter or label cut into its values, if they are few or words, or into equal bins.

    Values that hardly ever occur twice are drawn from a range, however few there are.
    """
    unit, text, states = table.note(name)
    if table.column(name).dtype == object:
        words, cell = np.unique(table.column(name).astype(str), return_inverse=True)
        return Axis(name, unit, text, np.arange(len(words) + 1.0) - 0.5, words.tolist(), cell)
    factor, unit = for_people(unit)
    values = np.asarray(table.column(name), dtype=np.float64) * factor
    different = np.unique(values)
    if len(different) <= min(MOST_VALUES, max(HISTOGRAM_BINS, len(values) // 2)):
        cell = np.searchsorted(different, values)
        labels = [states.get(f"{value:.0f}", "").lower() or f"{value:.4g}" for value in different.tolist()]
        middle = 0.5 * (different[1:] + different[:-1])
        ends = (different[0], different[-1]) if len(different) > 1 else (different[0] - 0.5, different[0] + 0.5)
        first = ends[0] if len(different) == 1 else 2.0 * different[0] - middle[0]
        last = ends[1] if len(different) == 1 else 2.0 * different[-1] - middle[-1]
        return Axis(name, unit, text, np.concatenate([[first], middle, [last]]), labels, cell)
    edges = np.linspace(different[0], different[-1], HISTOGRAM_BINS + 1)
    cell = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, HISTOGRAM_BINS - 1)
    return Axis(name, unit, text, edges, [f"{edge:.4g}" for edge in 0.5 * (edges[1:] + edges[:-1])], cell)


def default_axes(table: Table) -> Axes | None:
    """Return the study's axes, or the first two numbers that vary, split by the first mode that varies."""
    given = table.about["study"].get("map")
    if given is not None:
        return Axes(**given)
    different = {key: len(np.unique(table.column(key))) for key in table.labels or table.job.keys}
    modes = [key for key, count in different.items() if 1 < count <= 4 and table.note(key)[2]]
    numbers = [key for key, count in different.items() if count > 1 and key not in modes[:1]]
    return Axes(x=numbers[0], y=numbers[1], split=modes[0] if modes else None) if len(numbers) > 1 else None


def maps(table: Table) -> list[Map]:
    """Return the success maps of a table; none if it varies less than two parameters."""
    axes = default_axes(table)
    if axes is None:
        return []
    x, y = axis(table, axes.x), axis(table, axes.y)
    good = success_mask(table)
    if axes.split is None:
        return [_map("", x, y, good, np.ones(len(good), dtype=bool))]
    split = axis(table, axes.split)
    return [_map(label, x, y, good, split.cell == number) for number, label in enumerate(split.labels)]


def _map(title: str, x: Axis, y: Axis, good: NDArray[np.bool_], chosen: NDArray[np.bool_]) -> Map:
    shape = (len(y.labels), len(x.labels))
    place = y.cell * shape[1] + x.cell
    runs = np.bincount(place[chosen], minlength=shape[0] * shape[1]).reshape(shape)
    successes = np.bincount(place[chosen & good], minlength=shape[0] * shape[1]).reshape(shape)
    return Map(title, x, y, successes, runs)


def influences(table: Table) -> list[Influence]:
    """Return what every varied parameter does to the results, the strongest on success first."""
    results: dict[str, Any] = {
        word(table): success_mask(table).astype(np.float64),
        "duration": table.column("duration"),
    }
    errors = np.abs(table.column("final.lateral_error"))
    results |= {"lateral error": errors} if np.isfinite(errors).all() else {}
    ranks = {name: rankdata(values) for name, values in results.items()}
    found = []
    for key in varying_columns(table):
        cut = axis(table, key)
        own = rankdata(cut.cell if table.column(key).dtype == object else table.column(key))
        shares = {name: variance_share(values, cut.cell) for name, values in results.items()}
        found.append(Influence(key, shares, {name: _correlation(own, other) for name, other in ranks.items()}))
    return sorted(found, key=lambda item: -np.nan_to_num(item.share[word(table)]))


def variance_share(values: Array, cell: NDArray[np.intp]) -> float:
    """Return the variance of the cell means over the variance of ``values``: the first-order sensitivity, 0 to 1.

    Corrected for the variance that the means of so few runs have by chance; never below 0. NaN where each run has a
    cell of its own: there is nothing to tell a dependence from chance.
    """
    good = np.isfinite(values)
    values, cell = values[good], cell[good]
    total = float(np.var(values)) if len(values) else 0.0
    if total == 0.0:
        return 0.0
    counts = np.bincount(cell)
    used = counts > 0
    means = np.bincount(cell, weights=values)[used] / counts[used]
    between = float(np.sum(counts[used] * (means - values.mean()) ** 2)) / len(values)
    degrees = len(values) - int(used.sum())
    if degrees == 0:
        return math.nan
    chance = (total - between) * (int(used.sum()) - 1) / degrees
    return min(1.0, max(0.0, (between - chance) / total))


def _correlation(a: Array, b: Array) -> float:
    if np.ptp(a) == 0.0 or np.ptp(b) == 0.0:
        return 0.0
    return float(np.corrcoef(a, b)[0, 1])


def worst(table: Table, count: int) -> list[int]:
    """Return the rows that are furthest beyond their limits, those that have not done their task first."""
    share = np.nan_to_num(table.column("limit_share"), nan=np.inf)
    order = np.lexsort((-share, success_mask(table)))
    return [int(row) for row in order[:count]]
