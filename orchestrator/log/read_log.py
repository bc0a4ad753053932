"""A log file back as a ``Recording``: every signal an array by its flat name."""

import json
import struct
import zlib
from collections.abc import Iterable
from enum import IntEnum
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from mcap.opcode import Opcode
from mcap.records import Channel, Metadata
from pydantic import BaseModel, ValidationError

from modelkit.signal import Signal
from modelkit.variables import Variable
from orchestrator.cosim.recording import Recording
from orchestrator.log.protobuf_rows import Decoder
from orchestrator.log.records import (
    MESSAGE,
    Damage,
    RawRecord,
    check,
    file_bytes,
    parsed,
    top_records,
    unpacked_records,
)
from orchestrator.text.console import say
from orchestrator.text.errors import BadInput
from orchestrator.text.quantities import MOST_WHOLE
from orchestrator.text.yaml_file import explain
from orchestrator.verdict.summary import FmuUsed, Lateness, Started

KINDS: dict[str, type] = {"float": float, "int": int, "bool": bool}
VARIABLES = "variables"
"""Channel metadata that describes a message made from the variables of a slave."""
CHECKSUM = "checksum"
"""Key of a metadata record: the checksum of its other values."""
RECOVERED = "recovered"
"""Metadata record that says what a mended log lacks."""
NO_MEANING = (ValueError, KeyError, TypeError, IndexError, AttributeError, OverflowError, RecursionError, struct.error)


class Log(NamedTuple):
    """What is in a log, before it is understood."""

    channels: dict[int, Any]
    times: dict[str, list[int]]
    """Topic -> times of its messages [ns]."""
    messages: dict[str, list[bytes]]
    metadata: dict[str, dict[str, str]]


def read_log(path: Path) -> Recording:
    """Return what is in the log at ``path``. Raises ``BadInput`` if it is not a complete log of ours."""
    log = open_log(path)
    try:
        recording = _recording(log, path)
    except BadInput:
        raise
    except ValidationError as error:
        raise explain(error, path, list(Told.model_fields)) from error
    except NO_MEANING as error:
        raise BadInput(f"is not laid out as apa writes it ({type(error).__name__}: {error})", file=path) from error
    lacks = recording.info.get(RECOVERED, {}).get("lacks")
    if lacks:
        say(f"apa: warning: {path}: is a mended log; it lacks {lacks}")
    return recording


def open_log(path: Path) -> Log:
    """Return the messages and metadata of a log. Raises ``BadInput`` for a damaged one, with the place."""
    data = file_bytes(path)
    try:
        sure = check(data)
        log = _sorted_out(unpacked_records(data))
    except Damage as damage:
        raise BadInput(f"is not a complete log ({damage}); try: apa recover {path}", file=path) from damage
    if not sure:
        say(f"apa: warning: {path}: has no checksum over all of it; a damage in it may go unseen")
    return log


def log_file(text: str) -> Path:
    """Return the log that an argument of a command means: a file, or the folder of a run."""
    path = Path(text)
    if not path.is_dir():
        return path
    whole, part = path / "run.mcap", path / "run.mcap.part"
    return part if part.is_file() and not whole.is_file() else whole


def read_info(path: Path) -> dict[str, Any]:
    """Return what a log says of its scenario, FMUs, seed and versions; empty if it is no complete log."""
    try:
        pieces = top_records(file_bytes(path))
        found = {item.name: item.metadata for item in (_metadata(piece) for piece in pieces) if item is not None}
        return without_checksum("apa", found.get("apa", {}))
    except (BadInput, Damage, *NO_MEANING):
        return {}


def _metadata(piece: RawRecord) -> Any:
    return parsed(Metadata, piece) if piece.opcode == Opcode.METADATA else None


def _sorted_out(pieces: Iterable[RawRecord]) -> Log:
    log = Log({}, {}, {}, {})
    for piece in pieces:
        if piece.opcode == Opcode.MESSAGE:
            if len(piece.body) < MESSAGE.size:
                raise Damage(piece.at, "a message is too short")
            number, _, time, _ = MESSAGE.unpack_from(piece.body)
            if number not in log.channels:
                raise Damage(piece.at, "a message has no channel")
            topic = log.channels[number].topic
            log.times.setdefault(topic, []).append(time)
            log.messages.setdefault(topic, []).append(bytes(piece.body[MESSAGE.size :]))
        elif piece.opcode == Opcode.CHANNEL:
            channel = parsed(Channel, piece)
            log.channels[channel.id] = channel
        elif piece.opcode == Opcode.METADATA:
            record = parsed(Metadata, piece)
            log.metadata[record.name] = record.metadata
    return log


def _recording(log: Log, path: Path) -> Recording:
    signals: dict[str, Any] = {}
    parameters: dict[str, float] = {}
    known: dict[str, Variable] = {}
    clocks: list[list[int]] = []
    for channel in log.channels.values():
        if VARIABLES not in channel.metadata or channel.topic not in log.messages:
            continue
        owner, is_parameter = channel.topic.strip("/").partition("/")[::2]
        variables = from_json(channel.metadata[VARIABLES])
        values = Decoder(variables).decode(log.messages.pop(channel.topic), path)
        for place, variable in enumerate(variables):
            name = f"{owner}.{variable.name}"
            known[name] = variable
            if is_parameter:
                parameters[name] = float(values[-1, place])
            else:
                signals[name] = values[:, place]
        if not is_parameter:
            clocks.append(log.times[channel.topic])
    if any(clock != clocks[0] for clock in clocks):
        raise BadInput("its slaves have been seen at different times", file=path)
    clock = np.array(clocks[0] if clocks else [], dtype=np.int64)
    if (np.diff(clock) <= 0).any():
        raise BadInput("its times do not rise", file=path)
    info = {name: without_checksum(name, values) for name, values in log.metadata.items()}
    return Recording(clock, signals, parameters, known, _told({**info.pop("apa", {}), **info}))


class Told(BaseModel):
    """What a log tells of its run beside its signals, as far as anybody asks for it."""

    scenario: dict[str, Any] | None = None
    end: dict[str, Any] = {}
    recovered: dict[str, Any] = {}
    versions: dict[str, str] = {}
    fmus: list[FmuUsed] = []
    started: Started = Started()
    realtime: Lateness | None = None


def _told(info: dict[str, Any]) -> dict[str, Any]:
    """Return what a log tells of its run. Raises ``ValidationError`` if it is not of the kind that apa writes."""
    Told(**info)
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


def from_json(text: str) -> list[Variable]:
    """Return the variables that a channel's metadata describes (see ``recording.to_json``)."""
    result = []
    for row in json.loads(text):
        states = _enum(row["states"]) if row["states"] else None
        signal = Signal(row["unit"], row["text"], states=states)
        result.append(Variable(str(row["name"]), KINDS[row["type"]], signal, KINDS[row["type"]]()))
    return result


def _enum(states: dict[str, Any]) -> type[IntEnum]:
    """Return the states of a variable; raises ``OverflowError`` if one is no FMI integer."""
    functional: Any = IntEnum
    made: type[IntEnum] = functional(states["name"], states["values"])
    if any(not -MOST_WHOLE <= state < MOST_WHOLE for state in made):
        raise OverflowError("a state is no 32-bit integer")
    return made
