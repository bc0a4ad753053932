"""Both models, their exchange and whole runs as one WebAssembly module that imports nothing.

The C is that of the native FMUs and the batch; the C library, its mathematics included, is linked in. What the module
offers is in ``c/live.c``.
"""

from collections.abc import Callable, Iterable, Mapping
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from fmus.cache_paths import CACHE_FOLDER, LIBRARY_FOLDER
from fmus.locks import cache_file
from fmus.native.compilers import find_compiler
from fmus.native.coverage_probes import DECLARED, instrument
from fmus.native.library_cache import C_FILES, fingerprints, key_of, own_files
from fmus.native.platforms import WEB, CompileTarget
from fmus.native.source_fingerprint import ROOT, hash_of, words_of
from modelkit.connections import live_connections
from modelkit.model import Chart, Model

if TYPE_CHECKING:  # the translator takes a tenth of a second to import
    from fmus.compiler.slicing import Slice

CACHED_MODULES = 4
"""Names of modules of older sources that stay in the cache."""
MODEL_UNIT = """{declared}#define LIBRARY_EXPORT __attribute__((unused)) static
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
#define LIVE_CHARTS {charts}
#include "live.c"
"""


def charts_of(models: Iterable[Model]) -> list[Chart]:
    """Return the charts of connected models in the order in which ``live.c`` tells what they decide on."""
    return [chart for model in models for chart in model.all_charts()]


def can_build() -> bool:
    """Return whether the compiler is there that knows WebAssembly."""
    return find_spec("ziglang") is not None


class LazySlices(NamedTuple):
    """Slices of models, found when they are compiled."""

    words: tuple[str, ...]
    """All that they depend on besides the models."""
    solve: "Callable[[], Mapping[str, Slice]]"
    """Returns them by the names of the models."""


def web_module(models: Mapping[str, Model], slices: LazySlices | None = None) -> Path:
    """Return the path of the module ``.wasm`` of connected models, or of ``slices`` of them.

    Raises ``RuntimeError`` without ziglang.
    """
    return live_library(models, WEB, ".wasm", slices=slices)


def live_library(
    models: Mapping[str, Model],
    target: CompileTarget,
    suffix: str,
    more: Mapping[str, str] | None = None,
    slices: LazySlices | None = None,
) -> Path:
    """Return the path of what ``live.c`` becomes for ``target``, with the further C files ``more``."""
    compiler, name = find_compiler("zig"), f"live{suffix}" if slices is None else f"live_slice{suffix}"
    further = more or {}

    @cache
    def files() -> dict[str, str]:
        return {**live_files(models, None if slices is None else slices.solve()), **further}

    def make() -> bytes:
        units = sorted(file for file in files() if file.endswith("_unit.c"))
        return compiler.link(files(), units, name, target).content

    packages = [Path(str(package.__file__)).parent for model in models.values() for package in model.sources()]
    words = [
        compiler.recipe(target),
        *fingerprints(further),
        *(word for model in models.values() for word in words_of(model)),
        *(() if slices is None else slices.words),
    ]
    sources = hash_of([*packages, ROOT / "modelkit", ROOT / "fmus" / "compiler", C_FILES.parent], "\0".join(words))
    of_c = cache_file(
        CACHE_FOLDER, name, sources, ".key", lambda: key_of(compiler, target, files()).encode(), CACHED_MODULES
    )
    return cache_file(LIBRARY_FOLDER, "live", of_c.read_text(encoding="ascii"), suffix, make)


def live_files(models: Mapping[str, Model], slices: "Mapping[str, Slice] | None" = None) -> dict[str, str]:
    """Return the C files; those called ``..._unit.c`` are compiled. Charts of slices report no decisions."""
    from fmus.native.libraries import model_files, model_unit

    files = own_files("live.c", "batch.c", "batch.h", "faults.h", "library.h")
    charts = 0
    for owner, model in models.items():
        files |= model_files(model, None if slices is None else slices[owner])
        if slices is None:
            files[f"{model.name}.c"] = instrument(files[f"{model.name}.c"], model.all_charts(), charts)
        files[f"{model.name}_unit.c"] = MODEL_UNIT.format(declared=DECLARED, name=model.name, unit=model_unit(model))
        charts += len(model.all_charts())
    names = [f"{model.name}_library" for model in models.values()]
    files["live_unit.c"] = LIVE_UNIT.format(
        declared="\n".join(f"const Library *{name}(void);" for name in names),
        count=len(names),
        tables=", ".join(f"{name}()" for name in names),
        links=", ".join(f"{{{', '.join(map(str, wire))}}}" for wire in live_connections(models, slices)),
        charts=charts,
    )
    return files
