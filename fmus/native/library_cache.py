"""Shared libraries for this machine and this process that no model is in: the compiled master, the batch.

Kept in ``LIBRARY_FOLDER`` under a hash of their sources, so each is compiled once. Imports no compiler of models.
"""

import hashlib
from collections.abc import Mapping
from pathlib import Path

from fmus.cache_paths import LIBRARY_FOLDER
from fmus.locks import cache_file
from fmus.native.compilers import Compiler, find_compiler
from fmus.native.platforms import PLATFORMS, CompileTarget, host, host_target
from fmus.native.sines import sine_table
from fmus.native.tangents import tangent_table

C_FILES = Path(__file__).parent / "c"


def master_library() -> Path:
    """Return the path of the compiled master. Raises ``RuntimeError`` where it cannot be built."""
    return cache_library("master", "master.c", own_files("master.c", "fmi2.h"))


def batch_library() -> Path:
    """Return the path of the compiled runs. Raises ``RuntimeError`` where it cannot be built."""
    return cache_library("batch", "batch.c", own_files("batch.c", "batch.h", "faults.h", "library.h"))


def lane_batch_library(options: tuple[str, ...]) -> Path:
    """Return the path of the compiled runs in lanes, for this processor. Raises as :func:`batch_library`."""
    files = own_files("lane_batch.c", "batch.h", "faults.h", "library.h") | lane_headers()
    return cache_library("lane_batch", "lane_batch.c", files, options=options)


def lane_headers() -> dict[str, str]:
    """Return the headers of C in lanes."""
    tables = {"lane_sines.h": sine_table(), "lane_tangents.h": tangent_table()}
    return own_files("lane_library.h", "lanes.h", "lane_math.h") | tables


def cache_library(
    name: str,
    unit: str,
    files: Mapping[str, str],
    compiler: Compiler | None = None,
    target: CompileTarget | None = None,
    options: tuple[str, ...] = (),
) -> Path:
    """Return the path of the library made of ``unit`` among ``files``, compiled if there is none; for this machine.

    ``options``: of the compiler, besides the usual ones. Raises ``RuntimeError`` without a C compiler, or with its
    words if it refuses.
    """
    compiler, target, platform = compiler or find_compiler(), target or host_target(), PLATFORMS[host()]
    target = target._replace(options=(*target.options, *options))
    key, file = key_of(compiler, target, files), f"{name}{platform.suffix}"
    return cache_file(LIBRARY_FOLDER, name, key, platform.suffix, lambda: compiler.library(files, unit, file, target))


def key_of(compiler: Compiler, target: CompileTarget, files: Mapping[str, str]) -> str:
    """Return digits that depend on all that a library is made of."""
    return hashlib.sha256("".join((compiler.recipe(target), *fingerprints(files))).encode()).hexdigest()[:16]


def fingerprints(files: Mapping[str, str]) -> list[str]:
    """Return a text for each C file that no other file has."""
    return [f"{file} {len(text)} {text}" for file, text in sorted(files.items())]


def own_files(*names: str) -> dict[str, str]:
    """Return file name -> text of C files of this project."""
    return {name: (C_FILES / name).read_text(encoding="utf-8") for name in names}
