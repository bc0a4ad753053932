"""Writes what depends on the models' variables and C: the tables of ports and of sizes. ``python docs/ports.py``."""

import re
import tempfile
import zipfile
from pathlib import Path

from marked import put

import controller_fmu
import vehicle_fmu
from fmus.contents.arrays import visible_arrays
from fmus.contents.variables import FmiVariable, visible_variables
from fmus.native.fmu import PAGE, build
from modelkit.model import Model

LARGE: tuple[Model, ...] = (vehicle_fmu.MODEL, controller_fmu.MODEL, controller_fmu.APA)
MODELS = (*LARGE, *controller_fmu.SYSTEM_MODELS.values())
PLATFORM = "linux64"
FRAME = re.compile(r"largest stack frame .* has (\d+) bytes")
"""In the page of an FMU."""


def ports() -> list[str]:
    """Return the table of ports and parameters as an importer sees them."""
    lines = ["| FMU | inputs | outputs | parameters, of which tunable |", "|---|---|---|---|"]
    for model in MODELS:
        versions = [visible_variables(model), [array.first for array in visible_arrays(model)]]
        cells = [
            "{} ({})".format(*(sum(item.causality == causality for item in known) for known in versions))
            for causality in ("input", "output", "parameter")
        ]
        lines.append(f"| `{model.name}` | {' | '.join(cells)}, {_tunable(versions[0])} ({_tunable(versions[1])}) |")
    return lines


def _tunable(known: list[FmiVariable]) -> int:
    return sum(item.variability == "tunable" for item in known)


def sizes(folder: Path) -> list[str]:
    """Return the table of sizes of native FMUs of FMI 2.0 for one platform, built into ``folder``."""
    lines = ["| | library [kB] | FMU [kB] | largest stack frame [bytes] |", "|---|---:|---:|---:|"]
    for model in LARGE:
        library, fmu, frame = sizes_of(build(model, folder, [PLATFORM]), model)
        lines.append(f"| `{model.name}` | {library / 1e3:.0f} | {fmu / 1e3:.0f} | {frame} |")
    return lines


def sizes_of(path: Path, model: Model) -> tuple[int, int, int]:
    """Return the bytes of the library, of the FMU and of the largest stack frame, which its page states."""
    with zipfile.ZipFile(path) as archive:
        library = archive.getinfo(f"binaries/{PLATFORM}/{model.name}.so").file_size
        found = FRAME.search(archive.read(PAGE).decode())
    return library, path.stat().st_size, int(found[1]) if found else 0


if __name__ == "__main__":
    here = Path(__file__).parent
    put(here / "use-in-your-tool.md", "ports", ports())
    with tempfile.TemporaryDirectory() as scratch:
        put(here / "targets.md", "sizes", sizes(Path(scratch)))
