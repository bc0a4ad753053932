"""``python -m apa_cosim.gym``: one table, systems by scenes."""

import argparse
import sys
from math import isnan
from pathlib import Path
from typing import get_args

from rich.table import Table

from apa_cosim.gym.catalogue import FILE_IDS
from apa_cosim.gym.ids import IDS, Body
from apa_cosim.gym.options import EnvironmentOptions
from apa_cosim.gym.ranking import Score, score
from orchestrator.inputs.text.console import console
from orchestrator.inputs.text.errors import BadInput

FIRST_SEED = 1_000_000
"""Of the scenes: training usually draws others."""


def main(arguments: list[str]) -> int:
    """Print how each system does on each environment. Returns 0, or 2 for bad input."""
    parser = argparse.ArgumentParser(prog="python -m apa_cosim.gym", description=str(__doc__))
    parser.add_argument("systems", nargs="+", metavar="SYSTEM", help="random, POLICY.onnx, CONTROLLER.fmu, or a name")
    parser.add_argument("--scenes", nargs="+", default=["apa/Parallel-v0"], metavar="ID", help=", ".join(IDS))
    parser.add_argument("--episodes", type=int, default=100, metavar="N", help="scenes of each (100)")
    parser.add_argument("--first-seed", type=int, default=FIRST_SEED, metavar="S", help=f"of the scenes ({FIRST_SEED})")
    parser.add_argument("--body", choices=get_args(Body), help="equations of motion")
    cases = f"cases of {', '.join(FILE_IDS)}, or folders of them"
    parser.add_argument("--files", nargs="+", type=Path, default=[], metavar="FILE", help=cases)
    asked = parser.parse_args(arguments)
    if asked.episodes < 1:
        parser.error("--episodes: expected 1 or more")
    seeds = range(asked.first_seed, asked.first_seed + asked.episodes)
    scores: list[Score] = []
    try:
        for name in asked.scenes:
            options = EnvironmentOptions(asked.body, files=asked.files if name in FILE_IDS else ())
            scores += [score(system, name, seeds, options) for system in asked.systems]
    except BadInput as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    console().print(_table(scores))
    return 0


def _table(scores: list[Score]) -> Table:
    table = Table(box=None, title="the same scenes for all systems of an environment")
    for head in ("environment", "system", "scenes", "parked", "95 %", "contacts", "median time"):
        table.add_column(head, justify="left" if head in ("environment", "system") else "right")
    for item in sorted(scores, key=lambda item: (item.scenes, -item.success_count, item.contacts)):
        low, high = item.interval
        time = "" if isnan(item.median_time) else f"{item.median_time:.1f} s"
        cells = [
            str(len(item.outcomes)),
            str(item.success_count),
            f"{100 * low:.1f} to {100 * high:.1f}",
            str(item.contacts),
        ]
        table.add_row(item.scenes, Path(item.system).name, *cells, time)
    return table


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
