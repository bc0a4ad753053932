"""All FMUs of this project: ``build_all`` writes <folder>/<kind>/<Model>.fmu."""

from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import NamedTuple

import controller_fmu
import vehicle_fmu
from fmus.cache_paths import DIST
from fmus.contents.archive import archive_guid
from fmus.native import fmu as native_fmu
from fmus.native.compilers import can_compile, find_compiler
from fmus.native.libraries import python_front
from fmus.native.platforms import host
from fmus.python import fmu as python_fmu
from modelkit.model import Model

MODELS = (controller_fmu.MODEL, vehicle_fmu.MODEL)
KINDS = {"python": 2, "native": 2, "fmi3": 3}
"""Kind of FMU -> version of FMI: PythonFMU, machine code for FMI 2.0 and for FMI 3.0."""


class Built(NamedTuple):
    """One FMU that is now in its place."""

    kind: str
    name: str
    path: Path
    guid: str
    changed: bool
    """False: the file was already there with the same content."""


def kinds_here() -> list[str]:
    """Return the kinds of FMU that can be built on this machine."""
    return list(KINDS) if can_compile() else ["python"]


def build_all(
    out: Path = DIST,
    kinds: Iterable[str] = ("python",),
    progress: Callable[[Built], None] | None = None,
    platforms: Iterable[str] | None = None,
    cc: str | None = None,
    models: Iterable[Model] = MODELS,
) -> list[Built]:
    """Return what was built, in order; ``progress`` is called after each.

    ``platforms`` says what native FMUs are for, by the names in ``fmus.native.platforms``; default: this machine.
    ``cc`` is a C compiler of this machine, see :func:`fmus.native.compilers.find_compiler`. Raises ``ValueError`` for
    an unknown kind, ``RuntimeError`` if there is no C compiler or it fails, ``TypeError`` for a model it cannot be.
    """
    done = []
    for kind in kinds:
        make = _maker(kind, platforms, cc)
        for model in models:
            before = archive_guid(Path(out) / kind / f"{model.name}.fmu")
            path = make(model, Path(out) / kind)
            guid = archive_guid(path) or ""
            done.append(Built(kind, model.name, path, guid, guid != before))
            if progress is not None:
                progress(done[-1])
    return done


def _maker(kind: str, platforms: Iterable[str] | None, cc: str | None) -> Callable[[Model, Path], Path]:
    if kind not in KINDS:
        raise ValueError(f"kind {kind!r}: expected one of {', '.join(KINDS)}")
    if kind == "python":
        return partial(python_fmu.build, front=python_front(cc))
    names = [host()] if platforms is None else list(platforms)
    return partial(native_fmu.build, platforms=names, compiler=find_compiler(cc), fmi=KINDS[kind])
