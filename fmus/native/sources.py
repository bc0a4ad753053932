"""The C files of an FMU: the model's, the FMI side, the tables, and the one file that is compiled."""

import json
from functools import lru_cache
from pathlib import Path

from fmus import compiler
from fmus.cache_paths import CACHE_FOLDER
from fmus.compiler import Translation, translate
from fmus.compiler.slicing import Slice
from fmus.locks import cache_file
from fmus.native.compilers import FLAGS
from fmus.native.library_cache import C_FILES
from fmus.native.source_fingerprint import CACHED_TRANSLATIONS, ROOT, hash_of, own_packages, words_of
from fmus.native.tables import longest_name, runs_file, signal_count, variables_file
from modelkit.model import Model

CORE = ("core.h", "core.c", "state.c")
FACES = {2: ("fmi2.h", "fmi2.c"), 3: ("fmi3.h", "fmi3.c", "fmi3_absent.c")}
UNIT = """/* The FMU {name}, FMI {fmi}.0 for co-simulation, in one translation unit: compile this file alone.
 *
 *     cc {flags} -fPIC -shared -o {name}.so {unit} -lm
 *
 * The flags are part of the result: no fast-math, no fused a*b + c. No -march is needed.
 */
#include "{name}.c"
{prefix}
#define FMU_MODEL {name}
#define FMU_TOKEN "{token}"
#define FMU_VARIABLES "{name}_variables.h"
#define FMU_RUNS "{name}_runs.h"
#define FMU_LONGEST_NAME {longest}
#define FMU_LISTED {listed}
{store}#include "fmi{fmi}.c"
"""
STORE = """#define FMU_STORE(model) &(model)->store,
"""
"""In the unit of a model that has work arrays."""
SUFFIX = ".c.json"
SHARED_FUNCTIONS = "-DFMI{fmi}_OVERRIDE_FUNCTION_PREFIX"
"""For a shared library: its functions have no prefix."""
PREFIX = {
    2: "",
    3: """
#ifndef FMI3_FUNCTION_PREFIX
#define FMI3_FUNCTION_PREFIX {name}_
#endif
""",
}
"""FMI 3.0 wants the prefix in the sources; in FMI 2.0 a tool that wants one defines it."""


@lru_cache
def translate_model(model: Model, live: Slice | None = None) -> Translation:
    """Return the C of ``model``, or of the slice ``live`` of it; ``TypeError`` if the translator refuses it.

    That of this project's own models is kept: they are made of their package and modelkit alone.
    """
    packages = own_packages(model)
    if packages is None:
        return translate(model, live)
    words = words_of(model)
    if live is not None:
        words += ["slice", *sorted(live.outputs), str(live.choices and sorted(live.choices))]
    key = hash_of([*packages, ROOT / "modelkit", Path(compiler.__file__).parent], "\0".join(words))
    name = model.name if live is None else f"{model.name}_slice"
    made = lambda: json.dumps(translate(model, live)._asdict()).encode()  # noqa: E731
    path = cache_file(CACHE_FOLDER, name, key, SUFFIX, made, CACHED_TRANSLATIONS)
    return Translation(**json.loads(path.read_bytes()))


def unit_name(model: Model, fmi: int) -> str:
    """Return the name of the file that is compiled."""
    return f"{model.name}_fmi{fmi}.c"


def fmu_sources(model: Model, token: str, fmi: int = 2) -> dict[str, str]:
    """Return file name -> text; ``token`` is what the FMU answers to. Raises ``TypeError`` if the model is refused."""
    code = translate_model(model)
    files = {name: (C_FILES / name).read_text(encoding="utf-8") for name in (*CORE, *FACES[fmi])}
    files |= {f"{model.name}.h": code.header, f"{model.name}.c": code.source}
    files |= {f"{model.name}_variables.h": variables_file(model, fmi), f"{model.name}_runs.h": runs_file(model)}
    unit = unit_name(model, fmi)
    files[unit] = UNIT.format(
        name=model.name,
        fmi=fmi,
        flags=" ".join((*FLAGS, SHARED_FUNCTIONS.format(fmi=fmi))),
        unit=unit,
        prefix=PREFIX[fmi].format(name=model.name),
        token=token,
        longest=longest_name(model),
        listed=signal_count(model),
        store="" if model.store is None else STORE,
    )
    return files
