"""The parts of an unfinished study, written while it runs and joined to one Parquet file at the end.

A part is one chunk, written beside its place and renamed, so that a part that is there is complete. It carries what
the study is: a part of another study is refused.
The columns carry units and meanings; the file carries the study, the scenario and all that a row
needs to be run again. Nothing in it depends on when, where or in which order the runs were made.
"""

import hashlib
import json
import re
import shutil
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from fmus.files import whole, write_whole
from orchestrator.inputs.text.errors import BadInput
from orchestrator.studies.sweep.columns import TableColumn

ABOUT, CHECKSUM = b"apa", "apa.checksum"
EMPTY_CHECKSUM = b"0" * 64
CARRIED = re.compile(rb"apa\.checksum.{1,4}?([0-9a-f]{64})", re.DOTALL)
LIVE_SUFFIX = "-live.html"
"""End of the name of the page that replays rows of a table."""
WRITTEN: dict[str, Any] = {"compression": "zstd", "write_page_checksum": True}
TYPES = {float: pa.float64(), int: pa.int64(), bool: pa.bool_(), str: pa.string()}


class Store:
    """The parts of one unfinished study in ``folder/parts`` and its table ``folder/NAME.parquet``."""

    def __init__(self, folder: Path, name: str, columns: list[TableColumn], about: dict[str, Any]) -> None:
        self.table = folder / f"{name}.parquet"
        self.parts = folder / "parts"
        self._gone = folder / "parts.gone"
        self._about = self.parts / "about.json"
        self._text = json.dumps(about, sort_keys=True)
        self.schema = pa.schema([_field(column) for column in columns], metadata={ABOUT: self._text})
        self._size = 0

    def begin(self, chunk_size: int, *, resume: bool, restart: bool) -> int:
        """Make ready; return the chunk size to use, which is the first start's when going on.

        Raises ``BadInput`` if there are parts and neither ``resume`` nor ``restart`` says what to do with
        them, or if they are of another study.
        """
        shutil.rmtree(self._gone, ignore_errors=True)
        if restart:
            self._forget()
        self._size = self._chunk_size_on_disk(resume) or chunk_size
        if not self._about.is_file():
            content = json.dumps({"chunk": chunk_size, "about": json.loads(self._text)})
            write_whole(self._about, content, sync=True)
        return self._size

    def _chunk_size_on_disk(self, resume: bool) -> int:
        """Return the chunk size of the parts that are there, 0 if there are none."""
        if not self._about.is_file():
            if any(self.parts.glob("*.parquet")):
                raise BadInput("has runs of a study that is not known; --restart throws them away", file=self.parts)
            before = self._about_of_table()
            if resume and before not in (b"", b"?"):
                self._check_same(json.loads(before), self.table)
            return 0
        if not resume:
            raise BadInput("has an unfinished study; --resume goes on, --restart throws its runs away", file=self.parts)
        try:
            found = json.loads(self._about.read_text(encoding="utf-8"))
            about, size = dict(found["about"]), int(found["chunk"])
        except (ValueError, KeyError, TypeError) as error:
            raise BadInput("is damaged; --restart throws the runs away", file=self._about) from error
        self._check_same(about, self.parts)
        return max(size, 1)

    def _check_same(self, about: dict[str, Any], file: Path) -> None:
        """Raise ``BadInput`` if what a file says about its study is not this study."""
        changed = different_keys(about, json.loads(self._text))
        if changed:
            text = f"its runs were made with another {' and '.join(changed)}; --restart throws them away"
            raise BadInput(text, file=file)

    def has(self, number: int) -> bool:
        """Return whether the chunk of that number is complete; one that is damaged is not.

        Raises ``BadInput`` if it is of another study.
        """
        part = self._part(number)
        if not part.is_file():
            return False
        data = pa.BufferReader(part.read_bytes())
        try:
            about = (pq.read_schema(data).metadata or {}).get(ABOUT, b"")
        except MemoryError:
            raise
        except (OSError, pa.ArrowException):
            return False
        if about != self._text.encode():
            raise BadInput("is of another study; --restart throws all runs away", file=part)
        return True

    def is_finished(self) -> bool:
        """Return whether the table of just this study is there, and nothing of it is in parts."""
        return not self._about.is_file() and self._about_of_table() == self._text.encode()

    def write(self, number: int, columns: dict[str, Any]) -> None:
        """Write the part of one chunk, its ``columns`` by name; it outlives a power cut."""
        arrays = [pa.array(columns[field.name]).cast(field.type) for field in self.schema]
        with whole(self._part(number), sync=True) as part:
            pq.write_table(pa.table(arrays, schema=self.schema), part, **WRITTEN)

    def finish(self, count: int) -> Path:
        """Join ``count`` parts to the table, remove them, return its path.

        Pages and repeated rows of another table in its place are removed or renamed: they would tell of that.
        """
        with whole(self.table, sync=True) as beside:
            with pq.ParquetWriter(beside, self.schema, **WRITTEN) as writer:
                for number in range(count):
                    writer.write_table(self._read(number))
                writer.add_key_value_metadata({CHECKSUM: EMPTY_CHECKSUM.decode()})
            _put_sum(beside)
            if self._about_of_table() not in (b"", self._text.encode()):
                forget_made_of(self.table)
        self._forget()
        return self.table

    def _read(self, number: int) -> Any:
        """Return a part. Raises ``BadInput`` if it is damaged; then it is gone, to be made again."""
        part = self._part(number)
        data = pa.BufferReader(part.read_bytes())  # what cannot be read for lack of memory or files is not damaged
        try:
            found = pq.read_table(data, page_checksum_verification=True, use_threads=False).cast(self.schema)
            first = number * self._size
            if found.column("row").to_pylist() != list(range(first, first + len(found))):
                raise ValueError("other rows")
        except MemoryError:
            raise
        except (OSError, ValueError, pa.ArrowException) as error:
            part.unlink(missing_ok=True)
            text = "was damaged and is removed; --resume makes its runs again"
            raise BadInput(text, file=part) from error
        return found

    def _about_of_table(self) -> bytes:
        try:
            return bytes((pq.read_schema(self.table).metadata or {}).get(ABOUT, b"?"))
        except FileNotFoundError:
            return b""
        except (OSError, pa.ArrowException):
            return b"?"

    def _forget(self) -> None:
        """Remove the parts at one stroke: a kill leaves all of them, or none."""
        if self.parts.is_dir():
            shutil.rmtree(self._gone, ignore_errors=True)
            self.parts.rename(self._gone)
        shutil.rmtree(self._gone, ignore_errors=True)

    def _part(self, number: int) -> Path:
        return self.parts / f"{number:08d}.parquet"


def different_keys(before: dict[str, Any], now: dict[str, Any]) -> list[str]:
    """Return the keys in which two descriptions differ."""
    return sorted(key for key in before.keys() | now.keys() if before.get(key) != now.get(key))


def sum_of(data: bytes) -> tuple[bytes, bytes, int]:
    """Return the checksum of a table, the one it carries, and where; empty and -1 if it carries none.

    It is one over every byte, its own as zeros: pages have checksums in Parquet, what describes them has none.
    """
    found = CARRIED.search(data, max(0, len(data) - 8 - int.from_bytes(data[-8:-4], "little")))
    if found is None:
        return b"", b"", -1
    rest = hashlib.sha256(data[: found.start(1)] + EMPTY_CHECKSUM + data[found.end(1) :])
    return rest.hexdigest().encode(), found[1], found.start(1)


def _put_sum(table: Path) -> None:
    checksum, _, at = sum_of(table.read_bytes())
    with table.open("r+b") as file:
        file.seek(at)
        file.write(checksum)


def forget_made_of(table: Path) -> None:
    """Remove the pages of an older table, and call its repeated rows ``row-N.older``."""
    table.with_suffix(".html").unlink(missing_ok=True)
    table.with_name(f"{table.stem}{LIVE_SUFFIX}").unlink(missing_ok=True)
    for row in table.parent.glob("row-*"):
        if row.suffix != ".older" and (row / "scenario.yaml").is_file():
            older = row.with_name(f"{row.name}.older")
            shutil.rmtree(older, ignore_errors=True)
            row.rename(older)


def _field(column: TableColumn) -> Any:
    signal = column.signal
    states = {str(int(state)): state.name for state in signal.states or ()}
    states |= {str(value): name for value, name in enumerate(column.choices)}
    metadata = {"unit": signal.unit, "text": signal.text, **({"states": json.dumps(states)} if states else {})}
    return pa.field(column.name, TYPES[column.kind], metadata=metadata)
