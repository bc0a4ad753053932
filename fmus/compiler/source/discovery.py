"""Which functions, classes, enums and constants a model reaches from its entries, before any is translated."""

import ast
import typing
from collections.abc import Iterable
from enum import IntEnum
from types import FunctionType
from typing import Any

from fmus.compiler.source.bindings import bindings
from fmus.compiler.source.diagnostics import CannotError
from fmus.compiler.source.reading import Library
from fmus.compiler.source.resolve import static
from fmus.compiler.source.types import NoKindError, hints_of, is_named_tuple, whole_of


class CallGraph:
    """Everything reached; in the order found, which does not depend on anything but the text of the model."""

    def __init__(self, library: Library, roots: Iterable[FunctionType], types: Iterable[Any]) -> None:
        self.library = library
        self.functions: dict[FunctionType, None] = {}
        self.classes: dict[Any, None] = {}
        self.enums: dict[type[IntEnum], None] = {}
        self.constants: dict[tuple[str, str], Any] = {}
        self.uses: dict[FunctionType, set[Any]] = {}
        """What each function names: functions, classes, places of constants."""
        for cls in types:
            self.add_hint(cls)
        for root in roots:
            self.add_function(root)

    def of(self, found: Iterable[Any], module: str) -> list[Any]:
        """Return those of ``found`` that ``module`` defines, in the order of their names' lines."""
        own = [item for item in found if item.__module__ == module]
        return sorted(own, key=lambda item: (self._line(item), item.__qualname__))

    def modules(self) -> set[str]:
        """Return every module that something comes from."""
        found = {item.__module__ for group in (self.functions, self.classes, self.enums) for item in group}
        return found | {module for module, _ in self.constants}

    def add_function(self, function: FunctionType) -> None:
        """Add a function and all it names."""
        if function in self.functions:
            return
        try:
            node = self.library.function(function)
        except (CannotError, OSError, KeyError, SyntaxError):
            return  # said where the function is called
        self.functions[function] = None
        local = bindings(node).local
        self.uses[function] = set()
        for name in [*ast.walk(node.args), *(part for statement in node.body for part in ast.walk(statement))]:
            if isinstance(name, ast.Name | ast.Attribute):
                found = static(name, function.__globals__, local, self.library)
                if found is not None:
                    self.uses[function].add(self.add(found.value, found.module, found.name))
        for default in [*(function.__defaults__ or ()), *(function.__kwdefaults__ or {}).values()]:
            self.add_value(default)
        self._add_hints(function)

    def _add_hints(self, item: Any) -> None:
        try:
            hints = typing.get_type_hints(item, include_extras=True)
        except Exception:
            return  # said where the function is translated
        for hint in hints.values():
            self.add_hint(hint)

    def add(self, value: Any, module: str, name: str) -> Any:
        """Add what a name stands for; return what stands for it in ``uses``."""
        if isinstance(value, FunctionType):
            self.add_function(value)
            return value
        if isinstance(value, type):
            self.add_hint(value)
            return value
        if isinstance(value, IntEnum):
            self.enums[type(value)] = None
            return value
        if isinstance(value, int | float | tuple) and module not in ("math", "builtins"):
            self.constants[module, name] = value
            self.add_value(value)
            return (module, name)
        return None

    def add_value(self, value: Any) -> None:
        """Add the classes and enums in a constant."""
        if isinstance(value, IntEnum):
            self.enums[type(value)] = None
        if isinstance(value, tuple):
            if is_named_tuple(type(value)):
                self.add_hint(type(value))
            for item in value:
                self.add_value(item)

    def add_hint(self, hint: Any) -> None:
        """Add the classes in an annotation, and the methods of those that have some."""
        for argument in typing.get_args(hint):
            if not isinstance(argument, str):
                self.add_hint(argument)
        try:
            hint = whole_of(hint)
        except NoKindError:
            return  # said where a function takes it
        for mark in getattr(hint, "__metadata__", ()):
            states = getattr(mark, "states", None)
            if states is not None:
                self.enums[states] = None
        if isinstance(hint, type) and issubclass(hint, IntEnum):
            self.enums[hint] = None
        if not is_named_tuple(hint) or hint in self.classes:
            return
        try:
            hints = hints_of(hint)
        except Exception:
            return  # said where the class is used
        for inner in hints.values():
            self.add_hint(inner)
        self.classes[hint] = None
        for default in hint._field_defaults.values():
            self.add_value(default)
        for item in vars(hint).values():
            function = item.fget if isinstance(item, property) else item
            if isinstance(function, FunctionType) and function.__module__ == hint.__module__:
                if function.__qualname__ == f"{hint.__name__}.{function.__name__}" and function.__name__[0] != "_":
                    self.add_function(function)

    def _line(self, item: Any) -> int:
        if isinstance(item, FunctionType):
            return item.__code__.co_firstlineno
        node = self.library.class_node(item) if not isinstance(item, tuple) else None
        return node.lineno if node else 0
