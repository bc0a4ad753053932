"""The platforms a native FMU is built for, and the one cross-compiler that serves them all."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

NATIVE = Path(__file__).parent / "c"
SOURCES = ("slave.c", "variables.c", "snapshot.c")
HEADERS = ("fmi2.h", "model.h", "slave.h")
WARNINGS = ("-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Wno-overlength-strings")
CODE = ("-O2", "-ffp-contract=off", "-fno-math-errno", "-fvisibility=hidden", "-fno-sanitize=all", "-g0")


class Target(NamedTuple):
    """One processor and operating system."""

    triple: str
    """For the model's code."""
    compiler: str
    """The same for the C compiler and linker; with the oldest C library that will do."""
    options: tuple[str, ...]


ELF = ("-Wl,-z,now", "-Wl,-z,relro", "-Wl,-z,noexecstack", "-Wl,--build-id=none", "-Wl,-s", "-lm")
LINUX = Target("x86_64-unknown-linux-gnu", "x86_64-linux-gnu.2.17", ELF)
LINUX_ARM = Target("aarch64-unknown-linux-gnu", "aarch64-linux-gnu.2.17", ELF)
WINDOWS = Target("x86_64-pc-windows-gnu", "x86_64-windows-gnu", ("-Wl,-s",))
MAC_INTEL = Target("x86_64-apple-macosx11.0.0", "x86_64-macos.11.0", ("-Wl,-s",))
MAC_ARM = Target("arm64-apple-macosx11.0.0", "aarch64-macos.11.0", ("-Wl,-s",))


class Platform(NamedTuple):
    """A folder in ``binaries/`` and what its library is made of (a Mac's holds both processors)."""

    suffix: str
    targets: tuple[Target, ...]


PLATFORMS = {
    "linux64": Platform(".so", (LINUX,)),
    "win64": Platform(".dll", (WINDOWS,)),
    "darwin64": Platform(".dylib", (MAC_INTEL, MAC_ARM)),
    "aarch64-linux": Platform(".so", (LINUX_ARM,)),
}


def link(name: str, target: Target, sources: Mapping[str, str], object_file: bytes) -> bytes:
    """Return a shared library: the FMI side, the texts in ``sources`` and the model's object file.

    The work is done in a fresh directory with fixed file names, so that no path gets into the bytes.
    """
    with tempfile.TemporaryDirectory(prefix="apa-native-") as directory:
        here = Path(directory)
        for file in (*SOURCES, *HEADERS):
            (here / file).write_bytes((NATIVE / file).read_bytes())
        for file, text in sources.items():
            (here / file).write_text(text)
        (here / "model.o").write_bytes(object_file)
        texts = (*SOURCES, *(file for file in sources if file.endswith(".c")))
        compile_c(here, target.compiler, name, (*WARNINGS, *CODE, *texts, "model.o", *target.options))
        return (here / name).read_bytes()


def compile_c(directory: Path, target: str, output: str, arguments: Iterable[str]) -> None:
    """Make a shared library in ``directory`` with the C compiler of ziglang; ``RuntimeError`` with its words."""
    command = [sys.executable, "-m", "ziglang", "cc", "-target", target, "-shared", "-o", output, *arguments]
    done = subprocess.run(command, cwd=directory, env=os.environ, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr.strip()}")


def host() -> str:
    """Return the platform of this machine, as FMI 2.0 names its folder; ``RuntimeError`` if it is none of ours."""
    machine = os.uname().machine if hasattr(os, "uname") else "AMD64"
    names = {"linux": {"x86_64": "linux64", "aarch64": "aarch64-linux"}, "win32": {"AMD64": "win64"}}
    names["darwin"] = {"x86_64": "darwin64", "arm64": "darwin64"}
    try:
        return names[sys.platform][machine]
    except KeyError:
        raise RuntimeError(f"no native FMU for {sys.platform} on {machine}") from None
