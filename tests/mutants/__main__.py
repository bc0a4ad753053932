"""``python -m tests.mutants [--count N --seed N]``: make mistakes in the laws of all papers, say which nobody finds."""

import argparse
import json
import sys
from pathlib import Path

from tests.mutants.checks import CHECKS
from tests.mutants.fixed import (
    LEAST_IN_CODE,
    LIMIT_OF_CPU,
    NO_END,
    detected_by,
    draw,
    import_project,
    located,
    packages,
    read_table,
    write_table,
)
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
    parser.add_argument(
        "--fixed", action="store_true", help="those of all packages in fixed.tsv, each against its test"
    )
    parser.add_argument("--find", action="store_true", help="with --fixed: draw the list anew, about two a package")
    parser.add_argument("--checks", help=f"in this order, of {', '.join(CHECKS)}")
    parser.add_argument("--every", type=int, default=1, help="each so many-th of them")
    parser.add_argument("--only", default="", help="of this system")
    parser.add_argument("--out", type=Path, help="where the verdicts go, as JSON lines; what it has already is kept")
    asked = parser.parse_args()
    if asked.fixed:
        return _run_fixed(asked.find)
    mutants = listed(ROOT) if asked.listed else drawn(ROOT, asked.count, asked.seed)
    if asked.printed:
        mutants = printed(ROOT)
    mutants = [item for item in mutants if asked.only in ("", item.system)][:: asked.every]
    mutants = [item for item in mutants if item.name not in _done(asked.out)]
    names = (asked.checks or (OF_PRINTED if asked.printed else OF_LISTED if asked.listed else OF_DRAWN)).split(",")
    prepare()
    return _run(mutants, names, asked)


def _done(out: Path | None) -> set[str]:
    """Return the names of the mutants already detected."""
    if out is None or not out.exists():
        return set()
    rows = [json.loads(line) for line in out.read_text(encoding="utf-8").splitlines()]
    return {row["name"] for row in rows if any(row["found"].values())}


def _run_fixed(is_to_be_found: bool) -> int:
    """Run each mistake of the fixed list against its test; return 0 if all that are still in the code are detected."""
    import_project()
    if is_to_be_found:
        write_table([row for package in packages() for row in draw(package, 2, 5, SEED)])
    rows = read_table()
    unfit = detected_by(None, sorted({row.test for row in rows}), limit=20 * LIMIT_OF_CPU)
    if unfit:
        print(f"{unfit} fails without any mistake")
        return 1
    there = missed = 0
    for row in rows:
        mutant = located(row)
        found = detected_by(mutant, [row.test]) or "NOBODY" if mutant else "not in the code any more"
        is_missed = mutant is not None and "::" not in found and found != NO_END
        there, missed = there + (mutant is not None), missed + is_missed
        print(f"{row.file}: {row.before} -> {row.after}\n    {found}", flush=True)
    print(f"{there - missed} of {there} found; {len(rows) - there} of {len(rows)} not in the code any more")
    return int(missed > 0 or there < LEAST_IN_CODE * len(rows))


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
