"""Which functions write to a store, themselves or by a function that they call."""

import ast
from collections.abc import Callable
from types import FunctionType

from fmus.compiler.source.bindings import Bindings
from fmus.compiler.source.diagnostics import CannotError
from fmus.compiler.source.reading import Library
from fmus.compiler.source.resolve import Static, static


class Writers:
    """The functions of a program that write to a store; one whose text cannot be read does not."""

    def __init__(self, library: Library, bindings_of: Callable[[FunctionType], Bindings]) -> None:
        self.library, self.bindings_of = library, bindings_of
        self.found: dict[FunctionType, bool] = {}

    def __contains__(self, function: FunctionType) -> bool:
        if function not in self.found:
            self.found[function] = False  # of a function that calls itself, which is refused elsewhere
            try:
                node = self.library.function(function)
            except (CannotError, OSError, KeyError, SyntaxError):
                return False  # said where the function is called
            self.found[function] = any(self._writes(function, part) for part in ast.walk(node))
        return self.found[function]

    def _writes(self, function: FunctionType, node: ast.AST) -> bool:
        if isinstance(node, ast.Subscript):
            return isinstance(node.ctx, ast.Store) and isinstance(node.value, ast.Attribute)
        if not isinstance(node, ast.Call):
            return False
        local = self.bindings_of(function).local
        return self.is_one(static(node.func, function.__globals__, local, self.library))

    def is_one(self, found: Static | None) -> bool:
        """Return whether what a name stands for is such a function."""
        return found is not None and isinstance(found.value, FunctionType) and found.value in self
