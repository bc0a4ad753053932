"""Prints how long before their contacts sensors could have told of who moved.

``python docs/heard.py TABLE.parquet`` of the study apa-world; each run with a contact is driven again.
"""

import sys
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from orchestrator.grid.world.ends import CONTACT, MOVABLE
from orchestrator.grid.world.heard import heard_before
from orchestrator.grid.world.scene import THINGS
from orchestrator.sweep.repeat import repeat_row
from orchestrator.sweep.table import Table

UP_TO = (0.0, 0.25, 0.5, 1.0)
TITLES = ("never", "less than 0.25 s", "0.25 to 0.5 s", "0.5 to 1 s", "longer")


def times(table: Table) -> list[tuple[str, float]]:
    """Return who was touched in each contact with somebody who moves, and how long [s] before he could be heard."""
    found = []
    for number in (table.column("end") == CONTACT).nonzero()[0].tolist():
        row = table.row(number)
        if row["touched"] in MOVABLE and moves(row, row["touched"]):
            with TemporaryDirectory() as folder:
                again = repeat_row(table, number, Path(folder) / "row", pages=False)
            found.append((row["touched"], heard_before(again.ran.recording, row["touched"], row["touched.time"])))
    return found


def moves(row: Mapping[str, Any], name: str) -> bool:
    """Return whether this one of ``THINGS`` moves at any time."""
    box = f"vehicle.scene.boxes[{THINGS.index(name) + 1}]"
    return any(row.get(f"{box}.speed_{axis}", 0.0) for axis in "xy")


def column_of(time: float) -> int:
    """Return the column of ``TITLES`` that a time [s] belongs to."""
    return sum(time > limit for limit in UP_TO)


def block(found: list[tuple[str, float]]) -> list[str]:
    """Return the lines of the table."""
    lines = [f"| touched | {' | '.join(TITLES)} |", "|---|" + "---:|" * len(TITLES)]
    for who in MOVABLE:
        counts = Counter(column_of(time) for name, time in found if name == who)
        lines.append(f"| {who} | " + " | ".join(str(counts[place]) for place in range(len(TITLES))) + " |")
    return lines


if __name__ == "__main__":
    print("\n".join(block(times(Table(Path(sys.argv[1]))))))
