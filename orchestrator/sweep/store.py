"""The parts of an unfinished study, written while it runs and joined to one Parquet file at the end.

A part is one chunk, written beside its place and renamed, so that a part that is there is complete.
The columns carry units and meanings; the file carries the study, the scenario and all that a row
needs to be run again. Nothing in it depends on when, where or in which order the runs were made.
"""

import json
import shutil
from pathlib import Path
from typing import Any

import pyarrow as pa  # type: ignore[import-untyped]
import pyarrow.parquet as pq  # type: ignore[import-untyped]

from orchestrator.sweep.columns import Column
from orchestrator.text.errors import BadInput

ABOUT = b"apa"
TYPES = {float: pa.float64(), int: pa.int64(), bool: pa.bool_(), str: pa.string()}


class Store:
    """The parts of one unfinished study in ``folder/parts`` and its table ``folder/NAME.parquet``."""

    def __init__(self, folder: Path, name: str, columns: list[Column], about: dict[str, Any]) -> None:
        self.table = folder / f"{name}.parquet"
        self.parts = folder / "parts"
        self._about = self.parts / "about.json"
        self._text = json.dumps(about, sort_keys=True)
        self.schema = pa.schema([_field(column) for column in columns], metadata={ABOUT: self._text})

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

    def write(self, number: int, columns: dict[str, Any]) -> None:
        """Write the part of one chunk, its ``columns`` by name."""
        part = self._part(number)
        beside = part.with_suffix(".part")
        arrays = [pa.array(columns[field.name]).cast(field.type) for field in self.schema]
        pq.write_table(pa.table(arrays, schema=self.schema), beside, compression="zstd")
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


def _field(column: Column) -> Any:
    signal = column.signal
    states = {} if signal.states is None else {str(int(state)): state.name for state in signal.states}
    metadata = {"unit": signal.unit, "text": signal.text, **({"states": json.dumps(states)} if states else {})}
    return pa.field(column.name, TYPES[column.kind], metadata=metadata)
