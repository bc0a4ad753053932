"""The platforms a native FMU is built for."""

import os
import sys
from typing import NamedTuple


class CompileTarget(NamedTuple):
    """One processor and operating system."""

    triple: str
    """For the cross-compiler; with the oldest C library that will do."""
    options: tuple[str, ...]
    """For compiling and linking."""


ELF = (
    "-shared",
    "-fPIC",
    "-Wl,-z,now",
    "-Wl,-z,relro",
    "-Wl,-z,noexecstack",
    "-Wl,--build-id=none",
    "-Wl,--gc-sections",
    "-Wl,-s",
    "-lm",
)
LINUX = CompileTarget("x86_64-linux-gnu.2.17", ELF)
LINUX_ARM = CompileTarget("aarch64-linux-gnu.2.17", ELF)
WINDOWS = CompileTarget("x86_64-windows-gnu", ("-shared", "-Wl,-s"))
MAC_INTEL = CompileTarget("x86_64-macos.11.0", ("-shared", "-Wl,-s"))
MAC_ARM = CompileTarget("aarch64-macos.11.0", ("-shared", "-Wl,-s"))
WEB = CompileTarget(
    "wasm32-wasi", ("-mexec-model=reactor", "-Wl,--export-dynamic", "-Wl,--gc-sections", "-Wl,--strip-all")
)
"""WebAssembly with its C library inside."""


class Platform(NamedTuple):
    """A folder in ``binaries/`` of FMI 2.0 and what its library is made of (a Mac's holds both processors)."""

    suffix: str
    targets: tuple[CompileTarget, ...]
    folders3: tuple[str, ...]
    """Names of the folders in FMI 3.0, one for each target."""


PLATFORMS = {
    "linux64": Platform(".so", (LINUX,), ("x86_64-linux",)),
    "win64": Platform(".dll", (WINDOWS,), ("x86_64-windows",)),
    "darwin64": Platform(".dylib", (MAC_INTEL, MAC_ARM), ("x86_64-darwin", "aarch64-darwin")),
    "aarch64-linux": Platform(".so", (LINUX_ARM,), ("aarch64-linux",)),
}


def host() -> str:
    """Return the platform of this machine, as FMI 2.0 names its folder; ``RuntimeError`` if it is none of ours."""
    machine = os.uname().machine if hasattr(os, "uname") else "AMD64"
    names = {"linux": {"x86_64": "linux64", "aarch64": "aarch64-linux"}, "win32": {"AMD64": "win64"}}
    names["darwin"] = {"x86_64": "darwin64", "arm64": "darwin64"}
    try:
        return names[sys.platform][machine]
    except KeyError:
        raise RuntimeError(f"no native FMU for {sys.platform} on {machine}") from None


def is_known() -> bool:
    """Return whether this machine is of a platform of ours."""
    try:
        return bool(host())
    except RuntimeError:
        return False


def host_target() -> CompileTarget:
    """Return the target of this machine's own processor."""
    targets = PLATFORMS[host()].targets
    return targets[-1 if os.name == "posix" and os.uname().machine == "arm64" else 0]
