"""Repairs a log: all whole records are written to a new one, and the others are reported by their place."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Metadata, Schema
from mcap.writer import MCAP0_MAGIC, Writer

from fmus.files import whole
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.log.mcap_file import CHUNK_SIZE, LIBRARY
from orchestrator.presentation.log.read_log import NO_MEANING, RECOVERED, with_checksum, without_checksum
from orchestrator.presentation.log.records import (
    HEAD,
    MESSAGE,
    ByteSource,
    Damage,
    LogFile,
    RawRecord,
    check,
    chunk_records,
    chunk_times,
    iterate_records,
    parse_record,
    read_record,
    record_head,
)

CHUNK_MARK = b"\x04\x00\x00\x00zstd"
"""How the compression of a chunk is written: by this the next one is found where lengths are damaged."""
MARK_AT = HEAD.size + 28
MOST_LISTED = 20
KNOWN = frozenset(int(code) for code in Opcode)


class RecoveryResult(NamedTuple):
    """What came out of a log."""

    path: Path
    """The repaired log; the log itself if it was whole."""
    messages: int
    last_ns: int
    complete: bool
    """The file was whole to begin with."""
    lost: list[str]
    """What is damaged, by its place."""


def recover(path: Path) -> RecoveryResult:
    """Write a whole log with all that can be read of ``path``; ``X.mcap.part`` becomes ``X.mcap``.

    Any other name gets ``.recovered.mcap``, and so does one whose place is taken: nothing is overwritten. A log that is
    whole is left as it is. Raises ``BadInput`` if the file is no MCAP log or holds nothing.
    """
    with LogFile(path) as data:
        if path.suffix != ".part":
            try:
                count, last_ns = _messages(data)
            except Damage:
                pass
            else:
                return RecoveryResult(path, count, last_ns, True, [])
        target = _free(path.with_suffix("") if path.suffix == ".part" else path.with_suffix(".recovered.mcap"))
        with whole(target) as part, part.open("wb") as stream:
            copier = _Copier(stream)
            copier.copy(data)
            if not copier.messages:
                raise BadInput("holds no complete chunk of messages; nothing to recover", file=path)
    return RecoveryResult(target, copier.messages, copier.last_ns, not copier.lost, copier.lost)


def _messages(data: ByteSource) -> tuple[int, int]:
    """Return how many messages a whole log has, and the time of the last [ns]. Raises ``Damage``."""
    check(data)
    count = last_ns = 0
    for item in iterate_records(data):
        if item.opcode == Opcode.MESSAGE and len(item.body) >= MESSAGE.size:
            count, last_ns = count + 1, max(last_ns, MESSAGE.unpack_from(item.body)[2])
    return count, last_ns


def _free(path: Path) -> Path:
    """Return a name that no file has."""
    base = path.name.removesuffix(".mcap").removesuffix(".recovered")
    numbers = (path.with_name(f"{base}.recovered{number}.mcap") for number in ("", *(f"-{k}" for k in range(2, 1000))))
    for name in (path, *numbers):
        if not name.exists():
            return name
    raise BadInput("has been recovered a thousand times; remove some", file=path)


def recover_records(data: ByteSource) -> Iterator[RawRecord | Damage]:
    """Yield the records that are whole, and each damage, in the order of the file."""
    at, end = len(MCAP0_MAGIC), len(data)
    while at < end:
        try:
            head = record_head(data[at : at + HEAD.size], at, end - at)
            if head.opcode not in KNOWN:
                raise Damage(at, "there is no record that is known")
            if head.opcode in (Opcode.DATA_END, Opcode.FOOTER):
                return
            after = head.end
            try:
                yield from _open_record(read_record(data, head))
            except Damage as damage:
                yield damage
                after = after if _begins_record(data, after) else _next_chunk(data, at + 1)
            at = after
        except Damage as damage:
            if data[at : at + len(MCAP0_MAGIC) + 1] == MCAP0_MAGIC:
                return
            yield damage
            at = _next_chunk(data, at + 1)


def _open_record(piece: RawRecord) -> list[RawRecord]:
    """Return a record, or those in it if it is a chunk: all or, with ``Damage``, none."""
    if piece.opcode != Opcode.CHUNK:
        return [piece]
    try:
        return list(chunk_records(piece))
    except Damage as damage:
        first, last = chunk_times(piece)
        reported = f" (it says: {first / 1e9:.2f} to {last / 1e9:.2f} s)" if first <= last < 1 << 60 else ""
        raise Damage(piece.at, f"{str(damage).partition(': ')[2]}{reported}") from damage


def _begins_record(data: ByteSource, at: int) -> bool:
    try:
        return record_head(data[at : at + HEAD.size], at, len(data) - at).opcode in KNOWN
    except Damage:
        return data[at : at + len(MCAP0_MAGIC) + 1] == MCAP0_MAGIC


def _next_chunk(data: ByteSource, begin: int) -> int:
    """Return where the next chunk begins that may be one; the end of the file if there is none."""
    found = begin
    while (found := data.find(CHUNK_MARK, found)) >= 0:
        at = found - MARK_AT
        if at >= begin and _begins_record(data, at):
            return at
        found += 1
    return len(data)


class _Copier:
    """Copies what is whole into a new file."""

    def __init__(self, stream: Any) -> None:
        self._writer: Any = Writer(stream, chunk_size=CHUNK_SIZE, enable_data_crcs=True)
        self._writer.start(profile="", library=LIBRARY)
        self._schemas: dict[int, int] = {0: 0}
        self._channels: dict[int, int] = {}
        self.messages = 0
        self.last_ns = 0
        self.lost: list[str] = []

    def copy(self, data: ByteSource) -> None:
        """Copy ``data``, noting what is lost."""
        for item in recover_records(data):
            try:
                if isinstance(item, Damage):
                    raise item
                self._one(item)
            except Damage as damage:
                self.lost.append(str(damage))
            except NO_MEANING as error:
                self.lost.append(f"byte {item.at}: a record has no meaning ({type(error).__name__})")
        if not self.lost:
            self._check_all(data)
        if self.lost:
            more = f" and {len(self.lost) - MOST_LISTED} more" if len(self.lost) > MOST_LISTED else ""
            lacks = {"lacks": "; ".join(self.lost[:MOST_LISTED]) + more}
            self._writer.add_metadata(RECOVERED, with_checksum(lacks))
        self._writer.finish()

    def _check_all(self, data: ByteSource) -> None:
        """Note that something is damaged that no record shows by itself."""
        try:
            check(data)
        except Damage as damage:
            self.lost.append(str(damage))

    def _one(self, piece: RawRecord) -> None:
        writer = self._writer
        if piece.opcode == Opcode.SCHEMA:
            record = parse_record(Schema, piece)
            if record.id not in self._schemas:
                self._schemas[record.id] = writer.register_schema(record.name, record.encoding, record.data)
        elif piece.opcode == Opcode.CHANNEL:
            record = parse_record(Channel, piece)
            if record.id not in self._channels:
                schema = self._schemas[record.schema_id]
                number = writer.register_channel(record.topic, record.message_encoding, schema, record.metadata)
                self._channels[record.id] = number
        elif piece.opcode == Opcode.MESSAGE:
            channel, sequence, time, publish = MESSAGE.unpack_from(piece.body)
            writer.add_message(self._channels[channel], time, bytes(piece.body[MESSAGE.size :]), publish, sequence)
            self.messages += 1
            self.last_ns = max(self.last_ns, time)
        elif piece.opcode == Opcode.METADATA:
            record = parse_record(Metadata, piece)
            if record.name != RECOVERED:
                _check_metadata(piece, record)
                writer.add_metadata(record.name, record.metadata)
        elif piece.opcode == Opcode.ATTACHMENT:
            record = parse_record(Attachment, piece)
            writer.add_attachment(record.create_time, record.log_time, record.name, record.media_type, record.data)


def _check_metadata(piece: RawRecord, record: Any) -> None:
    """Raise ``Damage`` if metadata are not what their checksum says."""
    try:
        without_checksum(record.name, record.metadata)
    except (BadInput, *NO_MEANING) as error:
        raise Damage(piece.at, f"the metadata {record.name[:40]!r} are damaged") from error
