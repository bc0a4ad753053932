"""Writes how the runs of the study apa-world ended into docs/hunt.md.

``python docs/ends.py WHOLE.parquet MILD.parquet``
"""

import sys
from collections import Counter
from pathlib import Path

import numpy as np
from marked import put
from numpy.typing import NDArray

from orchestrator.grid.world.ends import CONTACT, ENDS, FAILED, FALSE, UNUSED
from orchestrator.grid.world.study import QUIET, groups, parked_of
from orchestrator.sweep.table import Table
from orchestrator.verdict.confidence import clopper_pearson, percent_interval

Chosen = NDArray[np.bool_]


def share(count: int, of: int) -> str:
    """Return a count and its share of all."""
    return f"{count} ({100.0 * count / of:.2f} %)" if count else "0"


def bounds(count: int, of: int) -> str:
    """Return the exact 95 % interval of a probability; of none the upper end alone."""
    if not count:
        return f"below {100.0 * clopper_pearson(0, of)[1]:.2f} %"
    return percent_interval(count, of, 3)


def columns(whole: Table, mild: Table) -> list[tuple[str, NDArray[np.str_], Chosen]]:
    """Return the table's columns: title, ends and which runs count."""
    there = [("whole ranges" if name == "all" else name, whole.column("end"), of) for name, of in groups(whole).items()]
    half = groups(mild)
    return [
        *there,
        ("half the ranges", mild.column("end"), half["all"]),
        ("its parallel slots", mild.column("end"), half["parallel"]),
    ]


def ends(whole: Table, mild: Table) -> list[str]:
    """Return the lines of the table of ends."""
    told = columns(whole, mild)
    lines = [f"| | {' | '.join(title for title, _, _ in told)} |", "|---|" + "---:|" * len(told)]
    lines.append("| runs | " + " | ".join(f"{int(of.sum()):,}" for _, _, of in told) + " |")
    counts = {end: [(int((found[of] == end).sum()), int(of.sum())) for _, found, of in told] for end in ENDS}
    for end, pairs in counts.items():
        if end != UNUSED or any(count for count, _ in pairs):
            lines.append(f"| {end} | " + " | ".join(share(*pair) for pair in pairs) + " |")
    for end in (CONTACT, FALSE):
        lines.append(f"| {end}, 95 % | " + " | ".join(bounds(*pair) for pair in counts[end]) + " |")
    return lines


def parked(whole: Table, mild: Table) -> list[str]:
    """Return the lines of the table of those parked."""
    titles = (
        "whose slot is valid",
        "without those that somebody walked into",
        "valid, and that ask for what is possible",
        f"and in which {QUIET}",
    )
    lines = ["| parked of the runs | whole ranges | half the ranges |", "|---|---:|---:|"]
    both = [list(parked_of(table).values()) for table in (whole, mild)]
    for title, *pairs in zip(titles, *both, strict=True):
        cells = []
        for count, of in pairs:
            cells.append(f"{count:,} of {of:,}: {100.0 * count / of:.1f} % ({percent_interval(count, of)})")
        lines.append(f"| {title} | {' | '.join(cells)} |")
    return lines


def counted(table: Table, column: str, end: str) -> str:
    """Return how often each word of a column is said of runs that end so."""
    words = Counter(table.column(column)[table.column("end") == end].tolist()).most_common()
    mark = "`" if column == "reason" else ""
    return ", ".join(f"{mark}{word}{mark} {count}" for word, count in words) or "none"


def block(whole: Table, mild: Table) -> list[str]:
    """Return all that is written."""
    reasons = f"Reasons of those that gave up: {counted(whole, 'reason', FAILED)}; in half the ranges "
    lines = [*ends(whole, mild), "", *parked(whole, mild), "", reasons + f"{counted(mild, 'reason', FAILED)}."]
    stood = int(whole.column("driven_into").sum())
    first = f"Touched first: {counted(whole, 'touched', CONTACT)}. In {stood or 'none'} of these runs the car stood."
    return [*lines, "", first]


if __name__ == "__main__":
    put(Path(__file__).parent / "hunt.md", "ends", block(*(Table(Path(path)) for path in sys.argv[1:3])))
