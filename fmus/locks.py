"""One process makes a file, the others wait for it: compiling the same model twice at once helps nobody."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def one_at_a_time(path: Path) -> Iterator[None]:
    """Hold the lock beside ``path`` (its folder is made); let go of by the system if the process dies.

    Where there is no ``fcntl`` (Windows), nothing is locked: the same work may be done twice, no harm else.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        import fcntl
    except ImportError:
        yield
        return
    with path.with_name(f"{path.name}.lock").open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def kept_file(folder: Path, name: str, key: str, suffix: str, make: Callable[[], bytes], most: int = 0) -> Path:
    """Return ``folder/name-key.suffix``, made by ``make`` if there is none; no reader ever sees half of it.

    When one is made, all but the ``most`` newest of this name and suffix are deleted; 0: none.
    """
    path = folder / f"{name}-{key}{suffix}"
    with one_at_a_time(folder / f"{name}{suffix}"):
        if not path.exists():
            write_whole(path, make())
            if most:
                _forget_old(folder, name, suffix, most)
    return path


def write_whole(path: Path, content: bytes) -> None:
    """Write a file beside ``path``, then move it there, so that no reader sees half of it."""
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    part.write_bytes(content)
    part.replace(path)


def _forget_old(folder: Path, name: str, suffix: str, most: int) -> None:
    """Delete all but the ``most`` newest files of a name and suffix."""
    by_age = sorted(folder.glob(f"{name}-*{suffix}"), key=lambda path: path.stat().st_mtime)
    for path in by_age[:-most]:
        path.unlink(missing_ok=True)
