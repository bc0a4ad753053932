"""The memory that the process of an FMU and ours have in common: time and step, the inputs, the outputs."""

import mmap
import os
import sys
from pathlib import Path

import numpy as np

from orchestrator.simulation.imported import worker


class SharedNumbers:
    """Time and step, inputs and outputs, as doubles.

    On Linux their size is sealed: a process that reads memory of a file that was made shorter ends with SIGBUS, and
    an FMU could do so to ours.
    """

    def __init__(self, folder: Path, inputs: int, outputs: int) -> None:
        size = worker.TIMES.size + 8 * (inputs + outputs)
        self._handle = _create_sealed_memory(size) if sys.platform == "linux" else _file(folder / "shared", size)
        self.place: int | str = self._handle if sys.platform == "linux" else str(folder / "shared")
        """What the worker opens: a descriptor that it inherits, or a file."""
        self.memory = mmap.mmap(self._handle, size)
        numbers = np.frombuffer(self.memory)
        self.inputs, self.outputs = numbers[2 : 2 + inputs], numbers[2 + inputs :]
        self.ones = np.ones(outputs)
        """Times the outputs, that is not-a-number if one of them is; and seldom else."""

    @property
    def descriptors(self) -> tuple[int, ...]:
        """Return the descriptors that the worker inherits."""
        return (self._handle,) if sys.platform == "linux" else ()

    def close_handle(self) -> None:
        """Close what the worker has by now."""
        os.close(self._handle)


def _file(path: Path, size: int) -> int:
    path.write_bytes(bytes(size))
    return os.open(path, os.O_RDWR | getattr(os, "O_BINARY", 0))


if sys.platform == "linux":
    import fcntl

    def _create_sealed_memory(size: int) -> int:
        """Return a descriptor of memory whose size nobody can change."""
        handle = os.memfd_create("numbers", os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
        os.ftruncate(handle, size)
        fcntl.fcntl(handle, fcntl.F_ADD_SEALS, fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW | fcntl.F_SEAL_SEAL)
        return handle
