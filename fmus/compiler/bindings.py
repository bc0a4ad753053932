"""Where in a function each variable is bound and used: from that follows where C declares it, and whether const."""

import ast
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

Path = tuple[tuple[int, str], ...]
"""A block of statements, as the way to it from the function's own."""


@dataclass
class Bindings:
    """What one function does with its names."""

    parameters: list[str]
    homes: dict[str, Path] = field(default_factory=dict)
    """The innermost block that has all mentions of a variable."""
    stores: Counter[str] = field(default_factory=Counter)
    loads: Counter[str] = field(default_factory=Counter)

    @property
    def local(self) -> set[str]:
        """Every name that the function binds."""
        return {*self.parameters, *self.stores}

    def rebound(self, name: str) -> bool:
        """Return whether a parameter is bound anew inside the function."""
        return self.stores[name] > 0


def bindings(function: ast.FunctionDef) -> Bindings:
    """Return the bindings of ``function``."""
    arguments = function.args
    names = [item.arg for item in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)]
    found = Bindings(names)
    for name in names:
        found.homes[name] = ()
    _walk(found, function.body, ())
    return found


def block(path: Path, node: ast.AST, which: str) -> Path:
    """Return the path of a block that belongs to ``node``."""
    return (*path, (id(node), which))


def _walk(found: Bindings, body: Iterable[ast.stmt], path: Path) -> None:
    for node in body:
        if isinstance(node, ast.For):
            inside = block(path, node, "body")
            _mention(found, node.iter, path)
            _mention(found, node.target, inside)
            _walk(found, node.body, inside)
        elif isinstance(node, ast.If | ast.While):
            _mention(found, node.test, path)
            _walk(found, node.body, block(path, node, "body"))
            _walk(found, node.orelse, block(path, node, "else"))
        elif isinstance(node, ast.Match):
            _mention(found, node.subject, path)
            for case in node.cases:
                if case.guard:
                    _mention(found, case.guard, path)
                _walk(found, case.body, block(path, case, "body"))
        else:
            _mention(found, node, path)
            if isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name):
                found.loads[node.target.id] += 1


def _mention(found: Bindings, node: ast.AST, path: Path) -> None:
    for name in names_in(node):
        known = found.homes.get(name.id)
        found.homes[name.id] = path if known is None else _common(known, path)
        (found.loads if isinstance(name.ctx, ast.Load) else found.stores)[name.id] += 1


def names_in(node: ast.AST) -> Iterator[ast.Name]:
    """Yield the names of the function in ``node``; those that a generator binds for itself are not."""
    if isinstance(node, ast.GeneratorExp):
        inner = {item.id for part in node.generators for item in ast.walk(part.target) if isinstance(item, ast.Name)}
        for child in ast.iter_child_nodes(node):
            yield from (name for name in names_in(child) if name.id not in inner)
    elif isinstance(node, ast.Name):
        yield node
    elif isinstance(node, ast.AnnAssign):
        yield from names_in(node.target)
        if node.value:
            yield from names_in(node.value)
    elif not isinstance(node, ast.FunctionDef | ast.Lambda | ast.ClassDef):
        for child in ast.iter_child_nodes(node):
            yield from names_in(child)


def reads(node: ast.AST, name: str) -> bool:
    """Return whether an expression reads the variable ``name``."""
    return any(item.id == name and isinstance(item.ctx, ast.Load) for item in names_in(node))


def stored_in(body: Iterable[ast.AST]) -> set[str]:
    """Return the variables that statements bind."""
    return {name.id for node in body for name in names_in(node) if isinstance(name.ctx, ast.Store)}


def _common(a: Path, b: Path) -> Path:
    count = 0
    while count < min(len(a), len(b)) and a[count] == b[count]:
        count += 1
    return a[:count]
