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

ROOT = Path(__file__).resolve().parents[1]
BEGIN = """
import sys
sys.path.insert(0, sys.argv[1])
from {module} import main
del sys.path[0]
main()
"""
"""What a process of ours runs: no module of this project shadows its own."""
LIVING: set["subprocess.Popen[Any]"] = set()
PYTHON = str(Path(sys.executable).absolute()) if sys.executable else ""
"""The interpreter that runs this, from any folder: with a relative entry in ``PATH`` its own name is relative."""


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


def own_process(
    module: str,
    folder: Path | None = None,
    errors: Any = None,
    wrapper: Sequence[str] = (),
    inherited: Sequence[int] = (),
) -> "subprocess.Popen[bytes]":
    """Return a process that runs ``main()`` of a module of ours; it talks through its standard streams, in bytes.

    ``wrapper`` begins the command, as ``bwrap --``. What it writes as errors goes into a pipe too, unless a file is
    named; it has the descriptors ``inherited``, too. Whoever asked for it puts it into ``LIVING`` and takes it out.
    Ctrl-C does not reach it.
    """
    import subprocess

    pipe = subprocess.PIPE
    command = [*wrapper, PYTHON, "-P", "-c", BEGIN.format(module=module), str(ROOT)]
    group: dict[str, Any] = {"start_new_session": True} if os.name == "posix" else {}
    streams: dict[str, Any] = {"stdin": pipe, "stdout": pipe, "stderr": errors or pipe, "pass_fds": inherited}
    return subprocess.Popen(command, cwd=folder, bufsize=0, **streams, **group)


def end(child: "subprocess.Popen[Any]") -> None:
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
