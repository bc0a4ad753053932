"""Where in a function each variable is bound and used: from that follows where C declares it, and whether const.

A name may stand for several variables that know nothing of each other, such as the counter of two
loops one after the other. Each has a home: the innermost block that has all of its mentions.
"""

import ast
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

Path = tuple[tuple[int, str], ...]
"""A block of statements, as the way to it from the function's own."""


@dataclass
class Home:
    """One variable: where it lives, how often it is bound and read there."""

    path: Path
    stores: int = 0
    loads: int = 0


@dataclass
class Mention:
    """One place where a name is written in the source."""

    path: Path
    store: bool
    first: bool
    """It is bound here before anything in its block reads it, and in every case."""


@dataclass
class Bindings:
    """What one function does with its names."""

    parameters: list[str]
    mentions: dict[str, list[Mention]] = field(default_factory=dict)
    homes: dict[str, list[Home]] = field(default_factory=dict)

    @property
    def local(self) -> set[str]:
        """Every name that the function binds."""
        return {*self.parameters, *(name for name, found in self.mentions.items() if any(m.store for m in found))}

    def home(self, name: str, path: Path) -> Home:
        """Return the variable that ``name`` stands for in the block ``path``."""
        for home in self.homes.get(name, ()):
            if path[: len(home.path)] == home.path:
                return home
        return Home(())

    def rebound(self, name: str) -> bool:
        """Return whether a parameter is bound anew inside the function."""
        return any(mention.store for mention in self.mentions.get(name, ()))


def bindings(function: ast.FunctionDef) -> Bindings:
    """Return the bindings of ``function``."""
    arguments = function.args
    found = Bindings([item.arg for item in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)])
    _walk(found, function.body, ())
    for name, mentions in found.mentions.items():
        found.homes[name] = [_home((), mentions)] if name in found.parameters else list(_homes((), mentions))
    return found


def block(path: Path, node: ast.AST, which: str) -> Path:
    """Return the path of a block that belongs to ``node``."""
    return (*path, (id(node), which))


def _homes(path: Path, mentions: list[Mention]) -> Iterator[Home]:
    """Yield the variables that a name stands for below ``path``."""
    inner: dict[Path, list[Mention]] = {}
    for mention in mentions:
        inner.setdefault(mention.path[: len(path) + 1], []).append(mention)
    if path in inner:  # mentioned by this block itself
        yield _home(path, mentions)
    elif len(inner) == 1:
        yield from _homes(next(iter(inner)), mentions)
    elif all(_begins_with_store(child, group) for child, group in inner.items()):
        for child, group in inner.items():
            yield from _homes(child, group)
    else:
        yield _home(path, mentions)


def _begins_with_store(path: Path, mentions: list[Mention]) -> bool:
    """Return whether a block binds a name before it reads it, whatever happens inside."""
    first = mentions[0]
    return first.path == path and first.store and first.first


def _home(path: Path, mentions: list[Mention]) -> Home:
    stores = sum(mention.store for mention in mentions)
    return Home(path, stores, len(mentions) - stores)


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


def _mention(found: Bindings, node: ast.AST, path: Path) -> None:
    names = list(names_in(node))
    loads = {name.id for name in names if isinstance(name.ctx, ast.Load)}
    if isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name):
        loads.add(node.target.id)
        found.mentions.setdefault(node.target.id, []).append(Mention(path, False, False))
    for name in sorted(names, key=lambda item: isinstance(item.ctx, ast.Store)):
        store = isinstance(name.ctx, ast.Store)
        found.mentions.setdefault(name.id, []).append(Mention(path, store, name.id not in loads))


def names_in(node: ast.AST) -> Iterator[ast.Name]:
    """Yield the names of the function in ``node``; those that a generator binds for itself are not."""
    if isinstance(node, ast.GeneratorExp | ast.ListComp | ast.SetComp | ast.DictComp):
        inner = {item.id for part in node.generators for item in ast.walk(part.target) if isinstance(item, ast.Name)}
        outer = node.generators[0].iter
        yield from names_in(outer)
        for name in (name for child in ast.iter_child_nodes(node) for name in _names_but(child, outer)):
            if name.id not in inner:
                yield name
    elif isinstance(node, ast.Name):
        yield node
    elif isinstance(node, ast.AnnAssign):
        yield from names_in(node.target)
        if node.value:
            yield from names_in(node.value)
    elif not isinstance(node, ast.FunctionDef | ast.Lambda | ast.ClassDef):
        for child in ast.iter_child_nodes(node):
            yield from names_in(child)


def _names_but(node: ast.AST, left_out: ast.AST) -> Iterator[ast.Name]:
    if isinstance(node, ast.comprehension):
        for child in ast.iter_child_nodes(node):
            if child is not left_out:
                yield from names_in(child)
    else:
        yield from names_in(node)


def reads(node: ast.AST, name: str) -> bool:
    """Return whether an expression reads the variable ``name``."""
    return any(item.id == name and isinstance(item.ctx, ast.Load) for item in names_in(node))


def variables_bound(body: Iterable[ast.AST]) -> set[str]:
    """Return the variables that statements bind."""
    return {name.id for node in body for name in names_in(node) if isinstance(name.ctx, ast.Store)}
