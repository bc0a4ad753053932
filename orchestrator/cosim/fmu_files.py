"""Which .fmu files a run uses, built when they are missing or older than their sources."""

import hashlib
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

from orchestrator.cosim.models import MODELS
from orchestrator.session.terminal import working

ROOT = Path(__file__).parent.parent.parent
SOURCES = ("modelkit", "vehicle_fmu", "controller_fmu", "fmus")
STAMP = "sources.sha256"
KINDS = ("python", "native")
TAKES = {"python": "", "native": " (about a minute, once for each change of the models)"}
COMPILERS = ("llvmlite", "numba", "ziglang")
"""What the extra ``native`` installs."""


def can_compile() -> bool:
    """Return whether models can be compiled here."""
    return all(find_spec(name) is not None for name in COMPILERS)


def default_kind() -> str:
    """Return ``native``, the faster kind, where it can be built."""
    return "native" if can_compile() else "python"


def fmu_files(kind: str, say: Callable[[str], None] = lambda text: None) -> dict[str, Path]:
    """Return slave name -> up-to-date FMU of ``kind``."""
    from fmus.places import DIST

    files = {name: DIST / kind / f"{model.name}.fmu" for name, model in MODELS.items()}
    if not all(path.is_file() for path in files.values()) or _stamp(DIST / kind) != sources_hash():
        say(f"building {kind} FMUs{TAKES[kind]}")
        build(kind)
    return files


def build(kind: str) -> list[str]:
    """Build the FMUs of ``kind`` and return one line about each."""
    from fmus.build import build_all
    from fmus.places import DIST

    lines = []
    with working(f"building {kind} FMUs"), _alone(DIST):
        before = sources_hash()
        for built in build_all(kinds=(kind,)):
            size = f"{built.path.stat().st_size / 1024:.0f} KiB"
            lines.append(f"{built.path}  {size}  {built.guid}{'' if built.changed else '  unchanged'}")
        (DIST / kind / STAMP).write_text(before, encoding="ascii")
    return lines


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Let one process build at a time, where the system has file locks."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / ".lock").open("w", encoding="ascii") as lock:
        if sys.platform != "win32":
            import fcntl

            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def sources_hash() -> str:
    """Return a hash over all files that an FMU is made from."""
    digest = hashlib.sha256()
    for room in SOURCES:
        for path in sorted((ROOT / room).rglob("*")):
            relative = path.relative_to(ROOT)
            if path.is_file() and "dist" not in relative.parts and "__pycache__" not in relative.parts:
                digest.update(str(relative).encode())
                digest.update(path.read_bytes())
    return digest.hexdigest()


def _stamp(folder: Path) -> str:
    stamp = folder / STAMP
    return stamp.read_text(encoding="ascii") if stamp.is_file() else ""
