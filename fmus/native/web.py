"""Both models, their exchange and whole runs as one WebAssembly module that imports nothing.

The C is that of the native FMUs and the batch; the C library, its mathematics included, is linked in. What the module
offers is in ``c/live.c``.
"""

import hashlib
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path

from fmus.locks import kept_file
from fmus.native.compilers import find_compiler
from fmus.native.kept import C_FILES
from fmus.native.libraries import model_files, model_unit
from fmus.native.platforms import WEB, CompileTarget
from fmus.places import LIBRARIES
from modelkit.connections import connections, part_of
from modelkit.model import Model

MODEL_UNIT = """#define LIBRARY_EXPORT __attribute__((unused)) static
{unit}
const Library *{name}_library(void);
const Library *{name}_library(void) {{ return &library_table; }}
"""
LIVE_UNIT = """/* Connected models for a host outside of this memory. */
#include "library.h"

{declared}
#define LIVE_MODELS {tables}
#define LIVE_COUNT {count}
#define LIVE_LINKS {links}
#include "live.c"
"""


def can_build() -> bool:
    """Return whether the compiler is there that knows WebAssembly."""
    return find_spec("ziglang") is not None


def web_module(models: Mapping[str, Model]) -> Path:
    """Return the path of the module ``.wasm`` of connected models. Raises ``RuntimeError`` without ziglang."""
    return live_library(models, WEB, ".wasm")


def live_library(
    models: Mapping[str, Model], target: CompileTarget, suffix: str, more: Mapping[str, str] | None = None
) -> Path:
    """Return the path of what ``live.c`` becomes for ``target``, with the further C files ``more``."""
    compiler = find_compiler("zig")
    files = {**live_files(models), **(more or {})}
    units = sorted(name for name in files if name.endswith("_unit.c"))
    digest = hashlib.sha256(compiler.recipe(target).encode())
    for file, text in sorted(files.items()):
        digest.update(f"{file} {len(text)} {text}".encode())
    name = f"live{suffix}"
    made = lambda: compiler.linked(files, units, name, target)  # noqa: E731
    return kept_file(LIBRARIES, "live", digest.hexdigest()[:16], suffix, made)


def live_files(models: Mapping[str, Model]) -> dict[str, str]:
    """Return the C files; those called ``..._unit.c`` are compiled."""
    own = ("live.c", "batch.c", "faults.h", "library.h")
    files = {name: (C_FILES / name).read_text(encoding="utf-8") for name in own}
    for model in models.values():
        files |= {
            **model_files(model),
            f"{model.name}_unit.c": MODEL_UNIT.format(name=model.name, unit=model_unit(model)),
        }
    names = [f"{model.name}_library" for model in models.values()]
    wires = connections([part_of(name, model) for name, model in models.items()])
    files["live_unit.c"] = LIVE_UNIT.format(
        declared="\n".join(f"const Library *{name}(void);" for name in names),
        count=len(names),
        tables=", ".join(f"{name}()" for name in names),
        links=", ".join(f"{{{', '.join(map(str, wire))}}}" for wire in wires),
    )
    return files
