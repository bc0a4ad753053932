"""Python files as the translator reads them: syntax trees, comments, and where each name comes from."""

import ast
import io
import sys
import tokenize
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from types import FunctionType
from typing import Any

from fmus.compiler.source.diagnostics import CannotError

KEPT_MODULES = 512
"""Modules that are kept for the next translation: a study slices and translates each of its models several times."""
NOTES = ("fmt:", "noqa", "type:", "ruff:", "pragma:", "mypy:")
"""Comments for tools, not for readers."""


@dataclass
class Module:
    """One Python file."""

    name: str
    file: str
    """Its path as a reader of the C file sees it."""
    tree: ast.Module
    comments: dict[int, str]
    imports: dict[str, tuple[str, str]] = field(default_factory=dict)
    """Names bound by ``from module import name``."""
    needs: list[str] = field(default_factory=list)
    """Modules that it imports, in order."""
    meanings: dict[str, str] = field(default_factory=dict)
    """The string under a module constant."""
    assigned: dict[str, ast.expr] = field(default_factory=dict)
    """What a module constant is assigned."""
    lines: dict[str, int] = field(default_factory=dict)
    functions: dict[tuple[str, int], ast.FunctionDef] = field(default_factory=dict)
    """By name and the number of the first line, of a decorator if there are any."""


class Library:
    """The modules read so far."""

    def __init__(self) -> None:
        self.modules: dict[str, Module] = {}

    def module(self, name: str) -> Module:
        """Return the module called ``name``, which Python has imported."""
        if name not in self.modules:
            self.modules[name] = read_module(name)
        return self.modules[name]

    def function(self, function: FunctionType) -> ast.FunctionDef:
        """Return the syntax tree of ``function``."""
        node = self.module(function.__module__).functions.get((function.__name__, function.__code__.co_firstlineno))
        if node is not None:
            return node
        advice = "define it with def at the top of a module"
        raise CannotError(None, f"{function.__qualname__} has no source text that can be read", advice)

    def class_node(self, cls: Any) -> ast.ClassDef | None:
        """Return the syntax tree of a class, if its module defines it by a class statement."""
        for node in self.module(cls.__module__).tree.body:
            if isinstance(node, ast.ClassDef) and node.name == cls.__name__:
                return node
        return None

    def origin(self, module: str, name: str) -> tuple[str, str]:
        """Return (module, name) where a global name of ``module`` is defined."""
        known = set()
        while (module, name) not in known and module in sys.modules and getattr(sys.modules[module], "__file__", None):
            known.add((module, name))
            if not str(sys.modules[module].__file__).endswith(".py"):
                break
            found = self.module(module).imports.get(name)
            if found is None:
                break
            module, name = found
        return module, name

    def order(self, roots: list[str], wanted: set[str]) -> list[str]:
        """Return the ``wanted`` modules so that each comes after those it imports."""
        done: dict[str, None] = {}
        seen: set[str] = set()
        packages = {name.split(".")[0] for name in (*roots, *wanted)} - sys.stdlib_module_names

        def visit(name: str) -> None:
            if name in seen or name.split(".")[0] not in packages or not _has_source(name):
                return
            seen.add(name)
            for needed in self.module(name).needs:
                visit(needed)
            done[name] = None

        for name in [*roots, *sorted(wanted)]:
            visit(name)
        return [name for name in done if name in wanted]


def _has_source(name: str) -> bool:
    return name in sys.modules and str(getattr(sys.modules[name], "__file__", None)).endswith(".py")


def read_module(name: str) -> Module:
    """Return module ``name`` read from its file."""
    path = Path(str(sys.modules[name].__file__))
    return _parse(name, path.name, path.read_text(encoding="utf-8"))


@lru_cache(maxsize=KEPT_MODULES)
def _parse(name: str, base: str, text: str) -> Module:
    """Return module ``name``, in a file called ``base``; nobody changes what is kept for the next translation."""
    is_package = base == "__init__.py"
    file = "/".join(name.split(".")) + ("/__init__.py" if is_package else ".py")
    found = Module(name, base if name == "__main__" else file, ast.parse(text), _comments(text))
    package = name if is_package else name.rpartition(".")[0]
    for node in ast.walk(found.tree):
        _note_imports(found, node, package)
        if isinstance(node, ast.FunctionDef):
            first = min([node.lineno, *(item.lineno for item in node.decorator_list)])
            found.functions[node.name, first] = node
    body = found.tree.body
    for node, after in zip(body, [*body[1:], None], strict=True):
        _note_constant(found, node, after)
    return found


def _note_imports(module: Module, node: ast.AST, package: str) -> None:
    if isinstance(node, ast.Import):
        module.needs += [alias.name for alias in node.names]
    if isinstance(node, ast.ImportFrom):
        base = node.module or ""
        if node.level:
            parents = package.split(".")[: len(package.split(".")) - node.level + 1]
            base = ".".join([*parents, base] if base else parents)
        module.needs.append(base)
        for alias in node.names:
            module.imports[alias.asname or alias.name] = (base, alias.name)
            module.needs.append(f"{base}.{alias.name}")


def _note_constant(module: Module, node: ast.stmt, after: ast.stmt | None) -> None:
    if isinstance(node, ast.Assign):
        targets, value = node.targets, node.value
    elif isinstance(node, ast.AnnAssign) and node.value is not None:
        targets, value = [node.target], node.value
    else:
        return
    for target in targets:
        if isinstance(target, ast.Name):
            module.assigned[target.id] = value
            module.lines[target.id] = node.lineno
            if isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant):
                if isinstance(after.value.value, str):
                    module.meanings[target.id] = plain(after.value.value)


def _comments(text: str) -> dict[int, str]:
    """Return the comments for readers by line."""
    found = {}
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            words = token.string.lstrip("#").strip()
            if words and not words.startswith(NOTES):
                found[token.start[0]] = words
    return found


def plain(text: str) -> str:
    """Return a docstring on one line, in ASCII as C compilers like it best, and without ends of comments."""
    return " ".join(text.split())


def field_meanings(node: ast.ClassDef | None) -> dict[str, str]:
    """Return the string under each field of a class."""
    found = {}
    body = node.body if node else []
    for item, after in pairwise(body):
        target: ast.expr | None = item.target if isinstance(item, ast.AnnAssign) else None
        if isinstance(item, ast.Assign):
            target = item.targets[0]
        if isinstance(target, ast.Name) and isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant):
            if isinstance(after.value.value, str):
                found[target.id] = plain(after.value.value)
    return found
