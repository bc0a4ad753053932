"""A slice of a model, and the program that is left of it."""

import ast
from collections.abc import Iterable
from types import FunctionType
from typing import Any, NamedTuple

from fmus.compiler.slicing.liveness import ALL_ITEMS, Solver
from fmus.compiler.slicing.rewriting import DeadValue, Rewriter
from fmus.compiler.source.discovery import CallGraph
from fmus.compiler.source.reading import Library

__all__ = ["DeadValue", "Slice", "SlicedLibrary", "slice_program", "solve_liveness"]


class Slice(NamedTuple):
    """What is used of a model in a study."""

    outputs: frozenset[str]
    """Names of the outputs that are connected, kept or disturbed: ``pose.x``, ``ultrasonic[3]``."""
    choices: frozenset[int] | None = None
    """Values of the parameter that chooses a system; None: all."""


class SlicedLibrary(Library):
    """The syntax trees of a slice: live functions without their dead statements."""

    def __init__(self, library: Library, functions: dict[FunctionType, ast.FunctionDef]) -> None:
        super().__init__()
        self.modules = library.modules
        self._sliced = functions

    def function(self, function: FunctionType) -> ast.FunctionDef:
        """Return the syntax tree of ``function`` within the slice."""
        return self._sliced.get(function) or super().function(function)


def slice_program(
    library: Library, roots: list[FunctionType], types: Iterable[Any], outputs: Any, live: Iterable[str]
) -> SlicedLibrary:
    """Return what is left of the program entered by ``roots`` whose outputs ``live`` are used.

    ``outputs`` is the NamedTuple of the outputs, ``types`` are those of the model's interface.
    """
    solver = solve_liveness(library, roots, types, outputs, live)
    return SlicedLibrary(library, {function: Rewriter(solver, function).rewritten() for function in solver.results})


def solve_liveness(
    library: Library, roots: list[FunctionType], types: Iterable[Any], outputs: Any, live: Iterable[str]
) -> Solver:
    """Return what is live in the program of :func:`slice_program`."""
    solver = Solver(library, CallGraph(library, roots, types))
    for name in live:
        solver.need_output(outputs, name)
    for root in roots:
        solver.need_result(root, {ALL_ITEMS})
    solver.solve()
    return solver
