"""The process of an FMU behind bubblewrap: no network, no other processes, and nothing to write to but its folder."""

import os
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

from fmus.children import ROOT
from orchestrator.inputs.text.errors import BadInput

PROGRAM = "bwrap"
HIDDEN = ("/home", "/root", "/tmp", "/var/tmp", "/run", "/mnt", "/media")
"""Folders of which an FMU sees nothing but what it needs."""


def sandbox_command(folder: Path) -> list[str]:
    """Return what begins the command of a process that may write to ``folder`` alone.

    Raises ``BadInput`` where bubblewrap is absent or may not be used.
    """
    program = sandbox_program()
    visible = {sys.prefix, sys.base_prefix, sys.exec_prefix, str(ROOT), *map(_real, sys.path), _real(sys.executable)}
    command = [program, "--unshare-all", "--die-with-parent", "--new-session", "--cap-drop", "ALL", "--clearenv"]
    command += ["--ro-bind", "/", "/", "--dev", "/dev", "--proc", "/proc"]
    command += [word for path in HIDDEN if Path(path).is_dir() for word in ("--tmpfs", path)]
    for path in sorted(visible):
        if path and Path(path).exists() and path.startswith(HIDDEN):
            command += ["--ro-bind", path, path]
    for name in ("PATH", "LANG", "LD_LIBRARY_PATH"):
        if name in os.environ:
            command += ["--setenv", name, os.environ[name]]
    return [*command, "--bind", str(folder), str(folder), "--setenv", "TMPDIR", str(folder), "--"]


def _real(path: str) -> str:
    return os.path.abspath(path) if path else ""


@cache
def sandbox_program() -> str:
    """Return bubblewrap's place, when it works here."""
    program = shutil.which(PROGRAM)
    if program is None:
        raise BadInput(
            f"needs bubblewrap ({PROGRAM}), which is not installed here; run apa in a container or as another user "
            "instead (docs/third-party-fmus.md)",
            key="--sandbox",
        )
    test = [program, "--unshare-all", "--ro-bind", "/", "/", "--proc", "/proc", "--dev", "/dev", "true"]
    tried = subprocess.run(test, capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL)
    if tried.returncode != 0:
        why = (tried.stderr.strip().splitlines() or ["no reason"])[-1]
        raise BadInput(f"bubblewrap cannot be used here: {why}", key="--sandbox")
    return program
