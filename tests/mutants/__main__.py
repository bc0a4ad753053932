"""``python -m tests.mutants [--count N --seed N]``: make mistakes in the laws of all papers, say which nobody finds."""

import argparse
import json
import sys
from pathlib import Path

from tests.mutants.checks import CHECKS
from tests.mutants.listed import listed
from tests.mutants.printed import printed
from tests.mutants.runner import ROOT, checkout, prepare, run
from tests.mutants.sites import Mutant, drawn

SEED = 2015
COUNT = 200
OF_LISTED = "scenarios,step tests"
OF_PRINTED = "printed"
OF_DRAWN = "numbers,record,step tests,reproduction,tests"
LEAST = 0.95
"""Share of the mutants, but for those that change nothing, that has to be found."""


def main() -> int:
    """Return 0 if enough of them are found, else 1."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=COUNT)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument(
        "--listed", action="store_true", help="the twenty of NTBPTcwPT, each asked of every check named"
    )
    parser.add_argument(
        "--printed", action="store_true", help="thirty in printed constants, tables, signs and guards of four papers"
    )
    parser.add_argument("--checks", help=f"in this order, of {', '.join(CHECKS)}")
    parser.add_argument("--every", type=int, default=1, help="each so many-th of them")
    parser.add_argument("--only", default="", help="of this system")
    parser.add_argument("--out", type=Path, help="where the verdicts go, as JSON lines; what it has already is kept")
    asked = parser.parse_args()
    mutants = listed(ROOT) if asked.listed else drawn(ROOT, asked.count, asked.seed)
    if asked.printed:
        mutants = printed(ROOT)
    mutants = [item for item in mutants if asked.only in ("", item.system)][:: asked.every]
    mutants = [item for item in mutants if item.name not in _done(asked.out)]
    names = (asked.checks or (OF_PRINTED if asked.printed else OF_LISTED if asked.listed else OF_DRAWN)).split(",")
    prepare()
    return _run(mutants, names, asked)


def _done(out: Path | None) -> set[str]:
    """Return the names of the mutants that somebody has found already."""
    if out is None or not out.exists():
        return set()
    rows = [json.loads(line) for line in out.read_text(encoding="utf-8").splitlines()]
    return {row["name"] for row in rows if any(row["found"].values())}


def _run(mutants: list[Mutant], names: list[str], asked: argparse.Namespace) -> int:
    missed = []
    with checkout() as copy:
        for verdict in run(mutants, names, copy, every=asked.listed):
            found = "; ".join(item for item in verdict.found.values() if item)
            print(f"{verdict.mutant.name}\n    {found or 'NOBODY'}  ({verdict.seconds:.1f} s)", flush=True)
            if asked.out:
                with asked.out.open("a", encoding="utf-8") as lines:
                    lines.write(json.dumps({"name": verdict.mutant.name, "found": verdict.found}) + "\n")
            if not verdict.killed:
                missed.append(verdict.mutant)
    print(f"{len(mutants) - len(missed)} of {len(mutants)} found")
    return 0 if len(missed) <= (1.0 - LEAST) * len(mutants) else 1


if __name__ == "__main__":
    sys.exit(main())
