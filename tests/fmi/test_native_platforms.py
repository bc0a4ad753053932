"""The same toy for every platform, built here: right kind of file, all FMI functions, nothing of Python, small."""

import struct
import zipfile
from typing import Any

import pytest
import toy_model

from fmus.native.fat_binary import fat_binary
from fmus.native.fmu import build
from fmus.native.platforms import PLATFORMS
from tests.fmi.elf import dynamic

LIMIT = 400_000
FUNCTIONS = ("fmi2GetVersion", "fmi2Instantiate", "fmi2DoStep", "fmi2SetFMUstate", "fmi2GetStringStatus")
PYTHON = (b"Py_Initialize", b"PyObject", b"libpython", b"python3")
X86_64, ARM64 = 0x01000007, 0x0100000C
pytestmark = pytest.mark.release


@pytest.fixture(scope="module")
def binaries(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Platform -> content of its library."""
    path = build(toy_model.MODEL, tmp_path_factory.mktemp("platforms"), PLATFORMS)
    with zipfile.ZipFile(path) as archive:
        names = [name for name in archive.namelist() if name.startswith("binaries/")]
        return {name.split("/")[1]: archive.read(name) for name in names}


def slices(content: Any) -> Any:
    """Return processor -> Mach-O file in a universal binary."""
    magic, count = struct.unpack_from(">II", content)
    assert magic == 0xCAFEBABE
    entries = [struct.unpack_from(">IIIII", content, 8 + 20 * k) for k in range(count)]
    return {processor: content[at : at + size] for processor, _, at, size, _ in entries}


def test_all_platforms_are_there(binaries: Any) -> None:
    assert sorted(binaries) == ["aarch64-linux", "darwin64", "linux64", "win64"]


@pytest.mark.parametrize(("platform", "machine"), [("linux64", 62), ("aarch64-linux", 183)])
def test_linux(binaries: Any, platform: str, machine: int) -> None:
    content = binaries[platform]
    needed, undefined, defined = dynamic(content)
    assert struct.unpack_from("<H", content, 0x12) == (machine,)
    assert set(needed) <= {"libc.so.6", "libm.so.6"}
    assert len(defined) == 34
    assert not [name for name in undefined if "Py" in name]
    assert len(content) < LIMIT


def test_windows(binaries: Any) -> None:
    content = binaries["win64"]
    (header,) = struct.unpack_from("<I", content, 0x3C)
    assert content[:2] == b"MZ"
    assert content[header : header + 6] == b"PE\0\0\x64\x86"
    assert all(name.encode() in content for name in FUNCTIONS)
    assert not any(word in content for word in PYTHON)
    assert len(content) < LIMIT


def test_mac(binaries: Any) -> None:
    found = slices(binaries["darwin64"])
    assert set(found) == {X86_64, ARM64}
    for processor, content in found.items():
        magic, its_processor, _, kind = struct.unpack_from("<IIII", content)
        assert (magic, its_processor, kind) == (0xFEEDFACF, processor, 6)
        assert all(b"_" + name.encode() in content for name in FUNCTIONS)
        assert not any(word in content for word in PYTHON)
        assert len(content) < LIMIT


def test_a_slice_must_be_a_mach_o_file() -> None:
    with pytest.raises(ValueError, match="64-bit Mach-O"):
        fat_binary([b"\x7fELF" + bytes(100)])
