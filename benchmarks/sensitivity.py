"""Scale each tuning constant of a package by 0.7 and 1.4 and print what a study makes of it.

    python -m benchmarks.sensitivity controller_fmu/apa --study apa-world --runs 500 --sample 13 --seed 1

A constant is a number in a module constant, a number in the code but for 0, 1, 2, 3, 4, 0.5, 12 and their negatives, or
a parameter's default. Each variant is a copy of the packages with this one number changed, compiled and run on the same
rows. Whole numbers stay whole. A line: place, value, scale, rows with another outcome, change in parked, rows lost.
"""

import argparse
import ast
import random
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

from benchmarks.paired import PARKED, is_lost, pairs_of
from orchestrator.studies.sweep.table import Table

ROOT = Path(__file__).parents[1]
PACKAGES = ("modelkit", "vehicle_fmu", "controller_fmu", "fmus", "orchestrator")
TRIVIAL = {0, 1, 2, 3, 4, 0.5, 12, 1e9, 1e300}
SCALES = (0.7, 1.4)


class TuningConstant(NamedTuple):
    """One number of the code."""

    file: str
    line: int
    column: int
    end: int
    value: float


def constants_of(folder: Path, root: Path = ROOT) -> list[TuningConstant]:
    """Return the tuning constants below ``folder``."""
    found = []
    for file in sorted(folder.rglob("*.py")):
        tree = ast.parse(file.read_text())
        skipped = {
            id(part)
            for node in ast.walk(tree)
            if isinstance(node, ast.ClassDef) and _is_enum(node)
            for part in ast.walk(node)
        } | {
            id(part)
            for node in ast.walk(tree)
            if isinstance(node, ast.Subscript | ast.AnnAssign)
            for part in ast.walk(node.slice if isinstance(node, ast.Subscript) else node.annotation)
        }
        for node in ast.walk(tree):
            if isinstance(node, ast.Constant) and type(node.value) in (int, float) and id(node) not in skipped:
                assert isinstance(node.value, int | float)
                if abs(node.value) not in TRIVIAL and node.end_col_offset is not None:
                    place = (node.lineno, node.col_offset, node.end_col_offset)
                    found.append(TuningConstant(str(file.resolve().relative_to(root)), *place, node.value))
    return found


def _is_enum(node: ast.ClassDef) -> bool:
    return any("Enum" in ast.unparse(base) for base in node.bases)


def scaled(text: str, constant: TuningConstant, scale: float) -> str:
    """Return a file's text with this constant scaled; whole numbers change by at least 1."""
    lines = text.splitlines(keepends=True)
    line = lines[constant.line - 1].encode()
    if isinstance(constant.value, int):
        value = round(constant.value * scale)
        number = repr(value if value != constant.value else constant.value + (1 if scale > 1.0 else -1))
    else:
        number = repr(constant.value * scale)
    changed = line[: constant.column] + number.encode() + line[constant.end :]
    return "".join([*lines[: constant.line - 1], changed.decode(), *lines[constant.line :]])


def run_study(root: Path, study: list[str], out: Path) -> Table | None:
    """Return the table of a study run with the packages in ``root``; None if they do not run."""
    words = [sys.executable, "-m", "orchestrator", "sweep", *study, "--no-page", "--out", str(out)]
    subprocess.run(words, cwd=root, capture_output=True, check=False)
    tables = list(out.glob("*.parquet"))
    return Table(tables[0]) if tables else None


def main(words: list[str]) -> int:
    """Print a line for each constant and scale."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.sensitivity", description=__doc__)
    parser.add_argument("folder", type=Path, help="package whose constants are scaled")
    parser.add_argument("--study", default="apa-world")
    parser.add_argument("--runs", type=int, default=500)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--sample", type=int, default=None, help="only so many constants, drawn at random")
    parser.add_argument("--only", default="", help="only constants whose FILE:LINE contains this")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args(words)
    constants = [item for item in constants_of(asked.folder) if asked.only in f"{item.file}:{item.line}"]
    if asked.sample is not None:
        constants = random.Random(asked.seed).sample(constants, min(asked.sample, len(constants)))
    study = [asked.study, "--runs", str(asked.runs), *(word for item in asked.set for word in ("--set", item))]
    with tempfile.TemporaryDirectory(prefix="sensitivity-") as name:
        place = Path(name)
        for package in PACKAGES:
            shutil.copytree(ROOT / package, place / package, ignore=shutil.ignore_patterns("__pycache__", "dist"))
        base = run_study(place, study, place / "base")
        if base is None:
            print(f"sensitivity: {asked.study} did not run", file=sys.stderr)
            return 2
        print("file:line value scale other_outcome parked_change lost", flush=True)
        for number, constant in enumerate(constants):
            original = (ROOT / constant.file).read_text()
            for scale in SCALES:
                (place / constant.file).write_text(scaled(original, constant, scale))
                table = run_study(place, study, place / f"{number}-{scale}")
                print(_line(constant, scale, base, table), flush=True)
                shutil.rmtree(place / f"{number}-{scale}", ignore_errors=True)
            (place / constant.file).write_text(original)
    return 0


def _line(constant: TuningConstant, scale: float, base: Table, table: Table | None) -> str:
    head = f"{constant.file}:{constant.line} {constant.value:g} {scale:g}"
    if table is None:
        return f"{head} does not run"
    pairs = pairs_of(base, table)
    changed = sum(pair.first != pair.second for pair in pairs)
    parked = sum((pair.second == PARKED) - (pair.first == PARKED) for pair in pairs)
    return f"{head} {changed} {parked:+d} {sum(map(is_lost, pairs))}"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
