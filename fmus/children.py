"""Programs that are run for us: each ends, with all that it has started, when we end."""

import os
import signal
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import subprocess

LIVING: set["subprocess.Popen[Any]"] = set()


def run_child(command: Sequence[str], folder: Path | None = None, environment: Mapping[str, str] | None = None) -> Any:
    """Return the ``CompletedProcess`` of a command with what it wrote as text; an exception ends it first."""
    import subprocess

    pipe = subprocess.PIPE
    group: dict[str, Any] = {"start_new_session": True} if os.name == "posix" else {}
    texts: dict[str, Any] = {"text": True, "encoding": "utf-8", "errors": "replace"}
    with subprocess.Popen(
        command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=pipe, stderr=pipe, **texts, **group
    ) as child:
        LIVING.add(child)
        try:
            output, errors = child.communicate()
        except BaseException:
            end(child)
            raise
        finally:
            LIVING.discard(child)
    return subprocess.CompletedProcess(command, child.returncode, output, errors)


def end(child: "subprocess.Popen[str]") -> None:
    """End a child and its own children at once."""
    with suppress(OSError):
        if os.name == "posix":
            os.killpg(child.pid, signal.SIGKILL)
        else:
            child.kill()


def end_all() -> None:
    """End every child, and every process of ``multiprocessing``."""
    for child in list(LIVING):
        end(child)
    multiprocessing = sys.modules.get("multiprocessing")
    for process in multiprocessing.active_children() if multiprocessing else ():
        with suppress(Exception):
            process.kill()
