"""Which .fmu files a run uses, built when they are missing or older than their sources."""

import hashlib
import os
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from fmus.files import write_whole
from fmus.locks import one_at_a_time
from fmus.native.compilers import can_compile as can_compile
from modelkit.model import Model
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.text.console import working
from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.kinds import KINDS as KINDS
from orchestrator.simulation.cosim.kinds import default_kind as default_kind

if TYPE_CHECKING:
    from fmus.build import Built

ROOT = Path(__file__).parents[3]
SOURCES = ("modelkit", "vehicle_fmu", "controller_fmu", "fmus")
STAMP = "sources.sha256"
TAKES = {"python": "", "native": " (some seconds, once for each change of the models)"}


def fmu_files(kind: str, say: Callable[[str], None] = lambda text: None) -> dict[str, Path]:
    """Return instance name -> up-to-date FMU of ``kind``."""
    from fmus.cache_paths import DIST

    files = {name: DIST / kind / f"{model.name}.fmu" for name, model in MODELS.items()}
    before = _read_stamp(DIST / kind / STAMP)
    if before != stamp_of(files.values()):
        if before.startswith(sources_hash()):
            _remove_damaged(before, files.values())
        say(f"building {kind} FMUs{TAKES[kind]}")
        build(kind)
    return files


_BESIDE: dict[tuple[Path, str], tuple[Model, Path, int]] = {}


def fmu_beside(path: Path, model: Model) -> Path:
    """Return the up-to-date FMU of ``model`` beside another of the same kind, built if it is not there.

    Sources do not change within a process: there what was built once is taken while its file is the same. Another
    process takes it while its stamp is that of the sources and of the file.
    """
    known, file, at = _BESIDE.get((path.parent, model.name), (None, path, 0))
    if known is model and file.is_file() and file.stat().st_mtime_ns == at:
        return file
    file, stamp = (path.with_name(f"{model.name}{suffix}") for suffix in (".fmu", f".{STAMP}"))
    with one_at_a_time(path.parent.parent / "build"):
        before = _read_stamp(stamp)
        if before != stamp_of([file]):
            if before.startswith(sources_hash()):
                _remove_damaged(before, [file])
            build_into(path.parent.parent, path.parent.name, models=[model])
            with suppress(OSError):
                write_whole(stamp, stamp_of([file]))
    _BESIDE[path.parent, model.name] = (model, file, file.stat().st_mtime_ns)
    return file


def build(kind: str, cc: str | None = None) -> list["Built"]:
    """Build the FMUs of ``kind`` where runs look for them."""
    from fmus.cache_paths import DIST
    from fmus.native.library_cache import master_library

    with one_at_a_time(DIST / "build"):
        if kind == "native":
            with suppress(RuntimeError):
                master_library()
        before = sources_hash()
        built = build_into(DIST, kind, cc=cc)
        write_whole(
            DIST / kind / STAMP, stamp_of([DIST / kind / f"{model.name}.fmu" for model in MODELS.values()], before)
        )
    return built


def build_into(
    folder: Path, kind: str, platforms: Iterable[str] = (), cc: str | None = None, models: Iterable[Model] | None = None
) -> list["Built"]:
    """Build the FMUs of ``kind`` into ``folder``/``kind``; native ones for ``platforms``, by default this machine's.

    ``models`` are vehicle and controller by default.
    ``cc`` is a C compiler of this machine to be used. Raises ``BadInput`` if that cannot be done here.
    """
    from fmus.build import MODELS as PAIR
    from fmus.build import build_all

    wanted = select_platforms(platforms)
    with working(f"building {kind} FMUs"):
        try:
            return build_all(folder, (kind,), None, wanted, cc, PAIR if models is None else models)
        except (RuntimeError, TypeError) as error:
            raise BadInput(str(error)) from error


def select_platforms(asked: Iterable[str]) -> list[str] | None:
    """Return the platforms that ``--platform`` asks for, None for this machine's."""
    from fmus.native.platforms import PLATFORMS

    names = [name for item in asked for name in item.split(",")]
    wanted = sorted(PLATFORMS) if "all" in names else names
    unknown = [name for name in wanted if name not in PLATFORMS]
    if unknown:
        raise BadInput(f"{', '.join(unknown)}: expected all or {', '.join(PLATFORMS)}", key="--platform")
    return wanted or None


@cache
def sources_hash() -> str:
    """Return a hash over all files that an FMU is made from, as they were when this process first asked."""
    digest = hashlib.sha256()
    for room in SOURCES:
        found: list[Path] = []
        for folder, folders, names in os.walk(ROOT / room):
            folders[:] = {*folders} - {"dist", "__pycache__"}
            found += [Path(folder, name) for name in names]
        for path in sorted(found):
            digest.update(str(path.relative_to(ROOT)).encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()


def stamp_of(files: Iterable[Path], sources: str | None = None) -> str:
    """Return the hash of the sources and that of each FMU made of them; empty for one that is missing."""
    hashes = [hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else "" for path in files]
    return " ".join([sources or sources_hash(), *hashes])


def _remove_damaged(stamp: str, files: Iterable[Path]) -> None:
    """Remove the FMUs that are not those that were built."""
    for path in files:
        if path.is_file() and hashlib.sha256(path.read_bytes()).hexdigest() not in stamp.split():
            path.unlink()


def _read_stamp(stamp: Path) -> str:
    return stamp.read_text(encoding="ascii", errors="replace") if stamp.is_file() else ""
