"""A log file back as a ``Recording``: every signal an array by its flat name."""

import json
from enum import IntEnum
from pathlib import Path
from typing import Any

import numpy as np
from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap.writer import MCAP0_MAGIC

from modelkit.signal import Signal
from modelkit.variables import Variable
from orchestrator.cosim.recording import Recording
from orchestrator.log.protobuf_rows import Decoder
from orchestrator.text.errors import BadInput

KINDS: dict[str, type] = {"float": float, "int": int, "bool": bool}
VARIABLES = "variables"
"""Channel metadata that describes a message made from the variables of a slave."""


def read_log(path: Path) -> Recording:
    """Return what is in the log at ``path``. Raises ``BadInput`` if it is not a complete log of ours."""
    try:
        with path.open("rb") as stream:
            return _read(make_reader(stream), path)
    except OSError as error:
        raise BadInput(f"cannot be read: {error.strerror}", file=path) from error
    except McapError as error:
        raise why_unread(path, error) from error


def log_file(text: str) -> Path:
    """Return the log that an argument of a command means: a file, or the folder of a run."""
    path = Path(text)
    if not path.is_dir():
        return path
    whole, part = path / "run.mcap", path / "run.mcap.part"
    return part if part.is_file() and not whole.is_file() else whole


def why_unread(path: Path, error: McapError) -> BadInput:
    """Return why the file at ``path`` is no complete log, with what helps if it is one of ours that was cut."""
    with path.open("rb") as stream:
        if stream.read(len(MCAP0_MAGIC)) != MCAP0_MAGIC:
            return BadInput("is no MCAP log", file=path)
    return BadInput(f"is not a complete log ({error}); try: apa recover {path}", file=path)


def read_info(path: Path) -> dict[str, Any]:
    """Return what a log says of its scenario, FMUs, seed and versions; empty if it is no complete log."""
    try:
        with path.open("rb") as stream:
            records = {item.name: item.metadata for item in make_reader(stream).iter_metadata()}
    except (OSError, McapError):
        return {}
    return {key: json.loads(value) for key, value in records.get("apa", {}).items()}


def _read(reader: Any, path: Path) -> Recording:
    times: dict[str, list[int]] = {}
    messages: dict[str, list[bytes]] = {}
    variables: dict[str, list[Variable]] = {}
    for _, channel, message in reader.iter_messages():
        if VARIABLES in channel.metadata:
            if channel.topic not in variables:
                variables[channel.topic] = from_json(channel.metadata[VARIABLES])
            times.setdefault(channel.topic, []).append(message.log_time)
            messages.setdefault(channel.topic, []).append(message.data)
    info: dict[str, Any] = {}
    for record in reader.iter_metadata():
        info[record.name] = {key: json.loads(value) for key, value in record.metadata.items()}
    signals: dict[str, Any] = {}
    parameters: dict[str, float] = {}
    known: dict[str, Variable] = {}
    clock: list[int] = []
    for topic, rows in messages.items():
        owner, is_parameter = topic.strip("/").partition("/")[::2]
        values = Decoder(variables[topic]).decode(rows, path)
        for place, variable in enumerate(variables[topic]):
            name = f"{owner}.{variable.name}"
            known[name] = variable
            if is_parameter:
                parameters[name] = float(values[-1, place])
            else:
                signals[name] = values[:, place]
        if not is_parameter:
            clock = times[topic]
    return Recording(np.array(clock, dtype=np.int64), signals, parameters, known, {**info.pop("apa", {}), **info})


def from_json(text: str) -> list[Variable]:
    """Return the variables that a channel's metadata describes (see ``recording.to_json``)."""
    result = []
    for row in json.loads(text):
        states = _enum(row["states"]) if row["states"] else None
        signal = Signal(row["unit"], row["text"], states=states)
        result.append(Variable(row["name"], KINDS[row["type"]], signal, KINDS[row["type"]]()))
    return result


def _enum(states: dict[str, Any]) -> type[IntEnum]:
    functional: Any = IntEnum
    made: type[IntEnum] = functional(states["name"], states["values"])
    return made
