"""A gallery of FMUs that crash, hang, leave, refuse or are no FMUs, each with the verdict it gets."""

import stat
import zipfile
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

from tests.orchestrator.c_fmus import THEIR, c_fmu

DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Bad" guid="{guid}">
  <CoSimulation modelIdentifier="bad"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="1" causality="output"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="2"/></Outputs></ModelStructure>
</fmiModelDescription>
"""
BOMB = """<?xml version="1.0"?>
<!DOCTYPE a [<!ENTITY a "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa">{entities}]>
<fmiModelDescription fmiVersion="2.0" modelName="&z;" guid="1"/>
"""
LATE = "took more than 3 s"
BEHAVES = {
    "load-crash": "bad crashed while loading (SIGSEGV)",
    "load-hang": f"bad {LATE} while loading, so it was ended",
    "another guid": "bad cannot be instantiated",
    "initialize-crash": "bad crashed in initialization (SIGSEGV)",
    "initialize-hang": f"bad {LATE} in initialization, so it was ended",
    "initialize-error": "bad refuses to initialize: the tank is empty",
    "step-crash": "bad crashed in the step at 0.05 s (SIGSEGV)",
    "step-overflow": "bad crashed in the step at 0.05 s (SIGSEGV)",
    "step-abort": "bad crashed in the step at 0.05 s (SIGABRT); it printed: terminate called: no reason",
    "step-exit": "bad ended its process in the step at 0.05 s (exit code 0)",
    "step-hang": f"bad {LATE} in the step at 0.05 s, so it was ended",
    "step-close": "bad ended its process in the step at 0.05 s",
    "step-discard": "bad failed at 0.05 s: fmiDiscard",
    "step-negative": "bad failed at 0.05 s: no message",
    "step-error": "bad failed at 0.05 s: the tank is empty",
    "step-fatal": "bad failed at 0.05 s: fmiFatal",
    "step-nan": "bad gives NaN for y at 0.06 s",
    "get-error": "bad gives no outputs: the tank is empty",
    "set-crash": "bad crashed taking inputs at 0 s (SIGSEGV)",
    "step-pipe": "bad wrote into the pipe of its process in the step at 0.05 s, so nothing that it gave can be trusted",
    "step-signal": "bad crashed in the step at 0.05 s (signal 40)",
    "step-escape": "bad failed at 0.05 s: \\x1b[2J\\x1b]0;yours\\x07\\x9b31m",
    "step-long": "xxx... (4194303 letters)",
    "step-child": f"bad {LATE} in the step at 0.05 s, so it was ended",
}
"""What its GUID makes it do -> the verdict."""
HARMLESS = ("step-print", "step-low", "step-flood", "terminate-crash", "terminate-hang", "free-exit")
"""What does no run any harm."""


def gallery(folder: Path) -> dict[Path, str]:
    """Return FMU -> what is said of it."""
    found = {behaving(folder, name): text for name, text in BEHAVES.items()}
    for name, (make, text) in FILES.items():
        path = folder / f"{name}.fmu"
        make(path)
        found[path] = text
    return found


def behaving(folder: Path, guid: str) -> Path:
    """Return an FMU that does what ``guid`` says."""
    path = folder / f"{guid.replace(' ', '-')}.fmu"
    return c_fmu(path, THEIR / "bad.c", DESCRIPTION.format(guid=guid), "bad")


def _with(change: Callable[[zipfile.ZipFile], None]) -> Callable[[Path], None]:
    def make(path: Path) -> None:
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("modelDescription.xml", DESCRIPTION.format(guid="good"))
            change(archive)

    return make


def _elsewhere(archive: zipfile.ZipFile) -> None:
    archive.writestr("binaries/other64/bad.so", "")


def _text(archive: zipfile.ZipFile) -> None:
    for folder in ("linux64/bad.so", "win64/bad.dll", "darwin64/bad.dylib", "aarch64-linux/bad.so"):
        archive.writestr(f"binaries/{folder}", "this is no library")


def _outside(archive: zipfile.ZipFile) -> None:
    archive.writestr("resources/../../../evil.txt", "out")


def _link(archive: zipfile.ZipFile) -> None:
    entry = zipfile.ZipInfo("resources/link")
    entry.external_attr = (stat.S_IFLNK | 0o777) << 16
    archive.writestr(entry, "/etc")


def _bomb(archive: zipfile.ZipFile) -> None:
    """Say of a small file that it unpacks to 5 GB."""
    archive.writestr("resources/zeros", b"\0" * 1000)
    archive.filelist[-1].file_size = 5 << 30


def _sparse(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(2 << 30)


def _entities(path: Path) -> None:
    """A modelDescription.xml of 2 kB whose model has a name of 60 GB."""
    names = "abcdefghijz"
    entities = "".join(f'<!ENTITY {after} "{f"&{before};" * 10}">' for before, after in pairwise(names))
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", BOMB.format(entities=entities))


def _described(old: str, new: str) -> Callable[[Path], None]:
    """Return what writes an FMU whose description has ``new`` in the place of ``old``."""

    def make(path: Path) -> None:
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("modelDescription.xml", DESCRIPTION.format(guid="good").replace(old, new))

    return make


FILES: dict[str, tuple[Callable[[Path], None], str]] = {
    "elsewhere": (_with(_elsewhere), "it has other64"),
    "no-library": (_with(_text), "bad cannot be loaded here"),
    "outside": (_with(_outside), "'resources/../../../evil.txt' would be written outside its folder"),
    "link": (_with(_link), "'resources/link' would be written outside its folder"),
    "bomb": (_with(_bomb), "is too large: unpacked 5.4 GB"),
    "sparse": (_sparse, "is too large: 2.1 GB, at most 1.1 GB"),
    "entities": (_entities, "is not an FMU"),
    "dangling": (_described('index="2"', 'index="9"'), "its ModelStructure has an index, or a reference, of no var"),
    "model-exchange": (_described("CoSimulation", "ModelExchange"), "is an FMU for Model Exchange only"),
}
