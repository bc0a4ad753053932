"""The lines that models and the run itself wrote to a log."""

from pathlib import Path

from foxglove_schemas_protobuf.Log_pb2 import Log
from google.protobuf.message import DecodeError

from orchestrator.log.line import Line, line_of
from orchestrator.log.read_log import open_log
from orchestrator.text.errors import BadInput

TOPIC = "/log"


def read_messages(path: Path) -> list[Line]:
    """Return the messages in the log at ``path``, in order. Raises ``BadInput`` if it cannot be read."""
    log = open_log(path)
    lines = []
    for t_ns, data in zip(log.times.get(TOPIC, ()), log.messages.get(TOPIC, ()), strict=True):
        try:
            entry = Log.FromString(data)
        except DecodeError as error:
            raise BadInput(f"has a message that is none ({error})", file=path) from error
        lines.append(line_of(t_ns, int(entry.level), entry.name, entry.message))
    return lines
