"""The records of an MCAP file: the only door by which one is read.

A log is believed only if every byte of it is under a checksum that is right: that of all data, in the record DataEnd,
and that of the summary behind it, in the footer. What a file claims about sizes is looked at before it is done.
Format: mcap.dev/spec.
"""

import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC

from orchestrator.text.errors import BadInput

HEAD = struct.Struct("<BQ")
CHUNK = struct.Struct("<QQQII")
"""First and last time, size and checksum of what is in a chunk, length of the compression's name."""
MESSAGE = struct.Struct("<HIQQ")
FOOTER = struct.Struct("<QQI")
MOST_BYTES = 1 << 31
MOST_IN_CHUNK = 1 << 28
MOST_UNPACKED, MOST_TIMES = 1 << 30, 64
"""A log may unpack to so many bytes, or to so many times its size if that is more."""


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


def file_bytes(path: Path) -> bytes:
    """Return the bytes of a log. Raises ``BadInput`` if that cannot be, or is none."""
    try:
        if not path.is_file():
            raise BadInput("is a folder, expected a log" if path.is_dir() else "no such file", file=path)
        if path.stat().st_size > MOST_BYTES:
            raise BadInput(f"is larger than {MOST_BYTES >> 30} GiB", file=path)
        data = path.read_bytes()
    except OSError as error:
        raise BadInput(f"cannot be read: {error.strerror}", file=path) from error
    if data[: len(MCAP0_MAGIC)] != MCAP0_MAGIC:
        raise BadInput("is no MCAP log", file=path)
    return data


def check(data: bytes) -> bool:
    """Return whether all of a whole file is under a checksum; chunks stay packed. Raises ``Damage``."""
    if len(data) < 2 * len(MCAP0_MAGIC) or data[-len(MCAP0_MAGIC) :] != MCAP0_MAGIC:
        raise Damage(len(data), "the file ends before the log does")
    found = top_records(data)
    end = _end_of_data(found)
    (crc,) = _unpacked(struct.Struct("<I"), found[end])
    if crc and crc != zlib.crc32(memoryview(data)[: found[end].at]):
        raise Damage(_first_wrong(data, found[:end]), "the checksum of the data is wrong")
    return _check_summary(data, found[end + 1 :], found[end]) and bool(crc)


def unpacked_records(data: bytes) -> Iterator[RawRecord]:
    """Yield the records of a whole file up to the end of the data, one chunk unpacked at a time. Raises ``Damage``."""
    found = top_records(data)
    budget = max(MOST_UNPACKED, MOST_TIMES * len(data))
    for piece in found[: _end_of_data(found)]:
        if piece.opcode != Opcode.CHUNK:
            yield piece
            continue
        for item in chunk_records(piece, budget):
            budget -= len(item.body)
            yield item


def _end_of_data(found: list[RawRecord]) -> int:
    """Return the place of the record that ends the data."""
    for place, piece in enumerate(found):
        if piece.opcode == Opcode.DATA_END:
            return place
    raise Damage(found[-1].at if found else len(MCAP0_MAGIC), "there is no end of the data")


def top_records(data: bytes) -> list[RawRecord]:
    """Return the records of a file without looking into them. Raises ``Damage`` where there is none."""
    found, at, end = [], len(MCAP0_MAGIC), len(data) - len(MCAP0_MAGIC)
    view = memoryview(data)
    while at < end:
        found.append(record_at(view, at, at, end))
        at += HEAD.size + len(found[-1].body)
    return found


def record_at(view: memoryview, at: int, place: int, end: int) -> RawRecord:
    """Return the record at byte ``at`` of ``view``, which is byte ``place`` of the file. Raises ``Damage``."""
    if at + HEAD.size > end:
        raise Damage(place, "the file ends in a record")
    opcode, length = HEAD.unpack_from(view, at)
    if not 0 < opcode < 128:
        raise Damage(place, "there is no record here")
    if length > end - at - HEAD.size:
        raise Damage(place, "the record here is cut off, or its length is damaged")
    return RawRecord(place, opcode, view[at + HEAD.size : at + HEAD.size + length])


def chunk_records(piece: RawRecord, budget: int = MOST_UNPACKED) -> Iterator[RawRecord]:
    """Yield the records of a chunk. Raises ``Damage`` if it is not what its checksum says, or has more than may be."""
    data = memoryview(_chunk_bytes(piece, budget))
    at = 0
    while at < len(data):
        found = record_at(data, at, piece.at, len(data))
        at += HEAD.size + len(found.body)
        yield found


def chunk_times(piece: RawRecord) -> tuple[int, int]:
    """Return first and last time [ns] that a chunk says of itself."""
    first, last, *_ = _unpacked(CHUNK, piece)
    return int(first), int(last)


def _chunk_bytes(piece: RawRecord, budget: int) -> bytes:
    _, _, size, crc, letters = _unpacked(CHUNK, piece)
    at = CHUNK.size + letters
    if letters > 16 or at + 8 > len(piece.body):
        raise Damage(piece.at, "a chunk has no compression that is known")
    compression = bytes(piece.body[CHUNK.size : at])
    packed = bytes(piece.body[at + 8 :])
    if int.from_bytes(piece.body[at : at + 8], "little") != len(packed):
        raise Damage(piece.at, "a chunk has another length than it says")
    if size > min(budget, MOST_IN_CHUNK):
        raise Damage(piece.at, f"a chunk says it unpacks to {size} bytes, more than a log may have")
    data = _decompressed(piece.at, compression, packed, size)
    if len(data) != size or (crc and zlib.crc32(data) != crc):
        raise Damage(piece.at, "the checksum of a chunk is wrong")
    return data


def _decompressed(at: int, compression: bytes, packed: bytes, size: int) -> bytes:
    """Return what is packed, of which there are to be ``size`` bytes."""
    if not compression:
        return packed
    if compression != b"zstd":
        raise Damage(at, f"compression {compression.decode(errors='replace')!r} is not known here, only zstd")
    try:
        said = zstandard.frame_content_size(packed)
        if said not in (-1, size):
            raise Damage(at, "a chunk unpacks to another size than it says")
        unpacker = zstandard.ZstdDecompressor(max_window_size=MOST_IN_CHUNK)
        with unpacker.stream_reader(packed) as stream:
            return stream.read(size + 1)
    except (zstandard.ZstdError, MemoryError) as error:
        raise Damage(at, f"a chunk cannot be unpacked ({error})") from error


def _check_summary(data: bytes, summary: list[RawRecord], end: RawRecord) -> bool:
    """Return whether the summary has a checksum; raise ``Damage`` if it is wrong."""
    at = end.at + HEAD.size + len(end.body)
    if not summary or summary[-1].opcode != Opcode.FOOTER:
        raise Damage(at, "there is no footer")
    footer = summary[-1]
    start, _, crc = _unpacked(FOOTER, footer)
    if start not in (0, at):
        raise Damage(footer.at, "the footer tells another place of the summary")
    if crc and crc != zlib.crc32(memoryview(data)[at : footer.at + HEAD.size + FOOTER.size - 4]):
        raise Damage(at, "the checksum of the summary is wrong")
    return bool(crc)


def _first_wrong(data: bytes, pieces: list[RawRecord]) -> int:
    """Return where the damage is, as far as chunks tell; else where the data begin."""
    for piece in pieces:
        if piece.opcode == Opcode.CHUNK:
            try:
                _chunk_bytes(piece, MOST_UNPACKED)
            except Damage as damage:
                return damage.at
    return len(MCAP0_MAGIC)


def _unpacked(layout: struct.Struct, piece: RawRecord) -> Any:
    if len(piece.body) < layout.size:
        raise Damage(piece.at, "a record is too short")
    return layout.unpack_from(piece.body)


def parsed(record: Any, piece: RawRecord) -> Any:
    """Return a record as a class of the package ``mcap`` has it. Raises ``Damage``."""
    import io

    try:
        return record.read(ReadDataStream(io.BytesIO(bytes(piece.body))))
    except Exception as error:
        raise Damage(piece.at, f"a record has no meaning ({type(error).__name__})") from error
