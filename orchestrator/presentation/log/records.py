"""The records of an MCAP file: the only door by which one is read.

A log is believed only if every byte of it is under a checksum that is right: that of all data, in the record DataEnd,
and that of the summary behind it, in the footer. What a file claims about sizes is looked at before it is done.
A file is read one record at a time, so memory does not grow with it. Format: mcap.dev/spec.
"""

import struct
import zlib
from collections.abc import Iterator
from contextlib import AbstractContextManager
from io import BufferedReader
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC

from orchestrator.inputs.text.errors import BadInput, lacks_resources, why_no_file

HEAD = struct.Struct("<BQ")
CHUNK = struct.Struct("<QQQII")
"""First and last time, size and checksum of what is in a chunk, length of the compression's name."""
MESSAGE = struct.Struct("<HIQQ")
FOOTER = struct.Struct("<QQI")
MAX_CHUNK_BYTES = 1 << 26
"""Of one record, packed or unpacked; chunks of this project have 256 KiB."""
MOST_UNPACKED, MOST_TIMES = 1 << 30, 64
"""A log may unpack to so many bytes, or to so many times its size if that is more."""
READ_BYTES = 1 << 20
"""Bytes that are read at once where a whole file is gone through."""


class Damage(Exception):  # noqa: N818 - what is wrong with a file, and where
    """What is wrong at a byte of a file."""

    def __init__(self, at: int, text: str) -> None:
        super().__init__(f"byte {at}: {text}")
        self.at = at


class RawRecord(NamedTuple):
    """One record."""

    at: int
    """Its first byte in the file; of one in a chunk, that of the chunk."""
    opcode: int
    body: Any
    """Its bytes."""


class RecordHead(NamedTuple):
    """A record of a file without its bytes."""

    at: int
    opcode: int
    size: int

    @property
    def end(self) -> int:
        """Return the byte behind it."""
        return self.at + HEAD.size + self.size


class ByteSource(Protocol):
    """Bytes that are read piece by piece: a file, or ``bytes``."""

    def __len__(self) -> int:
        """Return how many there are."""

    def __getitem__(self, part: slice) -> bytes:
        """Return some of them."""

    def find(self, mark: bytes, begin: int) -> int:
        """Return where ``mark`` is, from ``begin`` on; -1 if it is not there."""


class LogFile(AbstractContextManager["LogFile"]):
    """The bytes of a log, read when they are asked for. Raises ``BadInput`` if that cannot be."""

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            if not path.is_file():
                raise BadInput(why_no_file(path), file=path)
            self._size = path.stat().st_size
            self._file: BufferedReader = path.open("rb")
        except OSError as error:
            raise BadInput(f"cannot be read: {error.strerror}", file=path) from error
        if self[: len(MCAP0_MAGIC)] != MCAP0_MAGIC:
            self._file.close()
            raise BadInput("is no MCAP log", file=path)

    def __exit__(self, *_: object) -> None:
        self._file.close()

    def __len__(self) -> int:
        return self._size

    def __getitem__(self, part: slice) -> bytes:
        begin, end, _ = part.indices(self._size)
        try:
            self._file.seek(begin)
            return self._file.read(max(0, end - begin))
        except OSError as error:
            raise BadInput(f"cannot be read: {error.strerror}", file=self._path) from error

    def find(self, mark: bytes, begin: int) -> int:
        """Return where ``mark`` is, from ``begin`` on; -1 if it is not there."""
        for at in range(begin, self._size, READ_BYTES):
            found = self[at : at + READ_BYTES + len(mark) - 1].find(mark)
            if found >= 0:
                return at + found
        return -1


def check(data: ByteSource) -> bool:
    """Return whether all of a whole file is under a checksum; chunks stay packed. Raises ``Damage``."""
    if len(data) < 2 * len(MCAP0_MAGIC) or data[-len(MCAP0_MAGIC) :] != MCAP0_MAGIC:
        raise Damage(len(data), "the file ends before the log does")
    last, end, footer = len(MCAP0_MAGIC), None, None
    for head in record_heads(data):
        last = head.at
        if end is not None:
            footer = head
        elif head.opcode == Opcode.DATA_END:
            end = head
    if end is None:
        raise Damage(last, "there is no end of the data")
    (crc,) = _unpack(struct.Struct("<I"), read_record(data, end))
    if crc and crc != _crc(data, 0, end.at):
        raise Damage(_first_wrong(data, end.at), "the checksum of the data is wrong")
    return _check_summary(data, footer, end) and bool(crc)


def iterate_records(data: ByteSource) -> Iterator[RawRecord]:
    """Yield the records of a whole file up to the end of the data, one chunk unpacked at a time. Raises ``Damage``.

    The indexes of messages are left out.
    """
    for item in iterate_chunks(data):
        yield from _records_in(item.body, item.at) if item.opcode == Opcode.CHUNK else (item,)


def iterate_chunks(data: ByteSource) -> Iterator[RawRecord]:
    """Yield the records of a whole file up to the end of the data; of a chunk the body is what it unpacks to."""
    budget = max(MOST_UNPACKED, MOST_TIMES * len(data))
    for head in record_heads(data):
        if head.opcode == Opcode.DATA_END:
            return
        if head.opcode == Opcode.CHUNK:
            content = _chunk_bytes(read_record(data, head), budget)
            budget -= len(content)
            yield RawRecord(head.at, head.opcode, content)
        elif head.opcode != Opcode.MESSAGE_INDEX:
            yield read_record(data, head)


def _crc(data: ByteSource, begin: int, end: int) -> int:
    crc = 0
    for at in range(begin, end, READ_BYTES):
        crc = zlib.crc32(data[at : min(end, at + READ_BYTES)], crc)
    return crc


def record_heads(data: ByteSource) -> Iterator[RecordHead]:
    """Yield the records of a file without their bytes. Raises ``Damage`` where there is none."""
    at, end = len(MCAP0_MAGIC), len(data) - len(MCAP0_MAGIC)
    while at < end:
        head = record_head(data[at : min(end, at + HEAD.size)], at, end - at)
        yield head
        at = head.end


def record_head(head: bytes, at: int, room: int) -> RecordHead:
    """Return the record whose first bytes are ``head``, where ``room`` bytes are left. Raises ``Damage``."""
    if HEAD.size > min(room, len(head)):
        raise Damage(at, "the file ends in a record")
    opcode, length = HEAD.unpack_from(head)
    if not 0 < opcode < 128:
        raise Damage(at, "there is no record here")
    if length > room - HEAD.size:
        raise Damage(at, "the record here is cut off, or its length is damaged")
    return RecordHead(at, opcode, length)


def read_record(data: ByteSource, head: RecordHead) -> RawRecord:
    """Return a record with its bytes. Raises ``Damage`` if there are more than any record has."""
    if head.size > MAX_CHUNK_BYTES:
        raise Damage(head.at, f"a record has {head.size} bytes, more than the {MAX_CHUNK_BYTES} that one may have")
    return RawRecord(head.at, head.opcode, data[head.at + HEAD.size : head.end])


def chunk_records(piece: RawRecord) -> Iterator[RawRecord]:
    """Yield the records of a chunk. Raises ``Damage`` if it is not what its checksum says, or has more than may be."""
    yield from _records_in(_chunk_bytes(piece, MOST_UNPACKED), piece.at)


def _records_in(content: bytes, place: int) -> Iterator[RawRecord]:
    """Yield the records of what a chunk at byte ``place`` unpacks to. Raises ``Damage``."""
    data = memoryview(content)
    at = 0
    while at < len(data):
        head = record_head(bytes(data[at : at + HEAD.size]), place, len(data) - at)
        begin = at + HEAD.size
        at = begin + head.size
        yield RawRecord(place, head.opcode, data[begin:at])


def chunk_times(piece: RawRecord) -> tuple[int, int]:
    """Return first and last time [ns] that a chunk says of itself."""
    first, last, *_ = _unpack(CHUNK, piece)
    return int(first), int(last)


def _chunk_bytes(piece: RawRecord, budget: int) -> bytes:
    _, _, size, crc, letters = _unpack(CHUNK, piece)
    at = CHUNK.size + letters
    if letters > 16 or at + 8 > len(piece.body):
        raise Damage(piece.at, "a chunk has no compression that is known")
    compression = bytes(piece.body[CHUNK.size : at])
    packed = bytes(piece.body[at + 8 :])
    if int.from_bytes(piece.body[at : at + 8], "little") != len(packed):
        raise Damage(piece.at, "a chunk has another length than it says")
    if size > min(budget, MAX_CHUNK_BYTES):
        raise Damage(piece.at, f"a chunk is declared to unpack to {size} bytes, more than a log may have")
    data = _decompress(piece.at, compression, packed, size)
    if len(data) != size or (crc and zlib.crc32(data) != crc):
        raise Damage(piece.at, "the checksum of a chunk is wrong")
    return data


def _decompress(at: int, compression: bytes, packed: bytes, size: int) -> bytes:
    """Return what is packed, of which there are to be ``size`` bytes."""
    if not compression:
        return packed
    if compression != b"zstd":
        raise Damage(at, f"compression {compression.decode(errors='replace')!r} is not known here, only zstd")
    try:
        said = zstandard.frame_content_size(packed)
        if said not in (-1, size):
            raise Damage(at, "a chunk unpacks to another size than it says")
        unpacker = zstandard.ZstdDecompressor(max_window_size=MAX_CHUNK_BYTES)
        with unpacker.stream_reader(packed) as stream:
            return stream.read(size + 1)
    except (zstandard.ZstdError, MemoryError) as error:
        raise Damage(at, f"a chunk cannot be unpacked ({error})") from error


def _check_summary(data: ByteSource, footer: RecordHead | None, end: RecordHead) -> bool:
    """Return whether the summary behind ``end`` has a checksum; raise ``Damage`` if it is wrong."""
    if footer is None or footer.opcode != Opcode.FOOTER:
        raise Damage(end.end, "there is no footer")
    start, _, crc = _unpack(FOOTER, read_record(data, footer))
    if start not in (0, end.end):
        raise Damage(footer.at, "the footer tells another place of the summary")
    if crc and crc != _crc(data, end.end, footer.at + HEAD.size + FOOTER.size - 4):
        raise Damage(end.end, "the checksum of the summary is wrong")
    return bool(crc)


def _first_wrong(data: ByteSource, end: int) -> int:
    """Return where the damage is before byte ``end``, as far as chunks tell; else where the data begin."""
    for head in record_heads(data):
        if head.at < end and head.opcode == Opcode.CHUNK:
            try:
                _chunk_bytes(read_record(data, head), MOST_UNPACKED)
            except Damage as damage:
                return damage.at
    return len(MCAP0_MAGIC)


def _unpack(layout: struct.Struct, piece: RawRecord) -> Any:
    if len(piece.body) < layout.size:
        raise Damage(piece.at, "a record is too short")
    return layout.unpack_from(piece.body)


def parse_record(record: Any, piece: RawRecord) -> Any:
    """Return a record as a class of the package ``mcap`` has it. Raises ``Damage``."""
    import io

    try:
        return record.read(ReadDataStream(io.BytesIO(bytes(piece.body))))
    except Exception as error:
        if lacks_resources(error):
            raise
        raise Damage(piece.at, f"a record has no meaning ({type(error).__name__})") from error
