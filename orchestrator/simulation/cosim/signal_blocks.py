"""Values of a run in blocks of rows: in memory while they are few, else in a scratch file without a name.

A block is stored by columns, so that one signal of a long run is read without the others. A column that does not
change within a block takes no room; integers and flags take 4 bytes and 1 byte a value. The memory in use does not
depend on the length of a run: at most ``MEMORY_BYTES`` of values, or one block.
"""

import os
import tempfile
import weakref
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import IO, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from orchestrator.inputs.text.errors import NotRunError
from orchestrator.simulation.cosim.fmu_instance import Array

MEMORY_BYTES = 64 << 20
"""Values of a run that are kept in memory; a longer run goes to the scratch file."""
BLOCK_BYTES = 8 << 20
FIRST_ROWS = 1 << 14
"""Rows that there is room for at first."""
Times = NDArray[np.int64]
DTYPES = ("float64", "int32", "uint8")
CONSTANT = len(DTYPES)


class _Block(NamedTuple):
    """Where a block is in the scratch file."""

    first_row: int
    rows: int
    first_ns: int
    last_ns: int
    at: int
    """Of its times; the columns follow."""
    dtypes: NDArray[np.uint8]
    """Of each column: place in ``DTYPES``, or ``CONSTANT``."""
    places: NDArray[np.int64]
    """Of each column in the file."""
    first: Array
    """The first row; all there is of a constant column."""
    last: Array
    """The last row."""
    changes: NDArray[np.int64]
    """Of each column: how often it changes within the block."""


class SignalBlocks:
    """Rows of values that are appended once and read many times, whole or by column."""

    def __init__(self, names: Sequence[str], rows: int = FIRST_ROWS) -> None:
        self.names = list(names)
        self.places = {name: place for place, name in enumerate(self.names)}
        width = 8 * (len(self.names) + 1)
        self.block_rows = max(64, BLOCK_BYTES // width)
        self._memory_rows = max(self.block_rows, MEMORY_BYTES // width)
        room = max(1, min(rows, FIRST_ROWS, self._memory_rows))
        self._rows, self._times = np.empty((room, len(self.names))), np.empty(room, dtype=np.int64)
        self._filled = 0
        self._blocks: list[_Block] = []
        self._scratch: IO[bytes] | None = None
        self.count = 0
        """How many rows there are."""

    def append(self, t_ns: int, values: Array) -> None:
        """Add one row. Raises ``NotRunError`` if there is no memory or no scratch space left."""
        if self._filled == len(self._times):
            self._make_room()
        self._times[self._filled] = t_ns
        self._rows[self._filled] = values
        self._filled += 1
        self.count += 1

    def extend(self, times: Times, rows: Array) -> None:
        """Add rows (n, names)."""
        begin = 0
        while begin < len(times):
            if self._filled == len(self._times):
                self._make_room()
            end = min(len(times), begin + len(self._times) - self._filled)
            filled = self._filled + end - begin
            self._times[self._filled : filled], self._rows[self._filled : filled] = times[begin:end], rows[begin:end]
            self._filled = filled
            self.count += end - begin
            begin = end

    @property
    def is_stored(self) -> bool:
        """Return whether there are so many rows that they are in the scratch file."""
        return self._scratch is not None

    @property
    def times(self) -> Times:
        """Return the times [ns] of rows in memory."""
        return self._times[: self._filled]

    @property
    def columns(self) -> dict[str, Array]:
        """Return the columns of rows in memory."""
        return dict(zip(self.names, self._rows[: self._filled].T, strict=True))

    def complete(self) -> None:
        """Store what is still in memory of a long run."""
        if self.is_stored and self._filled:
            self._store()

    def ranges(self) -> list[tuple[int, int]]:
        """Return first row and end of each block."""
        return [(block.first_row, block.first_row + block.rows) for block in self._blocks]

    def changes(self) -> dict[str, int]:
        """Return how often each stored signal changes."""
        counts = sum((block.changes for block in self._blocks), np.zeros(len(self.names), dtype=np.int64))
        for before, after in pairwise(self._blocks):
            counts = counts + (before.last.view(np.int64) != after.first.view(np.int64))
        return {name: int(counts[place]) for name, place in self.places.items()}

    def change_rows(self, name: str) -> NDArray[np.intp]:
        """Return the rows at which a stored signal has another value than in the row before."""
        place, found = self.places[name], []
        before: _Block | None = None
        for block in self._blocks:
            if before is not None and before.last[place].tobytes() != block.first[place].tobytes():
                found.append(np.array([block.first_row]))
            if block.changes[place]:
                bits = self._read(block, place, 0, block.rows).view(np.int64)
                found.append(block.first_row + 1 + np.flatnonzero(bits[1:] != bits[:-1]))
            before = block
        return np.concatenate([np.empty(0, dtype=np.intp), *found])

    def column(self, name: str, first: int = 0, end: int | None = None) -> Array:
        """Return values of a stored signal, from row ``first`` up to ``end``."""
        end = self.count if end is None else end
        place = self.places[name]
        values = np.empty(max(0, end - first))
        for block, begin, stop in self._blocks_between(first, end):
            values[block.first_row + begin - first : block.first_row + stop - first] = self._read(
                block, place, begin, stop
            )
        return values

    def times_of(self, first: int = 0, end: int | None = None) -> Times:
        """Return stored times [ns], from row ``first`` up to ``end``."""
        end = self.count if end is None else end
        times = np.empty(max(0, end - first), dtype=np.int64)
        for block, begin, stop in self._blocks_between(first, end):
            at = block.first_row - first
            times[at + begin : at + stop] = self._values(block.at, "int64", begin, stop)
        return times

    def row_at(self, t_ns: float, side: str = "left") -> int:
        """Return the row before which ``t_ns`` would be inserted (see ``numpy.searchsorted``)."""
        for block in self._blocks:
            if t_ns < block.last_ns or (side == "left" and t_ns == block.last_ns):
                times = self._values(block.at, "int64", 0, block.rows)
                return block.first_row + int(np.searchsorted(times, t_ns, side=side))  # type: ignore[call-overload]
        return self.count

    def _blocks_between(self, first: int, end: int) -> Iterator[tuple[_Block, int, int]]:
        for block in self._blocks:
            begin, stop = max(first - block.first_row, 0), min(end - block.first_row, block.rows)
            if begin < stop:
                yield block, begin, stop

    def _read(self, block: _Block, place: int, begin: int, stop: int) -> Array:
        kind = int(block.dtypes[place])
        if kind == CONSTANT:
            return np.full(stop - begin, block.first[place])
        return self._values(int(block.places[place]), DTYPES[kind], begin, stop).astype(np.float64, copy=False)

    def _values(self, at: int, dtype: str, begin: int, stop: int) -> NDArray[Any]:
        assert self._scratch is not None
        size = np.dtype(dtype).itemsize
        self._scratch.seek(at + begin * size)
        data = self._scratch.read((stop - begin) * size)
        return np.frombuffer(data, dtype=dtype)

    def _make_room(self) -> None:
        try:
            if not self.is_stored and len(self._times) < self._memory_rows:
                room = min(2 * len(self._times), self._memory_rows)
                rows, times = np.empty((room, len(self.names))), np.empty(room, dtype=np.int64)
                rows[: self._filled], times[: self._filled] = self._rows, self._times
                self._rows, self._times = rows, times
            else:
                self._store()
        except MemoryError:
            raise NotRunError(f"after {self.count} exchanges there is no memory for more") from None

    def _store(self) -> None:
        """Move the rows in memory to the scratch file."""
        try:
            if self._scratch is None:
                self._scratch = tempfile.TemporaryFile(prefix="apa-cosim-")  # noqa: SIM115 - it lives as long as this
                weakref.finalize(self, self._scratch.close)
            for begin in range(0, self._filled, self.block_rows):
                end = min(self._filled, begin + self.block_rows)
                self._store_block(self._times[begin:end], self._rows[begin:end])
            self._scratch.flush()
        except OSError as error:
            folder = tempfile.gettempdir()
            raise NotRunError(
                f"after {self.count} exchanges there is no scratch space for more in {folder} "
                f"({error.strerror}); TMPDIR chooses another folder"
            ) from error
        self._filled = 0
        if len(self._times) > self.block_rows:
            self._rows = np.empty((self.block_rows, len(self.names)))
            self._times = np.empty(self.block_rows, dtype=np.int64)

    def _store_block(self, times: Times, rows: Array) -> None:
        assert self._scratch is not None
        first_row = self._blocks[-1].first_row + self._blocks[-1].rows if self._blocks else 0
        start = at = self._scratch.seek(0, os.SEEK_END)
        at += self._scratch.write(times.tobytes())
        width = len(self.names)
        dtypes, places = np.zeros(width, dtype=np.uint8), np.zeros(width, dtype=np.int64)
        changes = np.zeros(width, dtype=np.int64)
        for place in range(width):
            values = np.ascontiguousarray(rows[:, place])
            dtypes[place], places[place] = _dtype_of(values), at
            bits = values.view(np.int64)
            changes[place] = np.count_nonzero(bits[1:] != bits[:-1])
            if dtypes[place] != CONSTANT:
                at += self._scratch.write(values.astype(DTYPES[dtypes[place]], copy=False).tobytes())
        span, ends = (int(times[0]), int(times[-1])), (rows[0].copy(), rows[-1].copy())
        self._blocks.append(_Block(first_row, len(times), *span, start, dtypes, places, *ends, changes))


def _dtype_of(values: Array) -> int:
    """Return how a column is stored without loss: bit for bit, so that also -0.0 and the kind of NaN are kept."""
    bits = values.view(np.int64)
    if (bits == bits[0]).all():
        return CONSTANT
    low, high = values.min(), values.max()  # NaN if one of them is
    for kind, (least, most) in ((2, (0, 255)), (1, (-(2**31), 2**31 - 1))):
        if low >= least and high <= most and (values.astype(DTYPES[kind]).astype(float).view(np.int64) == bits).all():
            return kind
    return 0


class BlockSignals(Mapping[str, Array]):
    """Stored signals from one row up to another: each is read on demand."""

    def __init__(self, blocks: SignalBlocks, first: int = 0, end: int | None = None) -> None:
        self._blocks = blocks
        self._range = first, blocks.count if end is None else end

    def __getitem__(self, name: str) -> Array:
        if name not in self._blocks.places:
            raise KeyError(name)
        return self._blocks.column(name, *self._range)

    def __iter__(self) -> Iterator[str]:
        return iter(self._blocks.places)

    def __len__(self) -> int:
        return len(self._blocks.places)

    def __contains__(self, name: object) -> bool:
        return name in self._blocks.places
