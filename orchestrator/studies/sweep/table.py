"""A finished table of a study, or what is there of an unfinished one."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from pydantic import BaseModel

from orchestrator.inputs.scenario.requirements import Requirement
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.console import say
from orchestrator.inputs.text.errors import BadInput, why_no_file
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.sweep.job import Chunk, job_from
from orchestrator.studies.sweep.store import ABOUT, sum_of

OLDER = {ABOUT, b"ARROW:schema"}
"""What tables carry that were written before they had a checksum."""


class StudyAbout(BaseModel):
    """What a table says of its study, as far as it is used."""

    name: str
    title: str = ""
    labels: list[str]
    ends: str


class TableAbout(BaseModel):
    """What a table says of itself, as far as it is used beside its job."""

    study: StudyAbout
    sources: str
    versions: dict[str, str] = {}
    job: dict[str, Any]


UNREADABLE = (ValueError, KeyError, TypeError, AttributeError, IndexError, OverflowError, RecursionError)
"""What comes of a description that has no meaning."""


class Table:
    """Columns as arrays, rows as they were made."""

    def __init__(self, path: Path) -> None:
        self.path = path
        if not path.is_file():
            raise BadInput(why_no_file(path), file=path)
        try:
            self._file = pq.ParquetFile(path, page_checksum_verification=True)
            self._schema: pa.Schema = self._file.schema_arrow
            metadata = self._schema.metadata or {}
            checksum, carried, _ = sum_of(path.read_bytes())
        except (OSError, ValueError, pa.ArrowException) as error:
            raise BadInput(f"cannot be read as a table: {_first_line(error)}", file=path) from error
        if ABOUT not in metadata:
            raise BadInput("not a study result table (.parquet)", file=path)
        if checksum != carried or (not carried and set(self._file.metadata.metadata) - OLDER):
            raise BadInput("is damaged: its bytes do not fit its checksum", file=path)
        if not carried:
            say(f"apa: warning: {path}: has no checksum over all of it; a damage in it may go unseen")
        try:
            self.about: dict[str, Any] = json.loads(metadata[ABOUT])
            TableAbout.model_validate(self.about, strict=True)
            self.job = job_from(self.about["job"])
            self.labels: list[str] = self.about["study"]["labels"]
            """Columns that say what a run is called, where the study has such."""
            self.ends: str = self.about["study"]["ends"]
            """The column that says how a run ended."""
        except UNREADABLE as error:
            text = f"does not say what its study is ({type(error).__name__}); it is damaged or of another version"
            raise BadInput(text, file=path) from error
        self.count = int(self._file.metadata.num_rows)
        self._group: tuple[int, pa.Table] | None = None

    @cached_property
    def requirements(self) -> list[Requirement]:
        """Return the requirements of the study's scenario."""
        return list(Scenario(**self.job.scenario).requirements)

    def column(self, name: str) -> Any:
        """Return a column as an array; outcomes and reasons as texts. Raises ``BadInput`` if it is damaged."""
        with self._report_damage(name):
            return self._file.read([name]).column(0).to_numpy()

    @contextmanager
    def _report_damage(self, what: str) -> Iterator[None]:
        try:
            yield
        except (OSError, ValueError, KeyError, IndexError, pa.ArrowException) as error:
            raise BadInput(f"{what} is damaged: {_first_line(error)}", file=self.path) from error

    def names(self) -> list[str]:
        """Return the names of the columns."""
        return list(self._schema.names)

    def note(self, name: str) -> tuple[str, str, dict[str, str]]:
        """Return unit, meaning and states (number as text -> name) of a column."""
        metadata = self._schema.field(name).metadata or {}
        states: dict[str, str] = json.loads(metadata.get(b"states", b"{}"))
        return metadata.get(b"unit", b"1").decode(), metadata.get(b"text", b"").decode(), states

    def row(self, number: int) -> dict[str, Any]:
        """Return one row. Raises ``BadInput`` if there is none of this number."""
        if not 0 <= number < self.count:
            raise BadInput(f"row {number}: expected 0 to {self.count - 1}", file=self.path)
        for group in range(self._file.num_row_groups):
            rows = self._file.metadata.row_group(group).num_rows
            if number < rows:
                with self._report_damage(f"row {number}"):
                    found: dict[str, Any] = self._row_group(group).slice(number, 1).to_pylist()[0]
                    return found
            number -= rows
        raise AssertionError("rows do not add up")

    def _row_group(self, group: int) -> pa.Table:
        """Return a part of the table; the last one is kept, as who asks for a row often asks for the next."""
        if self._group is None or self._group[0] != group:
            self._group = group, self._file.read_row_group(group)
        return self._group[1]

    def chunk(self, number: int) -> Chunk:
        """Return one row as the design that made it."""
        row = self.row(number)
        try:
            values: Array = np.array([[float(row[key]) for key in self.job.keys]]).reshape(1, -1)
            return Chunk(0, number, values, np.array([row["run_seed"]], dtype=np.int64))
        except UNREADABLE as error:
            raise self.unusable(number, error) from error

    def unusable(self, number: int, error: Exception) -> BadInput:
        """Return what to raise where a row cannot be made a run of."""
        text = f"row {number} does not say what its run is ({type(error).__name__}: {_first_line(error)})"
        return BadInput(text, file=self.path)


def _first_line(error: Exception) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0][:200]
