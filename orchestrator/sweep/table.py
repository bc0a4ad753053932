"""A finished table of a study, or what is there of an unfinished one."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa  # type: ignore[import-untyped]
import pyarrow.parquet as pq  # type: ignore[import-untyped]

from orchestrator.cosim.slave import Array
from orchestrator.sweep.job import Chunk, job_from
from orchestrator.sweep.store import ABOUT
from orchestrator.text.errors import BadInput


class Table:
    """Columns as arrays, rows as they were made."""

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
        self.labels: list[str] = self.about["study"]["labels"]
        """Columns that say what a run is called, where the study has such."""
        self.count = int(self._file.metadata.num_rows)

    def column(self, name: str) -> Any:
        """Return a column as an array; outcomes and reasons as texts."""
        column = self._file.read([name]).column(0)
        return column.to_numpy()

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
