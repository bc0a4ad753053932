"""Files that are whole or not there, and folders for a while that do not outlive who made them.

Everything that this project writes goes through :func:`whole` (or through a log, which has a name of its own while it
is unfinished), and everything it needs for a while lies in one folder of the process: removed when it ends, and by the
next process if it was killed.
"""

import atexit
import errno
import os
import re
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path

MARK = ".part"
PERMISSION_BITS = 0o777
_numbers = count()
_making = threading.Lock()
ROOM = "apa-tmp-"
"""How the names of folders for a while begin."""
NEW = "apa-new-"
"""How they begin until their lock is held: what is called ``ROOM`` and not locked is nobody's."""
HIDDEN = "."
"""Begins those that lie beside what they will be."""
MIN_STALE_AGE = 60.0
"""A folder called ``NEW`` is left alone so long [s]."""
PLAIN = re.compile(r"[A-Za-z0-9_./\\:~-]+")
"""Paths that every FMU can be unpacked to: PythonFMU crashes on others."""


@contextmanager
def whole(path: Path, *, sync: bool = False) -> Iterator[Path]:
    """Give a new path beside ``path`` to write to, then move it there: no reader sees half of it.

    Its folder is made, and permissions of a file that was there are kept. With ``sync`` it outlives a power cut. Raises
    ``OSError`` that names ``path``; then what was there is still there.
    """
    try:
        if path.exists() and not path.is_file() and not path.is_dir():
            yield path  # a device or a pipe: there is nothing beside it
            return
        path = _resolve(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_name(f".{ROOM}{os.getpid()}-{next(_numbers)}{MARK}{path.suffix}")
        try:
            yield part
            if sync:
                sync_to_disk(part)
            with suppress(OSError):  # nothing was there, or the file system has no permissions
                part.chmod(path.stat().st_mode & PERMISSION_BITS)
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)
        if sync:
            sync_to_disk(path.parent)
    except OSError as error:
        named = _with_target(error, path)
        if named is error:
            raise  # not from itself: who follows the causes would never end
        raise named from error


def write_whole(path: Path, content: bytes | str, *, sync: bool = False) -> None:
    """Write a file beside ``path``, then move it there: see :func:`whole`."""
    with whole(path, sync=sync) as part:
        part.write_bytes(content.encode(errors="backslashreplace") if isinstance(content, str) else content)


def sync_to_disk(path: Path) -> None:
    """Wait until a file, or the names in a folder, are on the disk."""
    if os.name == "posix":
        handle = os.open(path, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def forget_parts(folder: Path) -> None:
    """Remove what writers that were killed left in ``folder``; call it only while nobody else may write there."""
    for part in folder.glob(f".{ROOM}*{MARK}*"):
        part.unlink(missing_ok=True)


def _resolve(path: Path) -> Path:
    """Return the file that a path means. Raises ``OSError`` for one that is a ring of links, or no file's name."""
    try:
        found = path.resolve()
    except RuntimeError as error:
        raise OSError(errno.ELOOP, "too many levels of symbolic links (a cycle)", str(path)) from error
    if not found.name:
        raise IsADirectoryError(errno.EISDIR, "is a folder", str(path))
    return found


def _with_target(error: OSError, path: Path) -> OSError:
    """Return the error with the place that was meant, not the one beside it."""
    if error.filename is None or MARK in Path(str(error.filename)).name:
        return type(error)(error.errno, error.strerror or str(error), str(path))
    return error


_room: tuple[Path, int] | None = None


def new_folder(name: str) -> Path:
    """Return a new folder for a while; its path is plain. Remove it with :func:`remove_folder`. Raises ``OSError``."""
    import tempfile

    with _making:
        folder = Path(tempfile.mkdtemp(prefix=f"{name}-", dir=own_room()))
    return folder


def remove_folder(folder: Path) -> None:
    """Remove a folder, as far as that can be done, also one that is too deep for ``shutil``, or closed to its owner."""
    import shutil

    with suppress(RecursionError):
        shutil.rmtree(folder, ignore_errors=True)
    if folder.is_dir() and not folder.is_symlink():
        with suppress(OSError):
            _flatten(folder)
            shutil.rmtree(folder, ignore_errors=True)


def _flatten(folder: Path) -> None:
    """Empty every folder in ``folder``, and move those in them up into it."""
    numbers = count()
    waiting = [folder]
    while waiting:
        place = waiting.pop()
        place.chmod(0o700)
        for entry in list(os.scandir(place)):
            if not entry.is_dir(follow_symlinks=False):
                os.unlink(entry.path)
                continue
            above = folder / f"{MARK}{next(numbers)}"
            os.chmod(entry.path, 0o700)
            os.rename(entry.path, above)
            waiting.append(above)


@contextmanager
def folder_for_a_while(name: str) -> Iterator[Path]:
    """Give a new folder and remove it."""
    folder = new_folder(name)
    try:
        yield folder
    finally:
        remove_folder(folder)


def remove_all_folders() -> None:
    """Remove all that this process has for a while."""
    global _room
    if _room is not None:
        folder, handle = _room
        _room = None
        remove_folder(folder)
        if handle >= 0:
            os.close(handle)


def live_in(room: Path) -> None:
    """Let this process, a worker of another, keep its folders in the room of that one, which removes them."""
    import tempfile

    global _room
    _room = Path(tempfile.mkdtemp(prefix="worker-", dir=room)), -1


def own_room() -> Path:
    """Return the folder of this process, locked while it lives; folders of processes that are gone are removed."""
    import shutil  # noqa: F401 - it must be there when the program is ended at once

    global _room
    if _room is None or not _room[0].is_dir():
        _room = _lock_new_folder(_plain_parent(), "")
        atexit.register(remove_all_folders)
    return _room[0]


@contextmanager
def whole_folder(path: Path) -> Iterator[Path]:
    """Give the path of a new folder to make, then move it to ``path`` in place of the one there.

    It lies beside ``path``, hidden. What a killed process left there is removed first. Raises ``OSError``.
    """
    path = _resolve(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    room, handle = _lock_new_folder(path.parent, HIDDEN)
    try:
        made, former = room / path.name, room / f"{path.name}{MARK}"
        yield made
        if path.exists():
            path.rename(former)
        try:
            made.rename(path)
        except OSError:
            if former.exists():
                former.rename(path)
            raise
    finally:
        remove_folder(room)
        if handle >= 0:
            os.close(handle)


def _lock_new_folder(parent: Path, dot: str) -> tuple[Path, int]:
    """Return a new folder in ``parent`` and the handle of its lock; those whose process is gone are removed."""
    import tempfile

    _remove_forsaken(parent, dot)
    new = Path(tempfile.mkdtemp(prefix=f"{dot}{NEW}", dir=parent))
    handle = hold(new)
    folder = new.with_name(f"{dot}{ROOM}{new.name.removeprefix(f'{dot}{NEW}')}")
    new.rename(folder)
    return folder, handle


def _plain_parent() -> Path:
    """Return the folder for temporary files, or another one if its path is not plain."""
    import tempfile

    for name in (tempfile.gettempdir(), "/tmp", "C:\\Temp"):
        if PLAIN.fullmatch(name) and os.path.isdir(name) and os.access(name, os.W_OK):
            return Path(name)
    raise OSError(None, "no folder for temporary files with a path of plain letters; set TMPDIR to one")


def _remove_forsaken(parent: Path, dot: str = "") -> None:
    """Remove the folders of processes that were killed: those whose lock nobody holds."""
    if os.name != "posix":
        return
    for folder in (*parent.glob(f"{dot}{ROOM}*"), *parent.glob(f"{dot}{NEW}*")):
        with suppress(OSError):
            state = folder.lstat()
            is_made = folder.name.startswith(f"{dot}{ROOM}") or time.time() - state.st_ctime > MIN_STALE_AGE
            if is_made and not folder.is_symlink() and state.st_uid == os.getuid():
                handle = hold(folder)
                remove_folder(folder)
                os.close(handle)


def hold(folder: Path) -> int:
    """Return a handle with the lock on ``folder``, which dies with the process.

    Raises ``BlockingIOError`` if another process holds it. Where folders cannot be locked, none does.
    """
    if os.name != "posix":
        return os.open(os.devnull, os.O_RDONLY)
    import fcntl

    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(handle)
        raise
    except OSError:
        pass
    return handle
