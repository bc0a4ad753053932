"""A log file back as a ``Recording``: every signal an array by its flat name."""

import json
import struct
import zlib
from collections.abc import Callable
from enum import IntEnum
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from mcap.opcode import Opcode
from mcap.records import Channel, Metadata
from numpy.typing import NDArray
from pydantic import BaseModel, Field, StringConstraints, TypeAdapter, ValidationError

from modelkit.signal import Signal
from modelkit.variables import Variable
from orchestrator.evaluation.verdict.summary import FmuUsed, Lateness, StartRecord
from orchestrator.inputs.text.console import say
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.printable import readable
from orchestrator.inputs.text.quantities import MOST_WHOLE
from orchestrator.inputs.text.yaml_file import explain
from orchestrator.presentation.log.protobuf_rows import Decoder
from orchestrator.presentation.log.records import (
    HEAD,
    MESSAGE,
    Damage,
    LogFile,
    RawRecord,
    RecordHead,
    check,
    iterate_chunks,
    parse_record,
    read_record,
    record_head,
    record_heads,
)
from orchestrator.presentation.log.schema import PARAMETERS, name_prefix
from orchestrator.simulation.cosim.declared import MAX_DESCRIPTION, MAX_ELEMENTS, MAX_ITEMS, MAX_LETTERS
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.recording import Recording, recording_of
from orchestrator.simulation.cosim.signal_blocks import SignalBlocks

KINDS: dict[str, type] = {"float": float, "int": int, "bool": bool}
VARIABLES = "variables"
"""Channel metadata that describes a message made from the variables of an instance."""
CHECKSUM = "checksum"
"""Key of a metadata record: the checksum of its other values."""
RECOVERED = "recovered"
"""Metadata record of what a repaired log lacks."""
NO_MEANING = (ValueError, KeyError, TypeError, IndexError, AttributeError, OverflowError, RecursionError, struct.error)


MESSAGE_HEAD = HEAD.size + 2
"""Bytes at the beginning of a message that are alike in all messages of one channel and one size."""
MESSAGES_AT_ONCE = 4096
MAX_PENDING_ROWS = 1 << 16
"""Rows of one FMU that may be in a log before those of another at the same times."""
Handler = Callable[[NDArray[np.int64], NDArray[np.uint8]], None]
"""Takes messages of one channel and of one size: times [ns] (n), bytes (n, size)."""


def read_log(path: Path) -> Recording:
    """Return what is in the log at ``path``. Raises ``BadInput`` if it is not a complete log of ours.

    Signals of a long run are not kept in memory (see ``cosim.signal_blocks``).
    """
    reader = _SignalReader(path)
    metadata = scan_log(path, reader.handler)
    try:
        recording = reader.recording(metadata)
    except BadInput:
        raise
    except ValidationError as error:
        raise explain(error, path, RunInfo) from error
    except NO_MEANING as error:
        raise no_layout(error, path) from error
    lacks = recording.info.get(RECOVERED, {}).get("lacks")
    if lacks:
        say(f"apa: warning: {path}: is a repaired log; it lacks {lacks}")
    return recording


def no_layout(error: Exception, path: Path) -> BadInput:
    """Return what to raise for a log whose content has no meaning."""
    text = " ".join(str(error).split())[:200]
    return BadInput(f"is not laid out as apa writes it ({type(error).__name__}: {text})", file=path)


def scan_log(path: Path, handler_of: Callable[[Any], Handler | None]) -> dict[str, dict[str, str]]:
    """Go through a log and hand over its messages in order; return its metadata by name.

    ``handler_of`` is called for each channel. Raises ``BadInput`` for a damaged log, with the place.
    """
    metadata: dict[str, dict[str, str]] = {}
    channels = _Channels(handler_of)
    try:
        with LogFile(path) as data:
            sure = check(data)
            for piece in iterate_chunks(data):
                if piece.opcode == Opcode.METADATA:
                    record = parse_record(Metadata, piece)
                    metadata[record.name] = record.metadata
                elif piece.opcode == Opcode.CHUNK:
                    channels.take(piece.at, piece.body)
                elif piece.opcode in (Opcode.CHANNEL, Opcode.MESSAGE):
                    channels.take(piece.at, HEAD.pack(piece.opcode, len(piece.body)) + bytes(piece.body))
    except Damage as damage:
        raise BadInput(f"is not a complete log ({damage}); try: apa recover {path}", file=path) from damage
    except BadInput:
        raise
    except NO_MEANING as error:
        raise no_layout(error, path) from error
    if not sure:
        say(f"apa: warning: {path}: has no checksum over all of it; a damage in it may go unseen")
    return metadata


class _Channels:
    """The channels of a log, and who takes their messages."""

    def __init__(self, handler_of: Callable[[Any], Handler | None]) -> None:
        self._handler_of = handler_of
        self._handlers: dict[int, Handler | None] = {}

    def take(self, place: int, content: bytes) -> None:
        """Hand over the messages in some records; ``place`` is where they are in the file. Raises ``Damage``."""
        at = 0
        while at < len(content):
            head = record_head(content[at : at + HEAD.size], place, len(content) - at)
            size = HEAD.size + head.size
            if head.opcode == Opcode.CHANNEL:
                channel = parse_record(Channel, RawRecord(place, head.opcode, content[at + HEAD.size : at + size]))
                if channel.id not in self._handlers:
                    self._handlers[channel.id] = self._handler_of(channel)
            elif head.opcode == Opcode.MESSAGE:
                size *= self._messages(place, content, at, size)
            at += size

    def _messages(self, place: int, content: bytes, at: int, size: int) -> int:
        """Hand over messages of one channel and one size that follow one another; return how many."""
        if size < HEAD.size + MESSAGE.size:
            raise Damage(place, "a message is too short")
        begin = content[at : at + MESSAGE_HEAD]
        count = 1
        while count < MESSAGES_AT_ONCE and content[at + count * size : at + count * size + MESSAGE_HEAD] == begin:
            count += 1
        if at + count * size > len(content):
            raise Damage(place, "the record here is cut off, or its length is damaged")
        (number,) = struct.unpack_from("<H", content, at + HEAD.size)
        if number not in self._handlers:
            raise Damage(place, "a message has no channel")
        handler = self._handlers[number]
        if handler is not None:
            rows = np.frombuffer(content, dtype=np.uint8, count=count * size, offset=at).reshape(count, size)
            times = np.ascontiguousarray(rows[:, TIME_AT : TIME_AT + 8]).view("<u8")[:, 0]
            if (times > MAX_TIME_NS).any():
                raise OverflowError("a time is beyond 292 years")
            handler(times.astype(np.int64), rows[:, HEAD.size + MESSAGE.size :])
        return count


TIME_AT = HEAD.size + 6
"""Of a message's time among its bytes."""
MAX_TIME_NS = (1 << 63) - 1


def log_file(text: str) -> Path:
    """Return the log that an argument of a command means: a file, or the folder of a run."""
    path = Path(text)
    if not path.is_dir():
        return path
    whole, part = path / "run.mcap", path / "run.mcap.part"
    return part if part.is_file() and not whole.is_file() else whole


def log_name(log: Path) -> str:
    """Return the name of a log, or of the folder of its run."""
    return readable(log.stem if log.stem != "run" else log.resolve().parent.name)


def read_info(path: Path) -> dict[str, Any]:
    """Return what a log says of its scenario, FMUs, seed and versions; empty if it is no complete log."""
    try:
        with LogFile(path) as data:
            items = [_metadata(data, head) for head in record_heads(data)]
        found = {item.name: item.metadata for item in items if item is not None}
        return without_checksum("apa", found.get("apa", {}))
    except (BadInput, Damage, *NO_MEANING):
        return {}


def _metadata(data: LogFile, head: RecordHead) -> Any:
    return parse_record(Metadata, read_record(data, head)) if head.opcode == Opcode.METADATA else None


class _Messages:
    """The messages of a channel of signals that are not in the recording yet."""

    def __init__(self, variables: list[Variable]) -> None:
        self.variables = variables
        self._times: list[NDArray[np.int64]] = []
        self._rows: list[Array] = []
        self.count = 0

    def add(self, times: NDArray[np.int64], rows: Array) -> None:
        """Take further rows."""
        self._times.append(times)
        self._rows.append(rows)
        self.count += len(times)

    def take(self, count: int) -> tuple[NDArray[np.int64], Array]:
        """Return the first ``count`` rows with their times, and forget them."""
        times, rows = self._all()
        self._times, self._rows = ([times[count:]], [rows[count:]]) if count < self.count else ([], [])
        self.count -= count
        return times[:count], rows[:count]

    def at(self, times: NDArray[np.int64]) -> Array | None:
        """Return the values that hold at ``times``, which rise; None if some are not known. Forget those before."""
        changes, rows = self._all()
        places = np.searchsorted(changes, times, side="right") - 1
        if not len(changes) or places[0] < 0 or (np.diff(changes) < 0).any():
            return None
        last = int(places[-1])
        self._times, self._rows, self.count = [changes[last:]], [rows[last:]], len(changes) - last
        return rows[places]

    def _all(self) -> tuple[NDArray[np.int64], Array]:
        if len(self._times) != 1:
            empty = [np.empty(0, dtype=np.int64)], [np.empty((0, len(self.variables)))]
            times, rows = (self._times, self._rows) if self._times else empty
            self._times, self._rows = [np.concatenate(times)], [np.concatenate(rows)]
        return self._times[0], self._rows[0]


class _Owner:
    """The channels of one FMU: of its signals at each exchange (""), and of those that are written on change."""

    def __init__(self) -> None:
        self.channels: dict[str, _Messages] = {}
        self.has_exchanges = False
        """So far."""

    @property
    def count(self) -> int:
        """Return how many exchanges are waiting."""
        return self.channels[""].count if self.has_exchanges else 0


class _SignalReader:
    """Makes a recording of the messages of a log, a few at a time."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._owners: dict[str, _Owner] = {}
        self._parameters: dict[str, float] = {}
        self._variables: dict[str, Variable] = {}
        self._blocks: SignalBlocks | None = None
        self._last_ns = -1

    def handler(self, channel: Any) -> Handler | None:
        """Return what takes the messages of a channel of signals or parameters."""
        if VARIABLES not in channel.metadata:
            return None
        name, group = channel.topic.strip("/").partition("/")[::2]
        prefix = f"{name}.{name_prefix(group)}"
        described = from_json(channel.metadata[VARIABLES])
        variables = [item._replace(name=prefix + item.name) for item in described]
        decoder = Decoder(described)
        if group == PARAMETERS:

            def take_parameters(times: NDArray[np.int64], messages: NDArray[np.uint8]) -> None:
                self._variables |= {item.name: item for item in variables}
                named = zip(variables, decoder.rows(messages, self._path)[-1].tolist(), strict=True)
                self._parameters |= {item.name: value for item, value in named}

            return take_parameters
        owner, pending = self._owners.setdefault(name, _Owner()), _Messages(variables)
        if group in owner.channels:
            raise BadInput(f"has two channels {channel.topic}", file=self._path)
        owner.channels[group] = pending

        def take(times: NDArray[np.int64], messages: NDArray[np.uint8]) -> None:
            self._variables |= {item.name: item for item in variables}
            values = decoder.rows(messages, self._path)
            if (times <= self._last_ns).any():
                raise BadInput("its times do not rise", file=self._path)
            pending.add(times, values)
            if not group:
                owner.has_exchanges = True
                if all(item.has_exchanges for item in self._owners.values()):
                    self._join()
            if pending.count > MAX_PENDING_ROWS:
                raise self._apart()

        return take

    def _join(self) -> None:
        """Move the rows that all FMUs have to the recording."""
        count = min((item.count for item in self._owners.values()), default=0)
        if not count:
            return
        variables: list[Variable] = []
        parts: list[Array] = []
        times: NDArray[np.int64] | None = None
        for owner in self._owners.values():
            own, rows = owner.channels[""].take(count)
            if times is not None and (own != times).any():
                raise self._apart()
            times = own
            for name, messages in owner.channels.items():
                values = messages.at(times) if name else rows
                if values is None:
                    raise BadInput(f"lacks values of {messages.variables[0].name}", file=self._path)
                parts.append(values)
                variables += messages.variables
        assert times is not None
        if (np.diff(times, prepend=self._last_ns) <= 0).any():
            raise BadInput("its times do not rise", file=self._path)
        self._last_ns = int(times[-1])
        if self._blocks is None:
            self._blocks = SignalBlocks([item.name for item in variables])
        elif len(variables) != len(self._blocks.names):
            raise self._apart()
        self._blocks.extend(times, parts[0] if len(parts) == 1 else np.concatenate(parts, 1))

    def _apart(self) -> BadInput:
        return BadInput("its instances have been seen at different times", file=self._path)

    def recording(self, metadata: dict[str, dict[str, str]]) -> Recording:
        """Return the recording when all messages have been taken."""
        self._owners = {name: owner for name, owner in self._owners.items() if owner.has_exchanges}
        self._join()
        if any(item.count for item in self._owners.values()):
            raise self._apart()
        info = {name: without_checksum(name, values) for name, values in metadata.items()}
        reported = _run_info({**info.pop("apa", {}), **info})
        return recording_of(self._blocks or SignalBlocks([]), self._parameters, self._variables, reported)


class RunInfo(BaseModel):
    """What a log tells of its run beside its signals, as far as anybody asks for it."""

    scenario: dict[str, Any] | None = None
    end: dict[str, Any] = {}
    recovered: dict[str, Any] = {}
    versions: dict[str, str] = {}
    fmus: list[FmuUsed] = []
    started: StartRecord = StartRecord()
    realtime: Lateness | None = None


def _run_info(info: dict[str, Any]) -> dict[str, Any]:
    """Return what a log tells of its run. Raises ``ValidationError`` if it is not of the kind that apa writes."""
    RunInfo(**info)
    return info


def with_checksum(values: dict[str, Any]) -> dict[str, str]:
    """Return metadata as JSON texts with a checksum over them, for a reader of what is left of a damaged file."""
    texts = {key: json.dumps(value) for key, value in values.items()}
    return {**texts, CHECKSUM: str(_checksum(texts))}


def without_checksum(name: str, texts: dict[str, str]) -> dict[str, Any]:
    """Return the values of metadata. Raises ``BadInput`` if they are not those that the checksum was made of."""
    own = {key: text for key, text in texts.items() if key != CHECKSUM}
    if CHECKSUM in texts and texts[CHECKSUM] != str(_checksum(own)):
        raise BadInput(f"the metadata {name} are damaged")
    return {key: json.loads(text) for key, text in own.items()}


def _checksum(texts: dict[str, str]) -> int:
    return zlib.crc32(json.dumps(texts, sort_keys=True).encode())


ShortText = Annotated[str, StringConstraints(max_length=MAX_LETTERS)]
FmiInteger = Annotated[int, Field(ge=-MOST_WHOLE, lt=MOST_WHOLE)]


class LoggedStates(BaseModel):
    """The names of a mode's values."""

    name: ShortText
    values: Annotated[dict[ShortText, FmiInteger], Field(max_length=MAX_ITEMS)]


class LoggedVariable(BaseModel):
    """What a log says of a variable."""

    name: ShortText
    type: Literal["float", "int", "bool"]
    unit: ShortText
    text: Annotated[str, StringConstraints(max_length=MAX_DESCRIPTION)]
    states: LoggedStates | None = None


LOGGED = TypeAdapter(Annotated[list[LoggedVariable], Field(max_length=MAX_ELEMENTS)])


def from_json(text: str) -> list[Variable]:
    """Return the variables that a channel's metadata describes (see ``recording.to_json``).

    Raises ``ValueError`` for what has no meaning or no bounds.
    """
    result = []
    for row in LOGGED.validate_json(text, strict=True):
        functional: Any = IntEnum
        states = functional(row.states.name, row.states.values) if row.states is not None else None
        kind = KINDS[row.type]
        result.append(Variable(row.name, kind, Signal(row.unit, row.text, states=states), kind()))
    return result
