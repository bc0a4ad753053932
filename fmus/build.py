"""All FMUs of this project: ``build_all`` writes fmus/dist/<kind>/<Model>.fmu."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple

import controller_fmu
import vehicle_fmu
from fmus import python_fmu
from fmus.archive import archive_guid

DIST = Path(__file__).parent / "dist"
MODELS = (controller_fmu.MODEL, vehicle_fmu.MODEL)
BUILDERS = {"python": python_fmu.build}


class Built(NamedTuple):
    """One FMU that is now in its place."""

    kind: str
    name: str
    path: Path
    guid: str
    changed: bool
    """False: the file was already there with the same content."""


def build_all(
    out: Path = DIST, kinds: Iterable[str] = ("python",), progress: Callable[[Built], None] | None = None
) -> list[Built]:
    """Return what was built, in order; ``progress`` is called after each. Raises ``ValueError`` for an unknown kind."""
    done = []
    for kind in kinds:
        if kind not in BUILDERS:
            raise ValueError(f"kind {kind!r}: expected one of {', '.join(BUILDERS)}")
        for model in MODELS:
            before = archive_guid(Path(out) / kind / f"{model.name}.fmu")
            path = BUILDERS[kind](model, Path(out) / kind)
            guid = archive_guid(path) or ""
            done.append(Built(kind, model.name, path, guid, guid != before))
            if progress is not None:
                progress(done[-1])
    return done
