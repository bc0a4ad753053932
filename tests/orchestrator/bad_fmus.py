"""A gallery of FMUs that crash, hang, leave, refuse or are no FMUs, each with the verdict it gets."""

import re
import stat
import warnings
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
DESCRIPTION3 = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="Bad" instantiationToken="{guid}">
  <CoSimulation modelIdentifier="bad"/>
  <ModelVariables>
    <Float64 name="u" valueReference="0" causality="input" start="0"/>
    <Float64 name="y" valueReference="1" causality="output"/>
  </ModelVariables>
  <ModelStructure><Output valueReference="1"/></ModelStructure>
</fmiModelDescription>
"""
BOMB = """<?xml version="1.0"?>
<!DOCTYPE a [<!ENTITY a "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa">{entities}]>
<fmiModelDescription fmiVersion="2.0" modelName="&z;" guid="1"/>
"""
LATE = "took more than 3 s"
PLAIN = DESCRIPTION.format(guid="good").partition("?>")[2]
"""A description without its first line."""
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
    "step-bytes": "{when} {0} %s%n%d pass  another",
    "step-pipefile": "bad crashed in the step at 0.05 s (SIGABRT)",
    "step-child": f"bad {LATE} in the step at 0.05 s, so it was ended",
}
"""What its GUID makes it do -> the verdict."""
HARMLESS = (
    *("step-print", "step-low", "step-flood", "step-huge", "step-thread", "step-threads", "get-truncate"),
    *("terminate-crash", "terminate-hang", "free-exit"),
)
"""What does no run any harm."""
ALL_PLACES = ("load", "setup", "initialize", "start", "set", "get", "terminate", "free")
AT_ALL_PLACES = (
    *("crash", "hang", "deaf", "error", "negative", "pending", "threads", "thread", "twin", "escape", "null", "pipe"),
    *("truncate", "unlink", "close"),
)
"""What is tried at each of these places; all else at the step."""


def gallery(folder: Path) -> dict[Path, str]:
    """Return FMU -> what is said of it."""
    found = {behaving(folder, name): text for name, text in BEHAVES.items()}
    for name, (make, text) in FILES.items():
        path = folder / f"{name}.fmu"
        make(path)
        found[path] = text
    return found


def behaving(folder: Path, guid: str, version: int = 2) -> Path:
    """Return an FMU that does what ``guid`` says."""
    path = folder / f"{guid.replace(' ', '-')}{'' if version == 2 else '-3'}.fmu"
    return c_fmu(path, THEIR / "bad.c", (DESCRIPTION if version == 2 else DESCRIPTION3).format(guid=guid), "bad")


def all_behaviours() -> list[tuple[str, int]]:
    """Return what each kind does, and the version of FMI."""
    known = set(re.findall(r'strcmp\(rest, "([a-z ]+)"\)', (THEIR / "bad.c").read_text(encoding="utf-8")))
    kinds = sorted(known - {"parent"})  # which stops this process, where no sandbox keeps it from that
    at_steps = [(f"step-{kind}", version) for kind in kinds for version in (2, 3)]
    elsewhere = [(f"{place}-{kind}", 2) for place in ALL_PLACES for kind in AT_ALL_PLACES]
    return [("another guid", 2), ("another guid", 3), *at_steps, *elsewhere]


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


def _same_name(archive: zipfile.ZipFile) -> None:
    archive.writestr("resources", "a file")
    archive.writestr("resources/inside", "in a folder of its name")


def _twice(archive: zipfile.ZipFile) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        archive.writestr("modelDescription.xml", DESCRIPTION.format(guid="the other"))


def _special(kind: int) -> Callable[[zipfile.ZipFile], None]:
    def add(archive: zipfile.ZipFile) -> None:
        entry = zipfile.ZipInfo("resources/special")
        entry.external_attr = (kind | 0o666) << 16
        archive.writestr(entry, "")

    return add


def _named(name: str, count: int = 1) -> Callable[[zipfile.ZipFile], None]:
    def add(archive: zipfile.ZipFile) -> None:
        for number in range(count):
            archive.writestr(name.format(number=number), "x")

    return add


def _odd(add: Callable[[zipfile.ZipFile], None]) -> Callable[[Path], None]:
    """Return what writes an FMU with a file in the place of its library: it is unpacked, and not loaded."""

    def change(archive: zipfile.ZipFile) -> None:
        _text(archive)
        add(archive)

    return _with(change)


def _patched(*changes: tuple[bytes, int, bytes]) -> Callable[[Path], None]:
    """Return what writes an FMU and then other bytes so far behind each place that begins with these."""

    def make(path: Path) -> None:
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("modelDescription.xml", DESCRIPTION.format(guid="good"))
            _text(archive)
        data = bytearray(path.read_bytes())
        for mark, offset, new in changes:
            at = data.find(mark)
            while at >= 0:
                data[at + offset : at + offset + len(new)] = new
                at = data.find(mark, at + 4)
        path.write_bytes(data)

    return make


def _written(text: str, encoding: str = "utf-8") -> Callable[[Path], None]:
    """Return what writes an FMU whose description is this text."""

    def make(path: Path) -> None:
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("modelDescription.xml", text.encode(encoding))

    return make


def _content(data: bytes) -> Callable[[Path], None]:
    def make(path: Path) -> None:
        path.write_bytes(data)

    return make


LOCAL, CENTRAL = b"PK\3\4", b"PK\1\2"
"""Begin the header of a file in an archive, and its line in the list at the end."""
ODD_FILES: dict[str, Callable[[Path], None]] = {
    "backslash": _odd(_named("resources\\..\\..\\..\\evil.txt")),
    "absolute": _odd(_named("/tmp/apa-evil")),
    "drive": _odd(_named("C:/evil.txt")),
    "dot": _odd(_named("./resources/./x")),
    "zero-in-name": _odd(_named("resources/a\0b")),
    "control": _odd(_named("resources/\33[2J\x9b31m")),
    "device": _odd(_special(stat.S_IFCHR)),
    "fifo": _odd(_special(stat.S_IFIFO)),
    "socket": _odd(_special(stat.S_IFSOCK)),
    "described-twice": _odd(_twice),
    "same-name": _odd(_same_name),
    "long-name": _odd(_named(f"resources/{'n' * 300}")),
    "long-path": _odd(_named(f"resources/{'n' * 200}" + f"/{'n' * 200}" * 30)),
    "deep": _odd(_named("resources/" + "d/" * 3000 + "x")),
    "many-files": _odd(_named("resources/{number}", 51_000)),
    "encrypted": _patched((LOCAL, 6, b"\1\0"), (CENTRAL, 8, b"\1\0")),
    "unknown-method": _patched((LOCAL, 8, b"\x63\0"), (CENTRAL, 10, b"\x63\0")),
    "wrong-crc": _patched((LOCAL, 14, b"\1\2\3\4"), (CENTRAL, 16, b"\1\2\3\4")),
    "negative-offset": _patched((CENTRAL, 42, b"\xff\xff\xff\x7f")),
    "large-header": _patched((CENTRAL, 28, b"\xff\xff")),
    "empty": _content(b""),
    "text": _content(b"this is no archive"),
    "external-entity": _written('<!DOCTYPE a [<!ENTITY b SYSTEM "file:///etc/passwd">]>' + PLAIN.replace("Bad", "&b;")),
    "external-dtd": _written('<!DOCTYPE a SYSTEM "file:///dev/zero">' + PLAIN),
    "parameter-entity": _written('<!DOCTYPE a [<!ENTITY % b SYSTEM "file:///dev/zero"> %b;]>' + PLAIN),
    "quadratic": _written(f'<!DOCTYPE a [<!ENTITY b "{"b" * 50_000}">]>' + PLAIN.replace("Bad", "&b;" * 50_000)),
    "levels": _written("<a>" * 100_000 + "</a>" * 100_000),
    "attributes": _written(PLAIN.replace("modelName", " ".join(f'a{k}="1"' for k in range(100_000)) + " modelName")),
    "utf-16": _written('<?xml version="1.0" encoding="UTF-16"?>' + PLAIN, "utf-16"),
    "utf-7": _written('<?xml version="1.0" encoding="UTF-7"?>' + PLAIN),
    "another-root": _written("<html/>"),
    "no-xml": _written("modelName: Bad"),
    "nothing": _written(""),
}
"""Archives and descriptions that are odd or no FMU at all; none is written outside its folder, none opens a file."""
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
