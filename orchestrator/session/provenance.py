"""What it takes to repeat a run: scenario, FMUs with their hashes, seed, versions, and when and how it was started."""

import os
import platform
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterable
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.console import COMMAND
from orchestrator.session.foreign import FOREIGN, ImportedFmus, sha256_of
from orchestrator.simulation.cosim.fmu_instance import FmuInstance

PACKAGES = ("apa-cosim", "fmpy", "pythonfmu", "numpy", "mcap", "protobuf")
GIT_TIMEOUT = 2.0
"""Wall-clock limit of one call of git [s]; a repository that takes longer is not named."""


def provenance(
    scenario: Scenario, instances: Iterable[FmuInstance], kind: str, foreign: ImportedFmus
) -> dict[str, Any]:
    """Return scenario, FMUs (name, kind, GUID, path, SHA-256), seed and versions of a run: equal for equal runs."""
    return {
        "scenario": scenario.model_dump(mode="json", exclude={"file"}),
        "fmus": [
            _fmu_used(instance, FOREIGN if instance.name in foreign.files else kind)
            for instance in instances
            if instance.identity
        ],
        "seed": scenario.seed,
        "versions": versions(),
    }


def start_record() -> dict[str, Any]:
    """Return time (UTC, ISO 8601), command line, folder and git commit: what differs between two equal runs.

    ``SOURCE_DATE_EPOCH`` [s since 1970] sets the time, for results that are equal byte by byte.
    """
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    now = datetime.fromtimestamp(int(epoch), UTC) if epoch.isdecimal() else datetime.now(UTC)
    return {
        "time": now.strftime("%Y-%m-%dT%H:%M:%SZ"),
        "command": COMMAND.get() or f"python: {shlex.join(sys.argv)}",
        "folder": str(Path.cwd()),
        "git": git_commit(Path.cwd()),
    }


def git_commit(folder: Path) -> str:
    """Return the commit of the repository that contains ``folder``, ``-modified`` behind it if a tracked file differs.

    Empty outside a repository, or where git is missing or slow.
    """
    commit = _git(folder, "rev-parse", "HEAD").strip()
    if not commit:
        return ""
    return f"{commit}-modified" if _git(folder, "status", "--porcelain", "--untracked-files=no").strip() else commit


def _git(folder: Path, *words: str) -> str:
    git = shutil.which("git")
    if git is None:
        return ""
    environment = {**os.environ, "GIT_OPTIONAL_LOCKS": "0"}
    try:
        done = subprocess.run(
            [git, *words], cwd=folder, env=environment, capture_output=True, timeout=GIT_TIMEOUT, check=False
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return done.stdout.decode(errors="replace") if done.returncode == 0 else ""


def _fmu_used(instance: FmuInstance, kind: str) -> dict[str, str]:
    """Return which FMU an instance is; for a model in process, the hash of the sources of all models."""
    used = {"name": instance.name, "kind": kind, "guid": instance.identity}
    path: Path | None = getattr(instance, "path", None)
    if path is None:
        from orchestrator.simulation.cosim.fmu_files import ROOT, sources_hash

        return {**used, "path": str(ROOT), "sha256": sources_hash()}
    return {**used, "path": str(path.resolve()), "sha256": sha256_of(path)}


def versions() -> dict[str, str]:
    """Return the versions of Python, of this project and of the packages that a run depends on."""
    return {"python": platform.python_version(), **{package: _version(package) for package in PACKAGES}}


@cache
def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"
