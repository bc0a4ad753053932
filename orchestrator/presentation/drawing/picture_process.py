"""The picture of a run, drawn in a process of its own: it imports matplotlib while the run is driven.

That process touches no file: it gets numbers and gives the bytes of a picture, and ends when its input does.
"""

import pickle
import threading
from typing import TYPE_CHECKING, Self

from fmus.children import LIVING, end, own_process

if TYPE_CHECKING:
    from orchestrator.presentation.drawing.overview import Overview


class PictureBeside:
    """Begin it early, hand over what is to be seen, do something else, and ask for the picture."""

    def __init__(self) -> None:
        self._child = own_process("orchestrator.presentation.drawing.painter")
        self._thread: threading.Thread | None = None
        self._drawn = self._printed = b""
        LIVING.add(self._child)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        """End the process, whatever it does."""
        if self._child.poll() is None:
            end(self._child)
        if self._thread is not None:
            self._thread.join()
        with self._child:
            LIVING.discard(self._child)

    def begin(self, seen: "Overview") -> None:
        """Have the picture drawn; returns at once."""
        self._thread = threading.Thread(target=self._talk, args=(pickle.dumps(seen),), daemon=True)
        self._thread.start()

    def picture(self) -> bytes:
        """Return the PNG file. Raises ``RuntimeError`` with what went wrong there."""
        assert self._thread is not None
        self._thread.join()
        if self._child.returncode != 0:
            raise RuntimeError(f"the picture was not drawn:\n{self._printed.decode(errors='replace')}")
        return self._drawn

    def _talk(self, data: bytes) -> None:
        self._drawn, self._printed = self._child.communicate(data)
