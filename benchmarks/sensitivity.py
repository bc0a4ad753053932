"""Scale each tuning constant of a package by 0.7 and 1.4 and write what a study makes of it.

    python -m benchmarks.sensitivity controller_fmu/parking --study apa-world --runs 40 --out FILE.tsv

A line of the table: file, constant, value, scale, rows, rows of which any number differs, rows with another outcome,
change in parked rows, rows lost. ``--resume`` continues a table; ``--same-in FILE.tsv`` takes only constants of which
no line there differs. ``sensitivity.tsv`` has real constants and parameters of the parking system: ``--runs 20
--seed 6``. Parameters are set for the study; most real numbers are changed in the compiled model while it is loaded
(see ``benchmarks.tuning_constants``); for the others the packages are copied and compiled once for each line.
"""

import argparse
import ctypes
import json
import random
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, NamedTuple, get_type_hints
from unittest import mock

import numpy as np
from pyarrow import parquet

from benchmarks.paired import PARKED, Pair, is_lost, outcomes, same
from benchmarks.tuning_constants import (
    ARRAY,
    ROOT,
    TuningConstant,
    can_vary,
    constants_of,
    marked,
    scaled,
    scaled_value,
    with_array,
)
from fmus.compiler import Translation, translate
from fmus.native import libraries
from fmus.native.sources import translate_model
from modelkit.model import Model
from modelkit.variables import variables
from orchestrator.cli import main as apa
from orchestrator.commands.sweep import select_study
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.studies.sweep import batch
from orchestrator.studies.sweep.job import Chunk, Job
from orchestrator.studies.sweep.job import arrays as job_arrays
from orchestrator.studies.sweep.table import Table

PACKAGES = ("modelkit", "vehicle_fmu", "controller_fmu", "fmus", "orchestrator", "benchmarks")
SCALES = (0.7, 1.4)
COLUMNS = ("file", "constant", "value", "scale", "rows", "differ", "other_outcome", "parked_change", "lost")
WITHOUT_RESULT = ("does not run", "", "", "", "")
"""Instead of an effect, where the study with the changed constant does not run."""
LONGEST_RUN = 300.0
"""Time [s] after which a study with a copy of the packages is given up: scaled codes of cases end no loop."""
OWNER = "controller"


class Effect(NamedTuple):
    """What a study makes of one changed constant."""

    rows: int
    differ: int
    """Rows of which any number differs in any bit."""
    other_outcome: int
    parked_change: int
    lost: int


class Variants:
    """Runs a study with one constant changed, in the fastest way there is for that constant."""

    def __init__(self, constants: list[TuningConstant], study: list[str], place: Path) -> None:
        self._constants, self._study, self._place = constants, study, place
        self._model = model_of(study)
        self._paths = parameter_paths(self._model.params)
        copy_packages(place / "copy")
        code, self._in_array = array_translation(constants, study, place)
        self._patch = mock.patch.object(libraries, "translate_model", self._translate_with(code))
        self._patch.start()
        self._values: Any = None
        self.base = self._run(place / "base")
        library = ctypes.CDLL(str(libraries.model_library(self._model)))
        self._values = (ctypes.c_double * len(constants)).in_dll(library, ARRAY)

    def _translate_with(self, code: Translation) -> Any:
        return lambda model, live=None: code if model.name == self._model.name else translate_model(model, live)

    def run(self, number: int, scale: float) -> Table | None:
        """Return the table of the study with constant ``number`` scaled; None if it does not run."""
        constant, out = self._constants[number], self._place / "out"
        shutil.rmtree(out, ignore_errors=True)
        value = scaled_value(constant.value, scale)
        path = self._paths.get(constant.name) if constant.kind == "parameter" else None
        if path is not None:
            with mock.patch.object(batch, "arrays", self._arrays_with(path, scale)):
                return self._run(out)
        if number in self._in_array and self._values is not None:
            self._values[number] = value
            table = self._run(out)
            self._values[number] = constant.value
            return table
        return self._run_copy(constant, scale, out)

    def _arrays_with(self, path: str, scale: float) -> Any:
        """Return what gives the parameters of all runs with one of the controller's scaled."""

        def arrays(job: Job, chunk: Chunk) -> tuple[Any, Any]:
            parameters, times = job_arrays(job, chunk)
            models = Scenario(**job.scenario).models
            names = [f"{owner}.{item.name}" for owner, model in models.items() for item in variables(model.params)]
            column = names.index(f"{OWNER}.{path}")
            kind = next(item.kind for item in variables(models[OWNER].params) if item.name == path)
            parameters[:, column] = [scaled_value(kind(value), scale) for value in parameters[:, column]]
            return parameters, times

        return arrays

    def _run(self, out: Path) -> Table | None:
        if apa(["sweep", *self._study, "--no-page", "-q", "-j", "1", "--out", str(out)]) not in (0, 1):
            return None
        return table_in(out)

    def _run_copy(self, constant: TuningConstant, scale: float, out: Path) -> Table | None:
        file = self._place / "copy" / constant.file
        original = file.read_text()
        file.write_text(scaled(original, constant, scale))
        words = [sys.executable, "-m", "orchestrator", "sweep", *self._study, "--no-page", "-j", "1", "--out", str(out)]
        try:
            subprocess.run(words, cwd=self._place / "copy", capture_output=True, check=False, timeout=LONGEST_RUN)
        except subprocess.TimeoutExpired:
            return None
        finally:
            file.write_text(original)
        return table_in(out)


def model_of(study: list[str]) -> Model:
    """Return the controller of a study."""
    parser = argparse.ArgumentParser()
    parser.add_argument("name")
    parser.add_argument("--set", action="append", default=[])
    known, _ = parser.parse_known_args(study)
    return select_study(known.name, known.set).scenario.models[OWNER]


def parameter_paths(params: Any, above: str = "") -> dict[str, str]:
    """Return ``Class.field`` -> the name of that parameter in a model whose parameters have this type."""
    found: dict[str, str] = {}
    for field, kind in get_type_hints(params).items():
        if hasattr(kind, "_fields"):
            found |= parameter_paths(kind, f"{above}{field}.")
        else:
            found[f"{params.__name__}.{field}"] = f"{above}{field}"
    return found


def copy_packages(place: Path) -> None:
    """Copy what a study needs to ``place``."""
    for package in PACKAGES:
        shutil.copytree(ROOT / package, place / package, ignore=shutil.ignore_patterns("__pycache__", "dist"))


def array_translation(constants: list[TuningConstant], study: list[str], place: Path) -> tuple[Translation, list[int]]:
    """Return the C of the study's controller with the constants in an array, and the numbers of those that are."""
    folder = place / "marked"
    copy_packages(folder)
    numbered = [(number, item) for number, item in enumerate(constants) if can_vary(item)]
    for file in {item.file for _, item in numbered}:
        text = (ROOT / file).read_text()
        (folder / file).write_text(marked(text, [pair for pair in numbered if pair[1].file == file]))
    words = [sys.executable, "-m", "benchmarks.sensitivity", "--translate", *study]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=True)
    code = Translation(**json.loads(done.stdout))
    source, places = with_array(code.source, constants)
    return code._replace(source=source), places


def table_in(out: Path) -> Table | None:
    """Return the table in a folder; None if there is none."""
    tables = list(out.glob("*.parquet"))
    return Table(tables[0]) if tables else None


def effect(base: Table, table: Table) -> Effect:
    """Return how ``table`` differs from ``base``."""
    differ = np.zeros(base.count, dtype=bool)
    both = [parquet.read_table(item.path) for item in (base, table)]
    for one, other in zip(*(item.columns for item in both), strict=True):
        if not one.equals(other):
            differ |= [not same(*pair) for pair in zip(one.to_pylist(), other.to_pylist(), strict=True)]
    pairs = [Pair(row, *ends) for row, ends in enumerate(zip(outcomes(base), outcomes(table), strict=True))]
    return Effect(
        base.count,
        int(differ.sum()),
        sum(pair.first != pair.second for pair in pairs),
        sum((pair.second == PARKED) - (pair.first == PARKED) for pair in pairs),
        sum(map(is_lost, pairs)),
    )


def lines_in(file: Path) -> list[list[str]]:
    """Return the lines of a table without its head; none if there is no table."""
    return [line.split("\t") for line in file.read_text().splitlines()[1:]] if file.is_file() else []


def without_effect(file: Path) -> set[tuple[str, str]]:
    """Return file and name of the constants of which no row differs in any line of a table."""
    lines = lines_in(file)
    return {(line[0], line[1]) for line in lines} - {(line[0], line[1]) for line in lines if line[5] != "0"}


def main(words: list[str]) -> int:
    """Write a line for each constant and scale."""
    if words[:1] == ["--translate"]:
        print(json.dumps(translate(model_of(words[1:]))._asdict()))
        return 0
    parser = argparse.ArgumentParser(prog="python -m benchmarks.sensitivity", description=__doc__)
    parser.add_argument("folder", type=Path, help="package whose constants are scaled")
    parser.add_argument("--study", default="apa-world")
    parser.add_argument("--runs", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1, help="of the study, and of --sample")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--sample", type=int, default=None, help="only so many constants, drawn at random")
    parser.add_argument("--only", default="", help="only constants whose FILE:NAME contains this")
    parser.add_argument("--same-in", type=Path, help="only constants without effect in this table")
    parser.add_argument("--out", type=Path, required=True, help="table that is written")
    parser.add_argument("--resume", action="store_true", help="keep the lines that the table has")
    asked = parser.parse_args(words)
    constants = constants_of(asked.folder)
    chosen = [n for n, item in enumerate(constants) if asked.only in f"{item.file}:{item.name}"]
    if asked.same_in is not None:
        same = without_effect(asked.same_in)
        chosen = [number for number in chosen if (constants[number].file, constants[number].name) in same]
    if asked.sample is not None:
        chosen = random.Random(asked.seed).sample(chosen, min(asked.sample, len(chosen)))
    done = {(line[0], line[1], line[3]) for line in lines_in(asked.out)} if asked.resume else set()
    sets = [word for item in asked.set for word in ("--set", item)]
    study = [asked.study, "--runs", str(asked.runs), "--seed", str(asked.seed), *sets]
    with tempfile.TemporaryDirectory(prefix="sensitivity-") as name, asked.out.open("a" if done else "w") as out:
        variants = Variants(constants, study, Path(name))
        if variants.base is None:
            print(f"sensitivity: {asked.study} did not run", file=sys.stderr)
            return 2
        if not done:
            print(*COLUMNS, sep="\t", file=out, flush=True)
        for number in sorted(chosen, key=lambda number: not can_vary(constants[number])):
            item = constants[number]
            for scale in SCALES:
                if (item.file, item.name, f"{scale:g}") not in done:
                    table = variants.run(number, scale)
                    found = WITHOUT_RESULT if table is None else effect(variants.base, table)
                    print(item.file, item.name, f"{item.value:g}", f"{scale:g}", *found, sep="\t", file=out, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
