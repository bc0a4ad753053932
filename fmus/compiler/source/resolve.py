"""What a name in a function stands for: a constant, an enum member, a class, a function, a module."""

import ast
import builtins
import sys
from enum import Enum, IntEnum
from types import FunctionType, ModuleType
from typing import Any, NamedTuple

from fmus.compiler.source.reading import Library


class Static(NamedTuple):
    """A Python object known before the model runs, and where it has its name."""

    value: Any
    module: str
    name: str


def static(node: ast.expr, globals_of: dict[str, Any], local: set[str], library: Library) -> Static | None:
    """Return the object that a name or a chain of attributes stands for, unless it begins with a variable."""
    if isinstance(node, ast.Name):
        if node.id in local:
            return None
        if node.id in globals_of:
            module, name = library.origin(str(globals_of.get("__name__")), node.id)
            return _through_alias(Static(globals_of[node.id], module, name), library)
        if hasattr(builtins, node.id):
            return Static(getattr(builtins, node.id), "builtins", node.id)
        return None
    if not isinstance(node, ast.Attribute):
        return None
    base = static(node.value, globals_of, local, library)
    if base is None:
        return None
    return attribute(base, node.attr, library)


def attribute(base: Static, name: str, library: Library) -> Static | None:
    """Return an attribute of a module, an enum or an enum member; None if there is none."""
    if isinstance(base.value, ModuleType) and hasattr(base.value, name):
        module, own = library.origin(base.value.__name__, name)
        return _through_alias(Static(getattr(base.value, name), module, own), library)
    if isinstance(base.value, type) and issubclass(base.value, Enum) and name in base.value.__members__:
        return Static(base.value[name], base.value.__module__, f"{base.value.__name__}.{name}")
    if isinstance(base.value, IntEnum) and name == "value":
        return base
    method = vars(base.value).get(name) if isinstance(base.value, type) else None
    if isinstance(method, FunctionType) and method.__module__ == base.value.__module__:
        return Static(method, base.module, f"{base.name}.{name}")
    return None


def _through_alias(found: Static, library: Library) -> Static:
    """Return the enum member that a constant such as ``STOP = int(Phase.STOP)`` is another name of."""
    if type(found.value) is not int or found.module not in library.modules:
        return found
    node = library.modules[found.module].assigned.get(found.name)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "int" and len(node.args) == 1:
        node = node.args[0]
    if isinstance(node, ast.Attribute):
        member = static(node, vars(sys.modules[found.module]), set(), library)
        if member is not None and isinstance(member.value, IntEnum) and int(member.value) == found.value:
            return member
    return found


def owner_of(function: FunctionType) -> Any:
    """Return the class that has the method ``function``."""
    return getattr(sys.modules[function.__module__], function.__qualname__.split(".")[0])
