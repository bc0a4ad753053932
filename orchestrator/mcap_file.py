"""An MCAP file that survives a kill: 64 KiB chunks handed to the system at once, renamed when complete."""

import os
from pathlib import Path
from types import TracebackType
from typing import Any

from mcap.writer import Writer
from mcap_protobuf.schema import build_file_descriptor_set

CHUNK_SIZE = 64 * 1024
LIBRARY = "apa-cosim"


class _Through:
    """A file whose every write reaches the operating system."""

    def __init__(self, path: Path) -> None:
        self._file = path.open("wb", buffering=0)
        self._size = 0

    def write(self, data: bytes) -> int:
        view = memoryview(data)
        while len(view):
            view = view[self._file.write(view) :]
        self._size += len(data)
        return len(data)

    def tell(self) -> int:
        return self._size

    def close(self) -> None:
        self._file.close()


class McapFile:
    """Writes ``path``.part and renames it to ``path`` on ``close``."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.part = path.with_name(path.name + ".part")
        path.parent.mkdir(parents=True, exist_ok=True)
        self._file: Any = _Through(self.part)
        self.writer = Writer(self._file, chunk_size=CHUNK_SIZE)
        self.writer.start(profile="", library=LIBRARY)
        self._sequence: dict[int, int] = {}
        self.open = True

    def known_channel(self, topic: str, message: type[Any]) -> int:
        """Return a new channel for a generated protobuf message class."""
        descriptors = build_file_descriptor_set(message).SerializeToString(deterministic=True)
        return self.channel(topic, message.DESCRIPTOR.full_name, descriptors, {})

    def channel(self, topic: str, schema: str, descriptors: bytes, metadata: dict[str, str]) -> int:
        """Return a new channel for messages of a type in a serialized FileDescriptorSet."""
        number = self.writer.register_schema(name=schema, encoding="protobuf", data=descriptors)
        return self.writer.register_channel(
            topic=topic, message_encoding="protobuf", schema_id=number, metadata=metadata
        )

    def write(self, channel: int, t_ns: int, data: bytes) -> None:
        """Append one message at ``t_ns`` of simulated time."""
        sequence = self._sequence.get(channel, 0)
        self._sequence[channel] = sequence + 1
        self.writer.add_message(channel, log_time=t_ns, data=data, publish_time=t_ns, sequence=sequence)

    def close(self) -> None:
        """Write the index, sync, rename."""
        if self.open:
            self.open = False
            self.writer.finish()
            self._file.close()
            os.replace(self.part, self.path)

    def __enter__(self) -> "McapFile":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
