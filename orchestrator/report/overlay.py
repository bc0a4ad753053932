"""The page of two runs on top of each other: both cars, all curves, the verdict on every signal."""

from pathlib import Path
from typing import Any

from fmus.files import write_whole
from orchestrator.comparison.compare import Comparison, Difference
from orchestrator.cosim.recording import Recording
from orchestrator.report.messages import Line
from orchestrator.report.page import page
from orchestrator.report.payload import Arrays
from orchestrator.report.plots import plots_of
from orchestrator.report.replay import KEYS, LARGEST_PAGE, MOST_ROWS
from orchestrator.report.run_data import ribbons_of, run_data
from orchestrator.report.still import origin_of
from orchestrator.text.readable import readable

MOST_PLOTS = 4
"""Curves that differ and are shown at once beside the usual ones."""


def write_overlay(
    path: Path, runs: tuple[Recording, Recording], words: tuple[list[Line], list[Line]], found: Comparison
) -> None:
    """Write the page to ``path``; fewer instants are kept if it would pass 1 MB."""
    text = ""
    for most in MOST_ROWS:
        text = _page(runs, words, found, most)
        if len(text.encode()) < LARGEST_PAGE:
            break
    write_whole(path, text)


def _page(runs: tuple[Recording, Recording], words: tuple[list[Line], list[Line]], found: Comparison, most: int) -> str:
    arrays = Arrays()
    keep = [t for row in found.signals for t in (row.first, row.t_largest) if t is not None][:60]
    origin = origin_of(runs[0])
    data = [
        run_data(run, arrays, lines, label=label, most=most, keep=keep, origin=origin)
        for run, lines, label in zip(runs, words, "AB", strict=True)
    ]
    for run in data:
        run["checks"] = []
    missed = [row for row in found.signals if not row.passed]
    header = {
        "title": f"{found.a} and {found.b}" if found.a != found.b else found.a,
        "subtitle": f"A: {_title(runs[0], found.a)} \u00b7 B: {_title(runs[1], found.b)}",
        "verdict": {
            "text": f"{len(missed)} of {found.compared} differ" if missed else "the same within tolerance",
            "kind": "bad" if missed else "good",
        },
        "facts": _facts(found),
        "plots": plots_of(list(runs), [], [row.signal for row in missed][:MOST_PLOTS]),
        "ribbons": ribbons_of(list(runs), 2),
        "differences": [_row(row) for row in found.signals],
        "changes": [_change(item.name, item.unit, item.a, item.b) for item in found.parameters],
        "runs": data,
        "foot": f"A solid, B dashed. {KEYS}",
    }
    return page(f"{found.a} and {found.b}", arrays.pack(header))


def _title(run: Recording, name: str) -> str:
    return str(run.info.get("scenario", {}).get("title") or name)


def _facts(found: Comparison) -> list[list[str]]:
    firsts = [row.first for row in found.signals if row.first is not None]
    return [
        ["Signals", str(found.compared)],
        ["Differ", str(found.differing)],
        ["First beyond", f"{min(firsts):.2f} s" if firsts else "never"],
        ["Parameters changed", str(len(found.parameters))],
        ["Only in A / B", f"{len(found.only_in_a)} / {len(found.only_in_b)}"],
    ]


def _row(row: Difference) -> dict[str, Any]:
    tube = f" within {row.time_tolerance:g} s" if row.time_tolerance > 0.0 else ""
    small = f"{row.allowed:.1e} {row.unit}" if 0.0 < row.allowed < 1e-3 else readable(row.allowed, row.unit)
    return {**row.model_dump(), "tolerance_text": f"\u00b1 {small}{tube}"}


def _change(name: str, unit: str, a: float | None, b: float | None) -> list[str]:
    return [name, *("\u2013" if value is None else readable(value, unit) for value in (a, b))]
