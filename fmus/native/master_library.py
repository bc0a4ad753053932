"""The compiled master as a shared library for this machine, built once per source."""

import hashlib
import os
import tempfile
from pathlib import Path

from fmus.native.platforms import CODE, NATIVE, PLATFORMS, WARNINGS, compile_c, host
from fmus.places import LIBRARIES

FILES = ("master.c", "fmi2.h")


def master_library() -> Path:
    """Return the library's path. Raises ``RuntimeError`` where it cannot be built."""
    platform = PLATFORMS[host()]
    target = platform.targets[-1 if os.name == "posix" and os.uname().machine == "arm64" else 0]
    options = (*WARNINGS, *CODE, *FILES[:1], *target.options)
    digest = hashlib.sha256(" ".join((target.compiler, *options)).encode())
    for name in FILES:
        digest.update((NATIVE / name).read_bytes())
    path = LIBRARIES / f"master-{digest.hexdigest()[:16]}{platform.suffix}"
    if not path.exists():
        _build(path, target.compiler, options)
    return path


def _build(path: Path, target: str, options: tuple[str, ...]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="apa-master-") as directory:
        here = Path(directory)
        for name in FILES:
            (here / name).write_bytes((NATIVE / name).read_bytes())
        compile_c(here, target, path.name, options)
        part = path.with_name(f"{path.name}.{os.getpid()}.part")
        part.write_bytes((here / path.name).read_bytes())
        part.replace(path)
