"""A model as machine code, by numba. The one file that sees numba.

Model files know nothing of it: every function of the model's package and of the model files of
``modelkit`` is made compilable from outside. No fast-math and no contraction of a*b + c, so the
results are CPython's, to the last bit, as long as both use the same C library.
"""

import ast
import importlib
import inspect
import pkgutil
import re
import sys
import textwrap
from collections.abc import Callable, Iterator
from types import FunctionType, ModuleType
from typing import Any

from fmus.compiled_modules import collect
from fmus.compiled_types import install
from fmus.compiled_views import viewer
from fmus.flat_entry import Entries, entries
from fmus.sources import MODELKIT_FILES, load
from modelkit.model import Model

numba: Any = importlib.import_module(
    "numba"
)  # untyped on purpose: what it says of its types changes with every version
types = numba.types
POINTER = types.CPointer(types.float64)
OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": False, "nogil": True}
BARE: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
INITIALIZE = types.void(POINTER, POINTER, POINTER)
STEP = types.void(POINTER, POINTER, POINTER, POINTER, types.int64)
HEAD = ";; module\n"
_done: set[str] = set()


def make_compilable(package: ModuleType) -> None:
    """Let compiled code call every function of ``package`` and of modelkit's model files."""
    install()
    for name in (*MODELKIT_FILES, *(module.__name__ for module in modules(package))):
        if name not in _done:
            _done.add(name)
            for function in functions(importlib.import_module(name)):
                inline = not has_loop(function)
                numba.extending.register_jitable(error_model="numpy", forceinline=inline)(function)


def has_loop(function: FunctionType) -> bool:
    """Return whether a function has a loop: one that has is called, not copied to each place that calls it."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    return any(isinstance(node, ast.For | ast.While) for node in ast.walk(tree))


def modules(package: ModuleType) -> Iterator[ModuleType]:
    """Yield every module of ``package``, subpackages too."""
    for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
        yield importlib.import_module(found.name)


def functions(module: ModuleType) -> list[FunctionType]:
    """Return the functions that ``module`` itself defines."""
    found = [item for item in vars(module).values() if inspect.isfunction(item)]
    return [item for item in found if item.__module__ == module.__name__]


def compiled_entries(model: Model) -> Entries:
    """Return ``model_initialize`` and ``model_step`` compiled for this process, over numpy arrays of doubles."""
    make_compilable(model.package)
    plain = _with_branches(model)
    jit: Callable[[Any], Any] = numba.njit(**OPTIONS)
    return Entries(jit(plain.initialize), jit(plain.step), plain.branches)


def _with_branches(model: Model) -> Entries:
    """Return the entries, of which the step may call the branches from compiled code."""
    plain = entries(model, viewer)
    for branch in plain.branches.values():
        numba.extending.register_jitable(error_model="numpy")(branch)
    return plain


def intermediate_code(model: Model) -> list[str]:
    """Return LLVM modules which, linked, hold the two entry functions over pointers to doubles and all they call.

    The symbols of the entries contain ``model_initialize`` and ``model_step``; they return an i32, zero
    if all went well, and take two pointers that carry nothing before the arguments of the Python function.
    Raises ``TypeError`` with numba's explanation if the model cannot be compiled. Nothing can be run in
    this process afterwards, see ``compiled_modules``.
    """
    found = collect()
    make_compilable(model.package)
    plain = _with_branches(model)
    for name, function, signature in (
        ("model_initialize", plain.initialize, INITIALIZE),
        ("model_step", plain.step, STEP),
    ):
        _compile(function, signature, name)
    return found


def _compile(function: Callable[..., None], signature: Any, name: str) -> None:
    try:
        numba.njit(signature, **BARE, **OPTIONS)(function)
    except Exception as error:
        raise TypeError(f"{name} cannot be compiled{_where(error)}: {plain(str(error))}") from error


def plain(text: str) -> str:
    """Return numba's explanation without colours, without types of hundreds of fields, and each line once."""
    lines = dict.fromkeys(line.rstrip() for line in re.sub(r"\x1b\[[0-9;]*m", "", text).splitlines())
    noise = (">>>", "- Of which", "Overload", "With argument", "Rejected", "There are", "During: Pass", "raised from")
    return "\n".join(line for line in lines if line and not line.lstrip().startswith(noise))


def _where(error: BaseException) -> str:
    """Return the model's function in which numba gave up, if it got as far as naming one."""
    found = ""
    trace = error.__traceback__
    while trace is not None:
        function = getattr(trace.tb_frame.f_locals.get("state"), "func_id", None)
        if function is not None:
            found = f", in {function.func_qualname} ({function.filename}:{function.firstlineno})"
        trace = trace.tb_next
    return found


def main(arguments: list[str]) -> int:
    """Print the LLVM modules of ``package:NAME`` (a Model), each behind a line ``;; module``."""
    try:
        code = intermediate_code(load(arguments[0]))
    except TypeError as error:
        print(error, file=sys.stderr)
        return 1
    for text in code:
        print(f"{HEAD}{text}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
