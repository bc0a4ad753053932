"""The lines that models and the run itself wrote to a log."""

from pathlib import Path
from typing import NamedTuple

from foxglove_schemas_protobuf.Log_pb2 import Log
from google.protobuf.message import DecodeError

from orchestrator.log.read_log import open_log
from orchestrator.text.errors import BadInput

LEVELS = {0: "unknown", 1: "debug", 2: "info", 3: "warning", 4: "error", 5: "fatal"}
TOPIC = "/log"


class Line(NamedTuple):
    """One message."""

    t: float
    """Simulated time [s]."""
    level: str
    name: str
    """Who said it."""
    text: str


def read_messages(path: Path) -> list[Line]:
    """Return the messages in the log at ``path``, in order. Raises ``BadInput`` if it cannot be read."""
    log = open_log(path)
    lines = []
    for t_ns, data in zip(log.times.get(TOPIC, ()), log.messages.get(TOPIC, ()), strict=True):
        try:
            entry = Log.FromString(data)
        except DecodeError as error:
            raise BadInput(f"has a message that is none ({error})", file=path) from error
        level = LEVELS.get(int(entry.level), "unknown")
        lines.append(Line(t_ns / 1e9, level, entry.name, entry.message))
    return lines
