"""One process makes a file, the others wait for it: compiling the same model twice at once helps nobody.

What is kept was made by this user, and is what was made: its hash lies beside it and is looked at before it is used.
"""

import hashlib
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from fmus.files import write_whole


@contextmanager
def one_at_a_time(path: Path) -> Iterator[None]:
    """Hold the lock beside ``path`` (its folder is made); let go of by the system if the process dies."""
    from filelock import FileLock

    path.parent.mkdir(parents=True, exist_ok=True)
    with FileLock(path.with_name(f"{path.name}.lock")):
        yield


def cache_file(folder: Path, name: str, key: str, suffix: str, make: Callable[[], bytes], most: int = 0) -> Path:
    """Return ``folder/name-key.suffix``, made by ``make`` if there is none or it is not what was made.

    No reader ever sees half of it. When one is made, all but the ``most`` newest of this name and suffix are deleted;
    0: none.
    """
    path = folder / f"{name}-{key}{suffix}"
    if is_as_made(path):
        return path
    with one_at_a_time(folder / f"{name}{suffix}"):
        if not is_as_made(path):
            write_made(path, make())
            if most:
                _forget_old(folder, name, suffix, most)
    return path


def write_made(path: Path, content: bytes) -> None:
    """Write a file and beside it its hash."""
    write_whole(path, content)
    write_whole(_hash_file(path), hashlib.sha256(content).hexdigest())


def is_as_made(path: Path) -> bool:
    """Return whether a file is this user's, or the system's, and has the hash that was written beside it."""
    try:
        if hasattr(os, "getuid") and path.stat().st_uid not in (os.getuid(), 0) and os.getuid() != 0:
            return False
        return _hash_file(path).read_text(encoding="ascii") == hashlib.sha256(path.read_bytes()).hexdigest()
    except (OSError, UnicodeDecodeError):
        return False


def _hash_file(path: Path) -> Path:
    return path.with_name(f"{path.name}.sha256")


def _forget_old(folder: Path, name: str, suffix: str, most: int) -> None:
    """Delete all but the ``most`` newest files of a name and suffix."""
    by_age = sorted(folder.glob(f"{name}-*{suffix}"), key=lambda path: path.stat().st_mtime)
    for path in by_age[:-most]:
        path.unlink(missing_ok=True)
        _hash_file(path).unlink(missing_ok=True)
