"""FMUs for the tests, built once for all workers and kept between runs as long as no source of this project changes."""

import shutil
from functools import cache
from pathlib import Path

from fmus.cache_paths import DIST
from fmus.locks import one_at_a_time
from fmus.native import fmu as native_fmu
from fmus.native.platforms import host
from modelkit.model import Model
from orchestrator.simulation.cosim.fmu_files import sources_hash

FOLDER = DIST / "tests"
KEPT_FINGERPRINTS = 3
"""Of so many states of the sources the FMUs are kept, for those who go back and forth between two commits."""
KINDS = {2: "native", 3: "fmi3"}
"""Version of FMI -> kind, by which a folder of FMUs is known where others are built beside them."""


@cache
def folder_of_fmus() -> Path:
    """Return the folder for the sources as they are, those of the build among them: no GUID depends on these."""
    folder = FOLDER / sources_hash()[:16]
    with one_at_a_time(FOLDER / "fingerprints"):
        if not folder.exists():
            folder.mkdir(parents=True)
            by_age = sorted((path for path in FOLDER.iterdir() if path.is_dir()), key=lambda path: path.stat().st_mtime)
            for path in by_age[:-KEPT_FINGERPRINTS]:
                shutil.rmtree(path, ignore_errors=True)
    return folder


def native_fmu_of(model: Model, fmi: int = 2) -> Path:
    """Return the path of a model's native FMU for this machine; tests copy it before they change it."""
    folder = folder_of_fmus() / KINDS[fmi]
    with one_at_a_time(folder / model.name):
        return native_fmu.build(model, folder, [host()], fmi=fmi)
