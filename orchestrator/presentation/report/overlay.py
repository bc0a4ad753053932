"""The page of runs on top of each other: all cars, all curves, the verdict on every signal."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fmus.files import write_whole
from orchestrator.evaluation.comparison.compare import Comparison, Difference
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.readable import readable
from orchestrator.presentation.drawing.decimation import decimate
from orchestrator.presentation.drawing.palette import RUNS
from orchestrator.presentation.log.line import Line
from orchestrator.presentation.report.page import page
from orchestrator.presentation.report.payload import Arrays
from orchestrator.presentation.report.plots import plots_of
from orchestrator.presentation.report.replay import KEYS, page_of_limited_size
from orchestrator.presentation.report.run_data import ribbons_of, run_data
from orchestrator.presentation.report.still import origin_of
from orchestrator.simulation.cosim.recording import Recording

LABELS = "ABCDEF"
MOST_NAMED = 3
MOST_PLOTS = 4
"""Curves that differ and are shown at once beside the usual ones."""


def write_overlay(
    path: Path,
    runs: Sequence[Recording],
    words: Sequence[list[Line]],
    found: Sequence[Comparison],
    names: Sequence[str] = (),
) -> None:
    """Write the page of runs to ``path``, ``found`` compares each but the first with the first.

    ``names`` are those of the logs, which tell runs of one scenario apart. Fewer instants are kept if it would pass
    1 MB. Raises ``BadInput`` for more runs than there are colours.
    """
    if len(runs) > len(RUNS):
        raise BadInput(f"{len(runs)} runs on one page; there is room for {len(RUNS)}")
    shown = [decimate(run, _moments(found)) for run in runs]
    write_whole(path, page_of_limited_size(lambda most: _page(shown, runs, words, found, most, names)))


def _moments(found: Sequence[Comparison]) -> list[float]:
    """Return times [s] at which runs differ."""
    return [t for item in found for row in item.signals for t in (row.first, row.t_largest) if t is not None][:60]


def _page(
    runs: Sequence[Recording],
    wholes: Sequence[Recording],
    words: Sequence[list[Line]],
    found: Sequence[Comparison],
    most: int,
    own: Sequence[str],
) -> str:
    """Return the page; ``runs`` are the instants shown of the ``wholes``."""
    arrays = Arrays()
    keep = _moments(found)
    origin = origin_of(runs[0])
    names = _distinct([found[0].a, *(item.b for item in found)], own)
    data = []
    for run, whole, lines, label, name, change in zip(runs, wholes, words, LABELS, names, [None, *found], strict=False):
        about = f"{label}: {name}, {_title(run, name)}{_with(change)}"
        longer = whole if whole is not run else None
        shown = run_data(run, arrays, lines, label=label, most=most, keep=keep, origin=origin, whole=longer)
        data.append({**shown, "checks": [], "about": about})
    title = " and ".join(names) if len(names) == 2 else ", ".join(names)
    missed = list(dict.fromkeys(row.signal for item in found for row in item.signals if not row.passed))
    header = {
        "title": title,
        "name": "-".join(dict.fromkeys(names)),
        "subtitle": " \u00b7 ".join(run["about"] for run in data),
        "facts": _facts(found, len(missed)),
        "plots": plots_of(list(runs), [], missed[:MOST_PLOTS]),
        "ribbons": ribbons_of(list(runs), 2),
        "changes": _changes(found),
        "runs": data,
        "foot": f"The colour is the run; the band around A is the tolerance it was judged by. {KEYS}",
        **_verdict(found, len(missed)),
    }
    return page(title, arrays.pack(header))


def _distinct(scenarios: Sequence[str], logs: Sequence[str]) -> list[str]:
    """Return a name for each run: its scenario's, or its log's where scenarios are equal; numbered if need be."""
    names = list(logs if len(set(scenarios)) < len(scenarios) and len(logs) == len(scenarios) else scenarios)
    return [f"{name} ({names[:i].count(name) + 1})" if names.count(name) > 1 else name for i, name in enumerate(names)]


def _verdict(found: Sequence[Comparison], missed: int) -> dict[str, Any]:
    """Return the verdict in words, and the row of every signal of every run."""
    most = max(item.compared for item in found)
    text, kind = (f"{missed} of {most} differ", "bad") if missed else ("the same within tolerance", "good")
    rows = [
        _row(row, label if len(found) > 1 else "")
        for item, label in zip(found, LABELS[1:], strict=False)
        for row in item.signals
    ]
    return {"verdict": {"text": text, "kind": kind}, "differences": rows}


def _title(run: Recording, name: str) -> str:
    return str(run.info.get("scenario", {}).get("title") or name)


def _with(found: Comparison | None) -> str:
    """Return what sets a run apart from the first, if it is little."""
    changes = found.parameters if found is not None else []
    known = [f"{item.name} = {readable(item.b, item.unit)}" for item in changes if item.b is not None]
    return f" with {', '.join(known)}" if 0 < len(known) <= MOST_NAMED else ""


def _facts(found: Sequence[Comparison], missed: int) -> list[list[str]]:
    firsts = [row.first for item in found for row in item.signals if row.first is not None]
    return [
        ["Signals", str(max(item.compared for item in found))],
        ["Differ", str(missed)],
        ["First exceedance", f"{min(firsts):.2f} s" if firsts else "never"],
        ["Parameters changed", str(len(_changes(found)))],
        *(
            [f"Only in A / {label}", f"{len(item.only_in_a)} / {len(item.only_in_b)}"]
            for item, label in zip(found, LABELS[1:], strict=False)
        ),
    ]


def _row(row: Difference, label: str) -> dict[str, Any]:
    tube = f" within {row.time_tolerance:g} s" if row.time_tolerance > 0.0 else ""
    small = f"{row.allowed:.1e} {row.unit}" if 0.0 < row.allowed < 1e-3 else readable(row.allowed, row.unit)
    return {**row.model_dump(), "label": label, "tolerance_text": f"\u00b1 {small}{tube}"}


def _changes(found: Sequence[Comparison]) -> list[list[str]]:
    """Return the parameters that differ anywhere: name, then the value in each run."""
    units = {change.name: change.unit for item in found for change in item.parameters}
    rows = []
    for name, unit in units.items():
        changes = [next((one for one in item.parameters if one.name == name), None) for item in found]
        first = next(change.a for change in changes if change is not None)
        values = [first, *(first if change is None else change.b for change in changes)]
        rows.append([name, *("\u2013" if value is None else readable(value, unit) for value in values)])
    return rows
