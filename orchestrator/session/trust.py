"""Code that a received file refers to - Python models, FMUs - is run only in folders that the user trusts.

What is named on the command line needs no question, nor does a program that imports this package.
"""

import os
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from orchestrator.inputs.text.console import QUIET, say
from orchestrator.inputs.text.errors import BadInput, format_value
from orchestrator.inputs.text.printable import printable


class _Policy:
    """Holds in all threads, unlike a context variable: ``apa test -j`` loads scenarios in several."""

    now = "all"
    """``all``: nobody is asked; ``ask``: of each new folder; ``remember``: new folders are trusted from now on."""


@contextmanager
def trusting(policy: str) -> Iterator[None]:
    """Let a policy hold: ``ask`` or ``remember``."""
    before, _Policy.now = _Policy.now, policy
    try:
        yield
    finally:
        _Policy.now = before


VARIABLE = "APA_TRUST"
"""Environment variable that is set to ``all`` where a machine runs trusted files only, as in CI."""
MAX_NAMES = 3


def require_trust(origin: Path, code: Iterable[str]) -> None:
    """Return if the folder of ``origin``, which refers to ``code``, is trusted; else ask.

    Raises ``BadInput`` where the answer is no, or nobody can be asked.
    """
    names = list(dict.fromkeys(code))
    folder = origin.resolve().parent
    if not names or _Policy.now == "all" or os.environ.get(VARIABLE) == "all" or is_trusted(folder):
        return
    more = f" and {len(names) - MAX_NAMES} more" if len(names) > MAX_NAMES else ""
    listed = ", ".join(format_value(name) for name in names[:MAX_NAMES]) + more
    if _Policy.now != "remember" and not _agrees(origin, listed, folder):
        text = f"runs code that comes with it: {listed}; add --trust if you trust {folder} (it is remembered)"
        raise BadInput(text, file=origin)
    trust_folder(folder)


def is_trusted(folder: Path) -> bool:
    """Return whether a folder, or one that it is in, is trusted."""
    try:
        known = set(_file().read_text(encoding="utf-8").splitlines())
    except OSError:
        return False
    return any(str(path) in known for path in (folder, *folder.parents))


def _agrees(origin: Path, listed: str, folder: Path) -> bool:
    """Ask on the terminal; without one the answer is no."""
    if QUIET.get() or not (sys.stdin is not None and sys.stdin.isatty() and sys.stderr.isatty()):
        return False
    print(printable(f"apa: {origin} runs code that comes with it: {listed}"), file=sys.stderr)
    print(printable(f"Trust everything in {folder}? [y/N] "), end="", file=sys.stderr, flush=True)
    return sys.stdin.readline().strip().lower() in ("y", "yes")


def trust_folder(folder: Path) -> None:
    """Remember that a folder is trusted, unless all are."""
    folder = folder.resolve()
    if os.environ.get(VARIABLE) == "all" or is_trusted(folder):
        return
    try:
        file = _file()
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("a", encoding="utf-8") as stream:
            stream.write(f"{folder}\n")
    except OSError as error:
        say(f"apa: warning: trust in {folder} is not remembered: {error.strerror}")


def _file() -> Path:
    from platformdirs import user_config_path

    return user_config_path("apa-cosim", appauthor=False) / "trusted-folders"
