"""Numba's LLVM modules as they are before linking and optimising: one small text per function.

Numba links every function it compiles with all that it calls, optimises that and makes machine code
of it, at every level of calls anew; for a deep model this is most of the time. A native FMU needs
each function once, unoptimised: all of it is linked and optimised together afterwards.
"""

from importlib import import_module
from typing import Any

codegen: Any = import_module("numba.core.codegen")
cpu: Any = import_module("numba.core.cpu")
lowering: Any = import_module("numba.core.lowering")


def collect() -> list[str]:
    """Return a list that receives the text of every function compiled from now on, in this process.

    Nothing compiled afterwards can be called: no machine code is made. For a process of its own.
    """
    found: list[str] = []

    def finalize(library: Any) -> None:
        library._raise_if_finalized()
        library._final_module.verify()
        library._finalized = True
        found.append(str(library._final_module))

    def get_executable(_context: Any, library: Any, _fndesc: Any, _env: Any) -> Any:
        library._ensure_finalized()
        return [].append  # never called: numba asks for a built-in function, another one each time

    codegen.JITCodeLibrary.finalize = finalize
    lowering.Lower.create_cfunc_wrapper = lambda _lower: None
    cpu.CPUContext.get_executable = get_executable
    return found
