"""Shared libraries for this machine and this process that are made of a model."""

import ctypes
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

from fmus.compiler import members
from fmus.compiler.slicing import Slice
from fmus.native.compilers import can_compile, find_compiler
from fmus.native.library_cache import cache_library, lane_headers, own_files
from fmus.native.platforms import LINUX, is_known
from fmus.native.sources import translate_model
from fmus.native.tables import KINDS
from modelkit.model import Model
from modelkit.variables import flatten, variables

UNIT = """/* The model {name} as a table. */
#include "{name}.c"

#define LIBRARY_MODEL {name}
#define LIBRARY_MEMBERS "{name}_members.h"
{store}#include "library.c"
"""
LANES_UNIT = """/* The model {name} in lanes as a table. */
#include "{name}_lanes.c"

#define LIBRARY_MODEL {name}
#define LIBRARY_MEMBERS "{name}_members.h"
#include "lane_library.c"
"""
STORE = """#define LIBRARY_STORE(model) &(model)->store,
"""
"""In the unit of a model that has work arrays."""
MEMBERS_HEAD = """#ifdef MEMBER /* a line for each parameter, input and output: MEMBER(path, kind) */
{lines}#else /* how many there are of each */
#define LIBRARY_PARAMS {params}
#define LIBRARY_INPUTS {inputs}
#define LIBRARY_OUTPUTS {outputs}
#endif
"""


def python_front(cc: str | None = None) -> bytes | None:
    """Return the library of linux64 that stands before PythonFMU's own; None without a C compiler for it."""
    if not (cc or can_compile()) or not is_known():
        return None
    compiler, target = find_compiler(cc), LINUX._replace(options=(*LINUX.options, "-Wl,-z,nodelete", "-ldl"))
    if not compiler.can_make(target):
        return None
    files = own_files("python_front.c", "fmi2.h")
    return cache_library("python_front", "python_front.c", files, compiler, target).read_bytes()


@lru_cache
def model_library(model: Model, live: Slice | None = None, options: tuple[str, ...] = ()) -> Path:
    """Return the path of the library of ``model``: see ``library.c``. Raises as :func:`cache_library`, ``TypeError``.

    ``live``: of that slice of it alone; ``options``: of the compiler, besides the usual ones.
    """
    unit, name = f"{model.name}_library.c", model.name if live is None else f"{model.name}_slice"
    return cache_library(name, unit, {**model_files(model, live), unit: model_unit(model)}, options=options)


def model_unit(model: Model) -> str:
    """Return the file that is compiled: the model's C, and the model as a table."""
    return UNIT.format(name=model.name, store="" if model.store is None else STORE)


def model_files(model: Model, live: Slice | None = None) -> dict[str, str]:
    """Return the files with which a C file can have the model as a table: it includes what ``UNIT`` does."""
    code, known = translate_model(model, live), members(model)
    count = {group: sum(item.group == group for item in known) for group in ("params", "inputs", "outputs")}
    lines = "".join(f"MEMBER({item.path}, {KINDS[item.kind]})\n" for item in known)
    files = {f"{model.name}.h": code.header, f"{model.name}.c": code.source}
    files[f"{model.name}_members.h"] = MEMBERS_HEAD.format(lines=lines, **count)
    return files | own_files("library.c", "library.h")


def load_lanes(model: Model, live: Slice, options: tuple[str, ...]) -> Any:
    """Return the loaded library of the slice ``live`` of ``model`` in lanes: ``lane_library()`` is its table.

    Raises ``NoLanesError`` where there is no such form, and as :func:`model_library`.
    """
    from fmus.compiler.lanes import NoLanesError, lanes_of

    if model.store is not None:
        raise NoLanesError(f"{model.name} has work arrays")
    unit = f"{model.name}_lanes_library.c"
    files = model_files(model, live) | own_files("lane_library.c") | lane_headers()
    files |= {
        f"{model.name}_lanes.c": lanes_of(translate_model(model, live), model.outputs.__name__, live),
        unit: LANES_UNIT.format(name=model.name),
    }
    library = ctypes.CDLL(str(cache_library(f"{model.name}_lanes", unit, files, options=options)))
    library.lane_library.restype = ctypes.c_void_p
    return library


def load_model(model: Model, live: Slice | None = None, options: tuple[str, ...] = ()) -> Any:
    """Return the loaded library of ``model`` (see :func:`model_library`) with the signatures of its functions.

    ``model_library()``: the table; ``model_start(memory, params, outputs)``; ``model_step(memory, inputs, outputs,
    dt_ns)``: all arrays by their addresses.
    """
    return declare_functions(ctypes.CDLL(str(model_library(model, live, options))))


def declare_functions(library: Any) -> Any:
    """Return a library that has a model as a table with the signatures of its functions; see :func:`load_model`."""
    library.model_library.restype = ctypes.c_void_p
    library.model_start.argtypes = [ctypes.c_void_p] * 3
    library.model_step.argtypes = [*[ctypes.c_void_p] * 3, ctypes.c_int64]
    library.model_start.restype = library.model_step.restype = None
    return library


def in_c(model: Model, steps: Iterable[int]) -> Iterator[list[float]]:
    """Yield the outputs at the start and after each step [ns], the inputs at their start values. Raises as it loads."""
    library, outputs = load_model(model), variables(model.outputs)
    memory = (ctypes.c_int64 * (memory_size(library) // 8 + 1))()
    params, inputs = (_numbers(flatten(value)) for value in (model.first_params(), model.inputs()))
    reported = _numbers([0.0] * len(outputs))
    library.model_start(memory, params, reported)
    yield list(reported)
    for dt_ns in steps:
        library.model_step(memory, inputs, reported, dt_ns)
        yield list(reported)


def _numbers(values: Sequence[float]) -> Any:
    return (ctypes.c_double * len(values))(*values)


def memory_size(library: Any) -> int:
    """Return how many bytes an instance of a loaded model takes."""
    return int(ctypes.c_int64.from_address(library.model_library()).value)
