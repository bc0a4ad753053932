"""Writes an MCAP file whose rows of equal layout cost next to nothing, and that survives a kill.

Chunks of at most a few MiB go to the operating system, into ``path``.part, which gets its name when complete.
A thread makes the messages of each chunk's rows, compresses and writes it while the next one fills. A block of messages
of one channel and of one size is one array, message headers included; what is written once goes through the records of
the ``mcap`` package.
Format: mcap.dev/spec.
"""

import os
import struct
import zlib
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Channel, ChunkIndex, DataEnd, Footer, Header, Metadata, MetadataIndex, Schema, Statistics
from mcap.writer import MCAP0_MAGIC
from mcap_protobuf.schema import build_file_descriptor_set
from numpy.typing import NDArray

from orchestrator.presentation.log.derived_files import clear
from orchestrator.presentation.log.records import CHUNK, HEAD
from orchestrator.presentation.log.sink import MessageSink

CHUNK_SIZE = 1024 * 1024
LIBRARY = "apa-cosim"
MESSAGE_HEADER = np.dtype(
    [("opcode", "u1"), ("length", "<u8"), ("channel", "<u2"), ("sequence", "<u4"), ("log", "<u8"), ("publish", "<u8")]
)
HEADER_SIZE = MESSAGE_HEADER.itemsize
MESSAGE = struct.Struct("<BQHIQQ")
INDEX_HEADER = struct.Struct("<BQHI")
INDEX_ENTRY = struct.Struct("<QQ")
COMPRESSION = b"zstd"
FOOTER_SIZE = 9 + 8 + 8 + 4


class _Chunk:
    """Messages that are compressed and written together."""

    def __init__(self, counts: dict[int, int]) -> None:
        self._counts = counts
        """Channel -> how many messages it has in the file."""
        self.parts: list[bytes | memoryview] = []
        self.rest: list[Callable[[MessageSink], None]] = []
        """What appends messages before it is written."""
        self.size = 0
        self.first_ns, self.last_ns = 1 << 62, 0
        self.entries: dict[int, list[bytes]] = {}
        """Channel -> times and offsets in the chunk of its messages."""

    def write(self, channel: int, t_ns: int, data: bytes) -> None:
        """Append one message at ``t_ns`` of simulated time."""
        head = MESSAGE.pack(Opcode.MESSAGE, MESSAGE.size - 9 + len(data), channel, self._counts[channel], t_ns, t_ns)
        self._note(channel, 1, INDEX_ENTRY.pack(t_ns, self.size), t_ns, t_ns)
        self.add(head + data)

    def write_rows(self, channel: int, t_ns: NDArray[np.int64], rows: NDArray[np.uint8]) -> None:
        """Append messages of equal size at the times ``t_ns``, one per row, behind ``HEADER_SIZE`` bytes for a header.

        The rows must stay as they are until the chunk is written.
        """
        count, size = rows.shape
        if not count:
            return
        header = rows[:, :HEADER_SIZE].view(MESSAGE_HEADER)[:, 0]
        header["opcode"], header["length"], header["channel"] = Opcode.MESSAGE, size - 9, channel
        header["sequence"] = self._counts[channel] + np.arange(count)
        header["log"] = header["publish"] = t_ns
        entries = np.empty((count, 2), dtype="<u8")
        entries[:, 0], entries[:, 1] = t_ns, self.size + np.arange(count) * size
        self._note(channel, count, entries.tobytes(), int(t_ns[0]), int(t_ns[-1]))
        self.add(rows.data.cast("B"))

    def add(self, record: bytes | memoryview) -> None:
        """Append a record."""
        self.parts.append(record)
        self.size += len(record)

    def _note(self, channel: int, count: int, entries: bytes, first_ns: int, last_ns: int) -> None:
        self.entries.setdefault(channel, []).append(entries)
        self._counts[channel] += count
        self.first_ns, self.last_ns = min(self.first_ns, first_ns), max(self.last_ns, last_ns)


class McapFile:
    """Opened on creation; ``close`` writes the index and gives the file its name."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.part = path.with_name(path.name + ".part")
        path.parent.mkdir(parents=True, exist_ok=True)
        self.open = True
        self._file: Any = self.part.open("wb", buffering=0)
        self._size = 0
        self._crc = 0
        self._schemas: list[Schema] = []
        self._described = b""
        """The records of schemas and channels."""
        self._channels: list[Channel] = []
        self._counts: dict[int, int] = {}
        self._first_ns, self._last_ns = 1 << 62, 0
        self._chunks: list[bytes] = []
        """The index records of the chunks, made where these are written."""
        self._metadata: list[MetadataIndex] = []
        self._writer = ThreadPoolExecutor(max_workers=1)
        self._written: Future[None] | None = None
        """Of the chunk that the thread of ``_writer`` writes."""
        self._compressor = zstandard.ZstdCompressor(level=-1, write_checksum=True)
        self._chunk = _Chunk(self._counts)
        self._write(MCAP0_MAGIC + _bytes(Header(profile="", library=LIBRARY)))

    def add_channel(self, topic: str, message: type[Any]) -> int:
        """Return a new channel for a generated protobuf message class."""
        descriptors = build_file_descriptor_set(message).SerializeToString(deterministic=True)
        return self.channel(topic, message.DESCRIPTOR.full_name, descriptors, {})

    def channel(self, topic: str, schema: str, descriptors: bytes, metadata: dict[str, str]) -> int:
        """Return a new channel for messages of a type in a serialized FileDescriptorSet."""
        same = [item for item in self._schemas if item.name == schema and item.data == descriptors]
        if not same:
            same = [Schema(id=len(self._schemas) + 1, name=schema, encoding="protobuf", data=descriptors)]
            self._schemas += same
            self._describe(same[0])
        number = len(self._channels) + 1
        channel = Channel(id=number, topic=topic, message_encoding="protobuf", schema_id=same[0].id, metadata=metadata)
        self._channels.append(channel)
        self._counts[number] = 0
        self._describe(channel)
        return number

    def _describe(self, record: Schema | Channel) -> None:
        described = _bytes(record)
        self._described += described
        self._chunk.add(described)

    def metadata(self, name: str, values: dict[str, str]) -> None:
        """Write a metadata record, outside the chunks, at once."""
        record = _bytes(Metadata(name=name, metadata=values))
        self._await_chunk()
        self._metadata.append(MetadataIndex(offset=self._size, length=len(record), name=name))
        self._write(record)

    def write(self, channel: int, t_ns: int, data: bytes) -> None:
        """Append one message at ``t_ns`` of simulated time."""
        self._chunk.write(channel, t_ns, data)
        if self._chunk.size >= CHUNK_SIZE:
            self.flush()

    def write_rows(self, channel: int, t_ns: NDArray[np.int64], rows: NDArray[np.uint8]) -> None:
        """Append messages of equal size at the times ``t_ns``, one per row, behind ``HEADER_SIZE`` bytes for a header.

        They stay in one chunk until ``flush``, and the rows must stay as they are.
        """
        self._chunk.write_rows(channel, t_ns, rows)

    def later(self, write: Callable[[MessageSink], None]) -> None:
        """Let ``write`` append messages to the chunk in hand, in the thread that writes it."""
        self._chunk.rest.append(write)

    def flush(self) -> None:
        """Hand the chunk in hand to the thread that writes, if it holds a message."""
        if not self._chunk.entries and not self._chunk.rest:
            return
        chunk, self._chunk = self._chunk, _Chunk(self._counts)
        self._await_chunk()
        try:
            self._written = self._writer.submit(self._compress_and_write, chunk)
        except RuntimeError:  # no more threads here; the executor keeps what it could not start
            self._writer = ThreadPoolExecutor(max_workers=1)
            self._compress_and_write(chunk)

    def close(self) -> None:
        """Write the last chunk and the index, then rename. Safe to call twice."""
        if not self.open:
            return
        self.open = False
        self.flush()
        self._await_chunk()
        self._writer.shutdown()
        self._write(_bytes(DataEnd(data_section_crc=self._crc)))
        self._write_summary()
        self._file.close()
        clear(self.path)
        os.replace(self.part, self.path)

    def discard(self) -> None:
        """Remove what is written so far."""
        self.open = False
        self._writer.shutdown()
        self._file.close()
        self.part.unlink(missing_ok=True)

    def _write(self, data: bytes) -> None:
        view = memoryview(data)
        try:
            while len(view):
                view = view[self._file.write(view) :]
        except OSError as error:
            self.open = False
            self._file.close()
            raise type(error)(error.errno, error.strerror, str(self.part)) from error
        self._size += len(data)
        self._crc = zlib.crc32(data, self._crc)

    def _await_chunk(self) -> None:
        """Wait until the chunk before is written. Raises the error that prevented it."""
        if self._written is not None:
            error = self._written.exception()
            self._written = None
            if error is not None:
                raise error

    def _compress_and_write(self, chunk: _Chunk) -> None:
        """Write a chunk."""
        for write in chunk.rest:
            write(chunk)
        data, first, last = b"".join(chunk.parts), chunk.first_ns, chunk.last_ns
        packed = self._compressor.compress(data)
        body = CHUNK.pack(first, last, len(data), 0, len(COMPRESSION)) + COMPRESSION + len(packed).to_bytes(8, "little")
        length = HEAD.size + len(body) + len(packed)
        index = ChunkIndex(
            chunk_start_offset=self._size,
            chunk_length=length,
            compression=COMPRESSION.decode(),
            compressed_size=len(packed),
            uncompressed_size=len(data),
            message_start_time=first,
            message_end_time=last,
            message_index_length=0,
            message_index_offsets={},
        )
        parts = [HEAD.pack(Opcode.CHUNK, length - HEAD.size), body, packed]
        at = self._size + length
        for channel, items in chunk.entries.items():
            index.message_index_offsets[channel] = at
            times = b"".join(items)
            parts += [INDEX_HEADER.pack(Opcode.MESSAGE_INDEX, 6 + len(times), channel, len(times)), times]
            at += INDEX_HEADER.size + len(times)
        index.message_index_length = at - self._size - length
        self._chunks.append(_bytes(index))
        self._first_ns, self._last_ns = min(self._first_ns, first), max(self._last_ns, last)
        self._write(b"".join(parts))

    def _write_summary(self) -> None:
        counted = {channel: count for channel, count in self._counts.items() if count}
        statistics = Statistics(
            attachment_count=0,
            channel_count=len(self._channels),
            channel_message_counts=counted,
            chunk_count=len(self._chunks),
            message_count=sum(counted.values()),
            message_start_time=self._first_ns if counted else 0,
            message_end_time=self._last_ns,
            metadata_count=len(self._metadata),
            schema_count=len(self._schemas),
        )
        metadata = b"".join(_bytes(record) for record in self._metadata)
        summary = self._described + _bytes(statistics) + b"".join(self._chunks) + metadata
        # The checksum covers the summary and the footer up to the checksum itself.
        bare = _bytes(Footer(summary_start=self._size, summary_offset_start=0, summary_crc=0))[: FOOTER_SIZE - 4]
        footer = Footer(summary_start=self._size, summary_offset_start=0, summary_crc=zlib.crc32(summary + bare))
        self._write(summary + _bytes(footer) + MCAP0_MAGIC)


def _bytes(record: Any) -> bytes:
    builder: Any = RecordBuilder()
    record.write(builder)
    written: bytes = builder.end()
    return written
