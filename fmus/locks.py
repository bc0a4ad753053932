"""One process makes a file, the others wait for it: compiling the same model twice at once helps nobody."""

from collections.abc import Iterator
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
