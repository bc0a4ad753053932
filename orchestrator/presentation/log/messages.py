"""The lines that models and the run itself wrote to a log."""

from pathlib import Path
from typing import Any

import numpy as np
from foxglove_schemas_protobuf.Log_pb2 import Log
from google.protobuf.message import DecodeError
from numpy.typing import NDArray

from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.log.line import MAX_LINES, Line, line_of
from orchestrator.presentation.log.read_log import Handler, scan_log

TOPIC = "/log"


def read_messages(path: Path) -> list[Line]:
    """Return the first messages in the log at ``path``, in order. Raises ``BadInput`` if it cannot be read."""
    lines: list[Line] = []

    def take(times: NDArray[np.int64], messages: NDArray[np.uint8]) -> None:
        for t_ns, data in zip(times.tolist(), messages, strict=True):
            if len(lines) == MAX_LINES:
                return
            try:
                entry = Log.FromString(data.tobytes())
            except DecodeError as error:
                raise BadInput(f"has a message that is none ({error})", file=path) from error
            lines.append(line_of(t_ns, int(entry.level), entry.name, entry.message))

    def handler(channel: Any) -> Handler | None:
        return take if channel.topic == TOPIC else None

    scan_log(path, handler)
    return lines
