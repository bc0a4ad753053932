"""All FMUs of this project: ``build_all`` writes fmus/dist/<kind>/<Model>.fmu."""

from collections.abc import Callable, Iterable
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import controller_fmu
import vehicle_fmu
from fmus.contents.archive import archive_guid
from fmus.places import DIST
from fmus.python import fmu as python_fmu
from modelkit.model import Model

MODELS = (controller_fmu.MODEL, vehicle_fmu.MODEL)
NATIVE_NEEDS = ("numba", "llvmlite", "ziglang")


class Built(NamedTuple):
    """One FMU that is now in its place."""

    kind: str
    name: str
    path: Path
    guid: str
    changed: bool
    """False: the file was already there with the same content."""


def build_native(model: Model, out_dir: Path, platforms: Iterable[str] | None = None) -> Path:
    """Return the path of the native FMU for ``platforms`` (default: this machine's); makes the compiled master too."""
    from fmus.native.fmu import build
    from fmus.native.master_library import master_library
    from fmus.native.platforms import host

    master_library()
    return build(model, out_dir, [host()] if platforms is None else platforms)


BUILDERS: dict[str, Callable[..., Path]] = {"python": python_fmu.build}
if all(find_spec(package) for package in NATIVE_NEEDS):
    BUILDERS["native"] = build_native


def build_all(
    out: Path = DIST,
    kinds: Iterable[str] = ("python",),
    progress: Callable[[Built], None] | None = None,
    platforms: Iterable[str] | None = None,
) -> list[Built]:
    """Return what was built, in order; ``progress`` is called after each. Raises ``ValueError`` for an unknown kind.

    ``platforms`` says what native FMUs are for, by the names in ``fmus.native.platforms``; default: this machine.
    """
    done = []
    for kind in kinds:
        if kind not in BUILDERS:
            raise ValueError(f"kind {kind!r}: expected one of {', '.join(BUILDERS)}; {missing()}")
        more = {"platforms": platforms} if kind == "native" else {}
        for model in MODELS:
            before = archive_guid(Path(out) / kind / f"{model.name}.fmu")
            path = BUILDERS[kind](model, Path(out) / kind, **more)
            guid = archive_guid(path) or ""
            done.append(Built(kind, model.name, path, guid, guid != before))
            if progress is not None:
                progress(done[-1])
    return done


def missing() -> str:
    """Return what to install for native FMUs, or that nothing is missing."""
    absent = [package for package in NATIVE_NEEDS if not find_spec(package)]
    return f"native FMUs need {', '.join(absent)}: pip install 'apa-cosim[native]'" if absent else "nothing is missing"
