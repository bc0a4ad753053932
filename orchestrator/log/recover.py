"""Mending the log of a run that was killed: everything but the last, unfinished chunk."""

import os
import struct
from pathlib import Path
from typing import Any, NamedTuple

import zstandard
from mcap.exceptions import McapError
from mcap.records import Attachment, Channel, Message, Metadata, Schema
from mcap.stream_reader import CRCValidationError, StreamReader
from mcap.writer import Writer

from orchestrator.log.mcap_file import CHUNK_SIZE, LIBRARY
from orchestrator.text.errors import BadInput

BROKEN = (McapError, CRCValidationError, zstandard.ZstdError, EOFError, struct.error, ValueError, KeyError, MemoryError)


class Recovered(NamedTuple):
    """What came out of a broken log."""

    path: Path
    messages: int
    last_ns: int
    complete: bool
    """The file was whole to begin with."""


def recover(path: Path) -> Recovered:
    """Write a whole log with all that can be read of ``path``; ``X.mcap.part`` becomes ``X.mcap``.

    Any other name gets ``.recovered.mcap``. Raises ``BadInput`` if the file is no MCAP log or holds nothing.
    """
    if not path.is_file():
        raise BadInput("no such file", file=path)
    target = path.with_suffix("") if path.suffix == ".part" else path.with_suffix(".recovered.mcap")
    partial = target.with_name(target.name + ".recovering")
    try:
        with path.open("rb") as source, partial.open("wb") as stream:
            copier = _Copier(stream)
            complete = copier.copy(source)
        if not copier.messages:
            raise BadInput("holds no complete chunk of messages; nothing to recover", file=path)
        os.replace(partial, target)
    finally:
        partial.unlink(missing_ok=True)
    return Recovered(target, copier.messages, copier.last_ns, complete)


class _Copier:
    """Copies records from a stream that may end anywhere into a new file."""

    def __init__(self, stream: Any) -> None:
        self._writer: Any = Writer(stream, chunk_size=CHUNK_SIZE)
        self._writer.start(profile="", library=LIBRARY)
        self._schemas: dict[int, int] = {0: 0}
        self._channels: dict[int, int] = {}
        self.messages = 0
        self.last_ns = 0

    def copy(self, source: Any) -> bool:
        """Return True if ``source`` was whole."""
        complete = False
        try:
            for record in StreamReader(source, validate_crcs=True).records:
                self._one(record)
            complete = True
        except BROKEN as error:
            if not self.messages and not self._channels and "magic" in type(error).__name__.lower():
                raise BadInput("is not an MCAP file", file=getattr(source, "name", None)) from error
        self._writer.finish()
        return complete

    def _one(self, record: Any) -> None:
        writer = self._writer
        if isinstance(record, Schema) and record.id not in self._schemas:
            self._schemas[record.id] = writer.register_schema(record.name, record.encoding, record.data)
        elif isinstance(record, Channel) and record.id not in self._channels:
            self._channels[record.id] = writer.register_channel(
                record.topic, record.message_encoding, self._schemas[record.schema_id], record.metadata
            )
        elif isinstance(record, Message):
            writer.add_message(
                self._channels[record.channel_id], record.log_time, record.data, record.publish_time, record.sequence
            )
            self.messages += 1
            self.last_ns = max(self.last_ns, record.log_time)
        elif isinstance(record, Metadata):
            writer.add_metadata(record.name, record.metadata)
        elif isinstance(record, Attachment):
            writer.add_attachment(record.create_time, record.log_time, record.name, record.media_type, record.data)
