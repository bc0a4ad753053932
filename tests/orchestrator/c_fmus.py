"""FMUs made from one C file and one modelDescription.xml, as another supplier would."""

import hashlib
import zipfile
from functools import cache
from pathlib import Path

from pythonfmu.builder import FmuBuilder

from fmus.cache_paths import DIST
from fmus.files import folder_for_a_while
from fmus.locks import cache_file
from fmus.native.compilers import LINUX_ALONE, find_compiler
from fmus.native.platforms import PLATFORMS, host, host_target

THEIR = Path(__file__).parent / "their"


@cache
def library(source: Path) -> bytes:
    """Return the shared library made of a C file, for this machine; compiled once for all workers."""
    text, compiler = source.read_text(encoding="utf-8"), find_compiler()
    alone = LINUX_ALONE if compiler.is_zig and "linux" in host_target().triple else ()

    def compiled() -> bytes:
        with folder_for_a_while("c") as here:
            (here / source.name).write_text(text, encoding="utf-8")
            compiler.run(["-shared", "-fPIC", "-O1", "-o", "made.bin", source.name, *alone], here)
            return (here / "made.bin").read_bytes()

    key = hashlib.sha256(f"{compiler.words} {text}".encode()).hexdigest()[:16]
    return cache_file(DIST / "theirs", source.stem, key, ".bin", compiled, most=3).read_bytes()


def c_fmu(path: Path, source: Path, description: str, identifier: str, platform: str = "") -> Path:
    """Write an FMU of a C file and its modelDescription.xml."""
    here = PLATFORMS[host()]
    folder = platform or (here.folders3[0] if 'fmiVersion="3' in description else host())
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", description)
        archive.writestr(f"binaries/{folder}/{identifier}{here.suffix}", library(source))
    return path


def two_arcs(folder: Path) -> Path:
    """Return a controller in C with names and units of its own."""
    text = (THEIR / "controller.xml").read_text(encoding="utf-8")
    return c_fmu(folder / "two_arcs.fmu", THEIR / "controller.c", text, "two_arcs")


def sensor(folder: Path) -> Path:
    """Return a position sensor of FMI 3.0 in C, with arrays."""
    text = (THEIR / "sensor.xml").read_text(encoding="utf-8")
    return c_fmu(folder / "sensor.fmu", THEIR / "sensor.c", text, "sensor")


def plant(folder: Path) -> Path:
    """Return a vehicle made with PythonFMU."""
    return Path(FmuBuilder.build_FMU(THEIR / "plant.py", dest=folder)).rename(folder / "plant.fmu")
