"""A folder that one command writes to, and no other meanwhile."""

import os
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path

from fmus.files import forget_parts, hold
from orchestrator.inputs.text.errors import BadInput


@contextmanager
def lock_folder(folder: Path) -> Iterator[None]:
    """Make ``folder`` and let no other command write there until this is over, or the process dies.

    What a killed command left unfinished there, its log aside, is removed. Raises ``BadInput`` if it is in use.
    """
    folder.mkdir(parents=True, exist_ok=True)
    try:
        handle = hold(folder)
    except BlockingIOError:
        raise BadInput("another command is writing there; wait for it or name another --out", file=folder) from None
    try:
        forget_parts(folder)
        yield
    finally:
        os.close(handle)


def lock_with(source: Path, target: Path) -> AbstractContextManager[None]:
    """Own the folder of ``target`` if ``source`` is in it too: it may not change while one is made of the other."""
    beside = source.is_file() and source.parent.resolve() == target.parent.resolve()
    return lock_folder(target.parent) if beside else nullcontext()
