"""The table of a study: parts written while it runs, joined to one Parquet file at the end.

A part is one chunk, written beside its place and renamed, so that a part that is there is complete.
The columns carry units and meanings; the file carries the study, the scenario and all that a row
needs to be run again. Nothing in it depends on when, where or in which order the runs were made.
"""

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa  # type: ignore[import-untyped]
import pyarrow.parquet as pq  # type: ignore[import-untyped]

from modelkit.variables import Variable, variables
from orchestrator.cosim.slave import Array
from orchestrator.scenario.models import MODELS
from orchestrator.scenario.scenario import Target
from orchestrator.sweep.fields import Field
from orchestrator.sweep.job import Chunk, Job
from orchestrator.sweep.verdict import OUTCOMES, RESULTS, Verdict
from orchestrator.text.errors import BadInput
from orchestrator.verdict.measures import Measure

ABOUT = b"apa"
TYPES = {float: pa.float64(), int: pa.int64(), bool: pa.bool_()}
OUTCOME_TYPE = pa.dictionary(pa.int8(), pa.string())


class Store:
    """The parts of one unfinished study in ``folder/parts`` and its table ``folder/NAME.parquet``."""

    def __init__(self, folder: Path, name: str, fields: list[Field], numbers: list[str], about: dict[str, Any]) -> None:
        self.table = folder / f"{name}.parquet"
        self.parts = folder / "parts"
        self._about = self.parts / "about.json"
        self._text = json.dumps(about, sort_keys=True)
        self._fields = fields
        self._numbers = numbers
        self.schema = _schema(fields, numbers, self._text)

    def begin(self, chunk_size: int, *, resume: bool, restart: bool) -> int:
        """Make ready; return the chunk size to use, which is the first start's when going on.

        Raises ``BadInput`` if there are parts and neither ``resume`` nor ``restart`` says what to do with
        them, or if they are of another study.
        """
        if restart:
            shutil.rmtree(self.parts, ignore_errors=True)
        if not self._about.is_file():
            self.parts.mkdir(parents=True, exist_ok=True)
            beside = self._about.with_suffix(".part")
            beside.write_text(json.dumps({"chunk": chunk_size, "about": json.loads(self._text)}), encoding="utf-8")
            beside.replace(self._about)
            return chunk_size
        if not resume:
            raise BadInput("has an unfinished study; --resume goes on, --restart throws its runs away", file=self.parts)
        found = json.loads(self._about.read_text(encoding="utf-8"))
        if json.dumps(found["about"], sort_keys=True) != self._text:
            changed = [key for key, value in json.loads(self._text).items() if found["about"].get(key) != value]
            raise BadInput(
                f"its runs were made with another {' and '.join(changed)}; --restart throws them away", file=self.parts
            )
        return int(found["chunk"])

    def has(self, number: int) -> bool:
        """Return whether the chunk of that number is complete."""
        return self._part(number).is_file()

    def write(self, chunk: Chunk, verdict: Verdict) -> None:
        """Write the part of one chunk."""
        columns: dict[str, Any] = {"row": pa.array(np.arange(chunk.first, chunk.first + len(chunk.seeds)))}
        for place, field in enumerate(self._fields):
            columns[field.key] = pa.array(chunk.values[:, place].astype(field.variable.kind))
        columns["run_seed"] = pa.array(chunk.seeds)
        columns["outcome"] = pa.DictionaryArray.from_arrays(pa.array(verdict.outcome), pa.array(OUTCOMES))
        columns["reason"] = pa.array(verdict.reason)
        columns.update({name: _number(name, verdict.numbers[name]) for name in self._numbers})
        part = self._part(chunk.number)
        beside = part.with_suffix(".part")
        pq.write_table(pa.table(columns, schema=self.schema), beside, compression="zstd")
        beside.replace(part)

    def finish(self, count: int) -> Path:
        """Join ``count`` parts to the table, remove them, return its path."""
        beside = self.table.with_suffix(".parquet.part")
        with pq.ParquetWriter(beside, self.schema, compression="zstd") as writer:
            for number in range(count):
                writer.write_table(pq.read_table(self._part(number)).cast(self.schema))
        beside.replace(self.table)
        shutil.rmtree(self.parts)
        return self.table

    def _part(self, number: int) -> Path:
        return self.parts / f"{number:08d}.parquet"


class Table:
    """A finished table, or what is there of an unfinished one."""

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            self._file = pq.ParquetFile(path)
        except (OSError, pa.ArrowInvalid) as error:
            raise BadInput(f"cannot be read as a table: {error}", file=path) from error
        metadata = self._file.schema_arrow.metadata or {}
        if ABOUT not in metadata:
            raise BadInput("is no table of a study", file=path)
        self.about: dict[str, Any] = json.loads(metadata[ABOUT])
        self.job = job_from(self.about["job"])
        self.count = int(self._file.metadata.num_rows)

    def column(self, name: str) -> Any:
        """Return a column as an array; outcomes and reasons as texts."""
        column = self._file.read([name]).column(0)
        return column.cast(pa.string()).to_numpy(zero_copy_only=False) if _texts(column.type) else column.to_numpy()

    def names(self) -> list[str]:
        """Return the names of the columns."""
        return list(self._file.schema_arrow.names)

    def note(self, name: str) -> tuple[str, str, dict[str, str]]:
        """Return unit, meaning and states (number as text -> name) of a column."""
        metadata = self._file.schema_arrow.field(name).metadata or {}
        states: dict[str, str] = json.loads(metadata.get(b"states", b"{}"))
        return metadata.get(b"unit", b"1").decode(), metadata.get(b"text", b"").decode(), states

    def row(self, number: int) -> dict[str, Any]:
        """Return one row. Raises ``BadInput`` if there is none of this number."""
        if not 0 <= number < self.count:
            raise BadInput(f"row {number}: expected 0 to {self.count - 1}", file=self.path)
        for group in range(self._file.num_row_groups):
            rows = self._file.metadata.row_group(group).num_rows
            if number < rows:
                found: dict[str, Any] = self._file.read_row_group(group).slice(number, 1).to_pylist()[0]
                return found
            number -= rows
        raise AssertionError("rows do not add up")

    def chunk(self, number: int) -> Chunk:
        """Return one row as the design that made it."""
        row = self.row(number)
        values: Array = np.array([[float(row[key]) for key in self.job.keys]]).reshape(1, -1)
        return Chunk(0, number, values, np.array([row["run_seed"]], dtype=np.int64))


def chunks(values: Array, seeds: Any, size: int) -> Iterator[Chunk]:
    """Yield the design in chunks of ``size`` runs."""
    for number, first in enumerate(range(0, len(seeds), size)):
        yield Chunk(number, first, values[first : first + size], seeds[first : first + size])


def job_to(job: Job) -> dict[str, Any]:
    """Return a job as plain data for JSON."""
    return job._asdict()


def job_from(data: dict[str, Any]) -> Job:
    """Return the job that :func:`job_to` wrote."""
    if "target" not in data["scenario"]:
        data = {**data, "scenario": {**data["scenario"], "target": _told_target(data["scenario"]["controller"])}}
    seeded = [(owner, name, int(place)) for owner, name, place in data["seeded"]]
    return Job(**{**data, "seeded": seeded, "measures": [Measure(*item) for item in data["measures"]]})


def _told_target(controller: dict[str, Any]) -> dict[str, float]:
    """Return the target of a table of an older version, which judged by what the controller was told."""
    starts = {item.name: float(item.start) for item in variables(MODELS["controller"].params)}
    return {name: float(controller.get(f"target.{name}", starts[f"target.{name}"])) for name in Target.model_fields}


def _schema(fields: list[Field], numbers: list[str], about: str) -> Any:
    columns = [pa.field("row", pa.int64(), metadata={"unit": "1", "text": "number of the run, from 0"})]
    columns += [_design_field(field.key, field.variable) for field in fields]
    columns.append(pa.field("run_seed", pa.int64(), metadata={"unit": "1", "text": "seed of the run"}))
    columns.append(pa.field("outcome", OUTCOME_TYPE, metadata={"unit": "1", "text": "as in summary.json"}))
    columns.append(pa.field("reason", pa.string(), metadata={"unit": "1", "text": "as in summary.json"}))
    for name in numbers:
        kind = pa.int64() if name == "shifts" else pa.float64()
        columns.append(pa.field(name, kind, metadata={"unit": RESULTS[name].unit, "text": RESULTS[name].text}))
    return pa.schema(columns, metadata={ABOUT: about})


def _design_field(key: str, variable: Variable) -> Any:
    signal = variable.signal
    states = {} if signal.states is None else {str(int(state)): state.name for state in signal.states}
    metadata = {"unit": signal.unit, "text": signal.text, "states": json.dumps(states)}
    return pa.field(key, TYPES[variable.kind], metadata=metadata)


def _number(name: str, values: Array) -> Any:
    return pa.array(np.nan_to_num(values).astype(np.int64) if name == "shifts" else values)


def _texts(kind: Any) -> bool:
    return bool(pa.types.is_dictionary(kind) or pa.types.is_string(kind))
