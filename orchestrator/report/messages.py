"""The lines that models and the run itself wrote to a log."""

from pathlib import Path
from typing import NamedTuple

from foxglove_schemas_protobuf.Log_pb2 import Log
from mcap.exceptions import McapError
from mcap.reader import make_reader

from orchestrator.log.read_log import why_unread
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
    lines = []
    try:
        with path.open("rb") as stream:
            for _, _, message in make_reader(stream).iter_messages(topics=[TOPIC]):
                entry = Log.FromString(message.data)
                level = LEVELS.get(int(entry.level), "unknown")
                lines.append(Line(message.log_time / 1e9, level, entry.name, entry.message))
    except OSError as error:
        raise BadInput(f"cannot be read: {error.strerror}", file=path) from error
    except McapError as error:
        raise why_unread(path, error) from error
    return lines
