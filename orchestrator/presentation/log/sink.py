"""Where channels and messages of a log go: a file, or whoever looks on."""

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray


class MessageSink(Protocol):
    """Takes messages; times are simulated time."""

    def write(self, channel: int, t_ns: int, data: bytes) -> None:
        """Take one message."""

    def write_rows(self, channel: int, t_ns: NDArray[np.int64], rows: NDArray[np.uint8]) -> None:
        """Take messages of equal size, one per row, behind room for its header (``mcap_file.HEADER_SIZE`` bytes)."""


class Sink(MessageSink, Protocol):
    """Takes channels, then messages."""

    open: bool

    def metadata(self, name: str, values: dict[str, str]) -> None:
        """Take what is said of the whole run."""

    def add_channel(self, topic: str, message: type[Any]) -> int:
        """Return a new channel for a generated protobuf message class."""

    def channel(self, topic: str, schema: str, descriptors: bytes, metadata: dict[str, str]) -> int:
        """Return a new channel for messages of a type in a serialized FileDescriptorSet."""

    def later(self, write: Callable[[MessageSink], None]) -> None:
        """Take the messages that ``write`` writes, at once or in another thread while the run goes on."""

    def flush(self) -> None:
        """Hand on what is still in hand."""

    def close(self) -> None:
        """Take nothing more. Safe to call twice."""
