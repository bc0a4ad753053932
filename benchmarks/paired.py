"""Compare two systems on the same rows of a study: ``python -m benchmarks.paired FIRST.parquet SECOND.parquet``.

Prints how outcomes change from the first table to the second, and the rows that the second loses: parked in the first,
or touched, or falsely claimed only in the second. Rows are the same if every drawn factor and the seed are equal.
"""

import argparse
import json
import sys
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from orchestrator.inputs.text.errors import BadInput
from orchestrator.studies.sweep.table import Table

PARKED = "parked"
HARM = ("contact", "false parked", "endless")
"""Outcomes worse than giving up; those whose name begins with one of these count too."""
MOST_ROWS = 60


class Pair(NamedTuple):
    """A row that both tables have."""

    row: int
    first: str
    second: str


def outcomes(table: Table) -> list[str]:
    """Return the outcome of each row: the study's own verdict where it has one, contact before any claim else."""
    if "end" in table.names():
        return [str(end) for end in table.column("end")]
    found = [str(outcome) for outcome in table.column("outcome")]
    if "min_clearance" in table.names():
        touched = table.column("min_clearance") <= 0.0
        found = ["contact" if touch else outcome for touch, outcome in zip(touched, found, strict=True)]
    return found


def factors(table: Table) -> list[str]:
    """Return the columns that say what was drawn: of the study's space, or its labels; and the seed."""
    space = table.about["study"].get("space") or []
    drawn = [item["name"] if isinstance(item, dict) else str(item) for item in space] or list(table.labels)
    return [name for name in (*drawn, "run_seed") if name in table.names()]


def pairs_of(first: Table, second: Table) -> list[Pair]:
    """Return the outcomes of both tables row by row, of the rows that both have. Raises ``BadInput`` if they differ."""
    count = min(first.count, second.count)
    for name in factors(first):
        if name not in second.names():
            raise BadInput(f"has no column {name}, so its rows are others", file=second.path)
        one, other = (np.asarray(table.column(name))[:count] for table in (first, second))
        if not all(same(a, b) for a, b in zip(one.tolist(), other.tolist(), strict=True)):
            raise BadInput(f"column {name} differs: run the same study, runs, seed and factors", file=second.path)
    both = zip(outcomes(first)[:count], outcomes(second)[:count], strict=True)
    return [Pair(row, *ends) for row, ends in enumerate(both)]


def same(one: Any, other: Any) -> bool:
    """Return whether two values of a column are equal, NaN counted as equal to NaN."""
    return bool(one == other or (one != one and other != other))


def is_lost(pair: Pair) -> bool:
    """Return whether the second system does worse: no longer parked, or harm where the first did none."""
    harm = [any(end.startswith(word) for word in HARM) for end in (pair.first, pair.second)]
    return (pair.first == PARKED and pair.second != PARKED) or (harm[1] and not harm[0])


def report(pairs: list[Pair]) -> list[str]:
    """Return the lines that are printed."""
    lost, won = [pair for pair in pairs if is_lost(pair)], [pair for pair in pairs if is_lost(flipped(pair))]
    equal = sum(pair.first == pair.second for pair in pairs)
    parked = [sum(pair[place] == PARKED for pair in pairs) for place in (1, 2)]
    lines = [f"{len(pairs)} rows, {equal} with the same outcome; parked {parked[0]} -> {parked[1]}"]
    lines.append(f"{len(lost)} lost, {len(won)} won")
    for (before, after), count in Counter((pair.first, pair.second) for pair in pairs).most_common():
        if before != after:
            lines.append(f"{count:6d}  {before} -> {after}")
    for pair in lost[:MOST_ROWS]:
        lines.append(f"lost row {pair.row}: {pair.first} -> {pair.second}")
    if len(lost) > MOST_ROWS:
        lines.append(f"... and {len(lost) - MOST_ROWS} more: --json FILE has all")
    return lines


def flipped(pair: Pair) -> Pair:
    """Return the pair with the systems exchanged."""
    return Pair(pair.row, pair.second, pair.first)


def main(words: list[str]) -> int:
    """Print the comparison. Returns 0, 1 if the second system loses a row, 2 on bad input."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.paired", description=__doc__)
    parser.add_argument("first", type=Path)
    parser.add_argument("second", type=Path)
    parser.add_argument("--json", type=Path, help="write all rows that are lost")
    asked = parser.parse_args(words)
    try:
        pairs = pairs_of(Table(asked.first), Table(asked.second))
    except BadInput as error:
        print(f"paired: {error}", file=sys.stderr)
        return 2
    print("\n".join(report(pairs)))
    lost = [pair._asdict() for pair in pairs if is_lost(pair)]
    if asked.json is not None:
        asked.json.write_text(json.dumps(lost, indent=1))
    return 1 if lost else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
