"""Runs mutants: a copy of the checkout in which one mistake after the other is made, a process for each.

What all need is imported once, before the first; each is then a fork that imports the models with the mistake.
"""

import importlib
import multiprocessing
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from tests.mutants.checks import CHECKS
from tests.mutants.sites import Mutant

ROOT = Path(__file__).parent.parent.parent
MOST_CPU = 150
"""A check that computes longer [s] has found a mutant that hangs; it takes a third of that at most without one."""
SLOWEST = 900.0
"""The same in wall-clock time [s], on a machine with others on it."""
ENDLESS = "no end"
READY = ("numpy", "pytest", "yaml", "pydantic", "rich.console", "rich.table", "fmpy.model_description", "mcap.writer")
"""Imported before the first fork: nothing of the project."""
PROJECT = ("modelkit", "vehicle_fmu", "controller_fmu", "fmus", "orchestrator", "apa_cosim", "tests")


class Verdict(NamedTuple):
    """What the checks made of a mutant."""

    mutant: Mutant
    found: dict[str, str]
    """Check -> who found it; "" for nobody. Checks after the first that finds it are not asked, unless all are."""
    seconds: float

    @property
    def killed(self) -> bool:
        """Whether anybody found it."""
        return any(self.found.values())


@contextmanager
def checkout() -> Iterator[Path]:
    """Yield a copy of the files of this checkout, built FMUs in it, in a folder that is gone afterwards."""
    with tempfile.TemporaryDirectory(prefix="mutants-") as name:
        copy = Path(name) / "checkout"
        skip = shutil.ignore_patterns(
            ".git", ".venv", "runs", "site", "build", "dist", "__pycache__", "*.lock", ".*_cache"
        )
        shutil.copytree(ROOT, copy, ignore=skip)
        yield copy


def run(mutants: Iterable[Mutant], checks: Iterable[str], copy: Path, every: bool = False) -> Iterator[Verdict]:
    """Yield a verdict for each mutant; with ``every`` all checks are asked, else up to the first that finds it."""
    names = list(checks)
    for mutant in mutants:
        started = time.monotonic()
        file = copy / mutant.file
        text = file.read_text(encoding="utf-8")
        _write(file, mutant.put_into(text))
        try:
            found: dict[str, str] = {}
            for name in names:
                found[name] = ask(name, mutant.system, copy)
                if found[name] and not every:
                    break
        finally:
            _write(file, text)
        yield Verdict(mutant, found, time.monotonic() - started)


def ask(check: str, system: str, copy: Path) -> str:
    """Return what a check says of the checkout as it is, in a process of its own."""
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    child = context.Process(target=_checked, args=(check, system, str(copy), sender))
    child.start()
    sender.close()
    said = ENDLESS
    try:
        if receiver.poll(SLOWEST):
            said = receiver.recv()
    except EOFError:
        said = "died"
    finally:
        if child.is_alive():
            _end(child)
        child.join()
    return said


def _checked(check: str, system: str, copy: str, sender: object) -> None:
    os.setsid()
    resource.setrlimit(resource.RLIMIT_CPU, (MOST_CPU, MOST_CPU + 1))
    os.chdir(copy)
    os.environ["APA_DIST"] = str(Path(copy).parent / "dist")
    os.environ["PYTHONPATH"] = copy
    sys.path[:] = [copy, *(item for item in sys.path if item not in ("", str(ROOT)))]
    for name in [item for item in sys.modules if item.split(".")[0] in PROJECT]:
        del sys.modules[name]
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    os.dup2(null, 2)
    try:
        said = CHECKS[check](system)
    except BaseException as error:
        said = f"{type(error).__name__}: {traceback.format_exc().strip().splitlines()[-1]}"[:200]
    sender.send(said)  # type: ignore[attr-defined]
    os._exit(0)


def _end(child: multiprocessing.process.BaseProcess) -> None:
    """End a check that hangs, and what it has started."""
    assert child.pid is not None
    child.join(0.5)
    if child.is_alive():
        os.killpg(child.pid, signal.SIGKILL)


def prepare() -> None:
    """Import what every check needs and no mistake can be in."""
    for name in READY:
        importlib.import_module(name)


def _write(file: Path, text: str) -> None:
    """Write a source file such that no compiled one of an earlier text is taken for it."""
    file.write_text(text, encoding="utf-8")
    for compiled in (file.parent / "__pycache__").glob(f"{file.stem}.*.pyc"):
        compiled.unlink()


def commit() -> str:
    """Return the commit that was looked at, for tables."""
    done = subprocess.run(
        ["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    return done.stdout.strip()
