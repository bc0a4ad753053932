"""Liveness: which fields, variables, parameters and items of results the live outputs need."""

import ast
import copy
from collections.abc import Iterator
from functools import cache
from types import FunctionType
from typing import Any

from fmus.compiler.slicing.code_kinds import CodeKinds, Scope, fields_along, has_open
from fmus.compiler.source.bindings import Bindings, bindings
from fmus.compiler.source.discovery import CallGraph
from fmus.compiler.source.reading import Library
from fmus.compiler.source.types import Kind, Mixed, Scalar, Struct, fields_of, is_named_tuple, parts, whole_of
from fmus.compiler.source.writers import Writers

ALL_ITEMS = -1
"""Among the live items of a function's result: all of them."""
MAX_ROUNDS = 1000
"""Rounds of the fixed point; each adds a live field, variable or item at least, so it ends far earlier."""


class Solver(CodeKinds):
    """The fixed point: live fields, variables, parameters, and items of results."""

    def __init__(self, library: Library, found: CallGraph) -> None:
        super().__init__(library)
        self.found = found
        self.fields: set[tuple[Any, str]] = set()
        self.variables: set[tuple[FunctionType, str]] = set()
        self.results: dict[FunctionType, set[int]] = {}
        self.changed = True
        self.writers = Writers(library, self._bindings_of)
        self._bindings: dict[FunctionType, Bindings] = {}
        self._has_open = cache(has_open)

    def _bindings_of(self, function: FunctionType) -> Bindings:
        if function not in self._bindings:
            self._bindings[function] = bindings(self.library.function(function))
        return self._bindings[function]

    # ---- what is needed

    def need_output(self, cls: Any, name: str) -> None:
        """Note that an output is used."""
        for owner, field in fields_along(cls, name):
            self.need_field(owner, field)

    def need_field(self, cls: Any, field: str) -> None:
        """Note that a field is read."""
        if (cls, field) not in self.fields:
            self.fields.add((cls, field))
            self.changed = True

    def need_whole(self, kind: Kind | None) -> None:
        """Note that all of a value is read, without the names of its fields; None: a value of unknown kind."""
        if kind is None:
            for cls in self.found.classes:
                for field in cls._fields:
                    self.need_field(whole_of(cls), field)
            return
        if isinstance(kind, Struct):
            for field in fields_of(kind.cls):
                self.need_field(kind.cls, field)
        for part in parts(kind):  # also of a field that is live already: it may be read in part only
            self.need_whole(part)

    def need_variable(self, function: FunctionType, name: str) -> None:
        """Note that a variable of a function is read."""
        if (function, name) not in self.variables:
            self.variables.add((function, name))
            self.changed = True

    def need_result(self, function: FunctionType, items: set[int]) -> None:
        """Note that a function is called for some items of its result."""
        have = self.results.setdefault(function, set())
        if not items <= have:
            have |= items
            self.changed = True

    def is_live_item(self, function: FunctionType, number: int) -> bool:
        """Return whether item ``number`` of a function's result is read."""
        have = self.results.get(function, set())
        return ALL_ITEMS in have or number in have

    def is_live_parameter(self, function: FunctionType, name: str) -> bool:
        """Return whether a function reads its parameter; of one of unknown length it always does."""
        kind = self.function(function).kinds.get(name)
        return kind is None or self._has_open(kind) or (function, name) in self.variables

    # ---- the fixed point

    def solve(self) -> None:
        """Find all that is live."""
        for _ in range(MAX_ROUNDS):
            if not self.changed:
                return
            self.changed = False
            size = len(self.results)
            for function in list(self.results):
                Visitor(self, function).visit()
            self.changed |= len(self.results) != size
        raise AssertionError("the slice does not end")


class Visitor:
    """One pass over a function: from what is live at its end to what it needs for that."""

    def __init__(self, solver: Solver, function: FunctionType) -> None:
        self.solver, self.own = solver, function
        self.known = solver.function(function)

    def visit(self) -> None:
        """Note all that the function needs."""
        self.block(self.known.node.body)

    def is_live(self, node: ast.stmt, in_loop: bool = False) -> bool:
        """Return whether a statement belongs to the slice; ``in_loop``: to a loop that does."""
        if isinstance(node, ast.Return):
            return True
        if isinstance(node, ast.Break | ast.Continue):
            return in_loop
        if isinstance(node, ast.Assign):
            return any(self.binds_live(target) for target in node.targets)
        if isinstance(node, ast.AnnAssign | ast.AugAssign):
            return self.binds_live(node.target)
        if isinstance(node, ast.Expr):
            return isinstance(node.value, ast.Call)
        if isinstance(node, ast.If):
            return any(self.is_live(part, in_loop) for part in (*node.body, *node.orelse))
        if isinstance(node, ast.For | ast.While):
            return any(self.is_live(part) for part in node.body)
        if isinstance(node, ast.Match):
            return any(self.is_live(part, in_loop) for case in node.cases for part in case.body)
        return not isinstance(node, ast.Pass)

    def binds_live(self, target: ast.expr) -> bool:
        """Return whether an assignment to ``target`` binds a live variable."""
        if isinstance(target, ast.Name):
            return (self.own, target.id) in self.solver.variables
        if isinstance(target, ast.Tuple | ast.List):
            return any(self.binds_live(item) for item in target.elts)
        return True

    def block(self, nodes: list[ast.stmt], in_loop: bool = False) -> None:
        """Note what the live statements of a block need, the last first."""
        for node in reversed(nodes):
            if self.is_live(node, in_loop) or self._writes(node):
                self.statement(node, in_loop)

    def _writes(self, node: ast.stmt) -> bool:
        return self.own in self.solver.writers and not isinstance(node, ast.Pass)

    def statement(self, node: ast.stmt, in_loop: bool) -> None:
        """Note what a live statement needs."""
        if isinstance(node, ast.Return):
            if node.value is not None:
                self.visit_result(node.value)
        elif isinstance(node, ast.Assign):
            self.bound(node.targets[0], node.value)
        elif isinstance(node, ast.AnnAssign | ast.AugAssign):
            if node.value is not None:
                self.bound(node.target, node.value)
            if isinstance(node, ast.AugAssign):
                self.use(ast.copy_location(_as_load(node.target), node))
        elif isinstance(node, ast.Expr):
            self.use(node.value)
        elif isinstance(node, ast.If):
            self.use(node.test)
            self.block(node.body, in_loop)
            self.block(node.orelse, in_loop)
        elif isinstance(node, ast.While):
            self.use(node.test)
            self.block(node.body, True)
        elif isinstance(node, ast.For):
            self.visit_iterable(node.iter)
            self.block(node.body, True)
        elif isinstance(node, ast.Match):
            self.use(node.subject)
            for case in node.cases:
                if case.guard is not None:
                    self.use(case.guard)
                self.block(case.body, in_loop)

    def visit_result(self, value: ast.expr) -> None:
        """Note what the live items of a returned value need."""
        if isinstance(value, ast.IfExp):
            self.use(value.test)
            self.visit_result(value.body)
            self.visit_result(value.orelse)
        elif isinstance(value, ast.Tuple) and self._is_mixed(len(value.elts)):
            for number, item in enumerate(value.elts):
                if self.solver.is_live_item(self.own, number):
                    self.use(item)
        else:
            self.use(value, self.solver.results[self.own])

    def _is_mixed(self, count: int) -> bool:
        result = self.known.result
        return isinstance(result, Mixed) and len(result.items) == count

    def bound(self, target: ast.expr, value: ast.expr) -> None:
        """Note what an assignment needs for the live names of its target."""
        if not isinstance(target, ast.Tuple):
            if isinstance(target, ast.Subscript):
                self.use(target.value)
                self.use(target.slice)
            self.use(value)
            return
        live = {number for number, item in enumerate(target.elts) if self.binds_live(item)}
        if isinstance(value, ast.Tuple) and len(value.elts) == len(target.elts):
            for number in live:
                self.use(value.elts[number])
            return
        kind = self.solver.kind(self.known, value, {})
        if isinstance(kind, Struct):
            for number in live:
                self.solver.need_field(kind.cls, list(fields_of(kind.cls))[number])
        elif kind is None:
            self.solver.need_whole(None)
        self.use(value, live)

    def visit_iterable(self, node: ast.expr) -> None:
        """Note what a loop needs that runs over ``node``."""
        kind = self.solver.kind(self.known, node, {})
        if isinstance(kind, Struct):
            self.solver.need_whole(kind)
        self.use(node)

    # ---- expressions

    def use(self, node: ast.expr, items: set[int] | None = None, scope: Scope | None = None) -> None:
        """Note what a live expression needs; ``items``: of the result of a call, if not all."""
        scope = scope or {}
        if isinstance(node, ast.Name):
            if node.id not in scope and node.id in self.known.local:
                self.solver.need_variable(self.own, node.id)
        elif isinstance(node, ast.Attribute):
            self._use_attribute(node, scope)
        elif isinstance(node, ast.Call):
            self._use_call(node, items if items is not None else {ALL_ITEMS}, scope)
        elif isinstance(node, ast.IfExp):
            self.use(node.test, None, scope)
            self.use(node.body, items, scope)
            self.use(node.orelse, items, scope)
        elif isinstance(node, ast.GeneratorExp | ast.ListComp):
            inner = scope | self.solver.bound(self.known, node, scope)
            for generator in node.generators:
                self.use(generator.iter, None, inner)
                for test in generator.ifs:
                    self.use(test, None, inner)
            self.use(node.elt, None, inner)
        else:
            if isinstance(node, ast.Compare):
                for part in (node.left, *node.comparators):
                    self._need_all(part, scope)
            if isinstance(node, ast.Subscript):
                kind = self.solver.kind(self.known, node.value, scope)
                if isinstance(kind, Struct):
                    self.solver.need_whole(kind)
            for child in ast.iter_child_nodes(node):
                if isinstance(child, ast.expr):
                    self.use(child, None, scope)

    def _need_all(self, node: ast.expr, scope: Scope) -> None:
        """Note that an expression is read as a whole: compared, or given to a function of Python."""
        kind = self.solver.kind(self.known, node, scope)
        if not isinstance(kind, Scalar) and kind is not None:
            self.solver.need_whole(kind)

    def _use_attribute(self, node: ast.Attribute, scope: Scope) -> None:
        solver = self.solver
        if solver.static(self.known, node, scope) is not None:
            return
        base = solver.kind(self.known, node.value, scope)
        if isinstance(base, Struct) and node.attr in fields_of(base.cls):
            solver.need_field(base.cls, node.attr)
        elif isinstance(base, Struct):
            method = solver.method(self.known, node, scope)
            if method is None:
                solver.need_whole(base)
            else:
                solver.need_result(method, {ALL_ITEMS})
        else:
            for cls in solver.found.classes:
                if node.attr in cls._fields:
                    solver.need_field(whole_of(cls), node.attr)
                found = vars(cls).get(node.attr)
                if isinstance(found, property) and isinstance(found.fget, FunctionType):
                    solver.need_result(found.fget, {ALL_ITEMS})
        self.use(node.value, None, scope)

    def _use_call(self, node: ast.Call, items: set[int], scope: Scope) -> None:
        solver = self.solver
        found = solver.static(self.known, node.func, scope)
        if found is None and isinstance(node.func, ast.Attribute):
            self._use_method(node, node.func, items, scope)
            return
        target = found.value if found is not None else None
        if is_named_tuple(target):
            cls = whole_of(target)
            for name, value in arguments(node, list(fields_of(cls))):
                if (cls, name) in solver.fields:
                    self.use(value, None, scope)
        elif isinstance(target, FunctionType):
            self._use_function(node, target, items, scope)
        else:
            for value in (*node.args, *(item.value for item in node.keywords)):
                if not isinstance(value, ast.GeneratorExp) and target not in (len, tuple, enumerate, zip, reversed):
                    self._need_all(value, scope)
                self.use(value, None, scope)

    def _use_function(
        self, node: ast.Call, target: FunctionType, items: set[int], scope: Scope, first: int = 0
    ) -> None:
        self.solver.need_result(target, items)
        for name, value in arguments(node, self.solver.function(target).names[first:]):
            if self.solver.is_live_parameter(target, name):
                self.use(value, None, scope)

    def _use_method(self, node: ast.Call, function: ast.Attribute, items: set[int], scope: Scope) -> None:
        if function.attr == "_replace":
            kind = self.solver.kind(self.known, function.value, scope)
            self.use(function.value, None, scope)
            for item in node.keywords:
                if not isinstance(kind, Struct) or (kind.cls, item.arg) in self.solver.fields:
                    self.use(item.value, None, scope)
            return
        method = self.solver.method(self.known, function, scope)
        self.use(function.value, None, scope)
        if method is None:  # the translator says what is wrong with it
            self.solver.need_whole(None)
            for value in node.args:
                self.use(value, None, scope)
            return
        self.solver.need_variable(method, self.solver.function(method).names[0])
        self._use_function(node, method, items, scope, 1)


def _as_load(target: ast.expr) -> ast.expr:
    loaded = copy.copy(target)
    loaded.ctx = ast.Load()  # type: ignore[attr-defined]
    return loaded


def arguments(node: ast.Call, names: list[str]) -> Iterator[tuple[str, ast.expr]]:
    """Yield name and value of each argument of a call."""
    yield from zip(names, node.args, strict=False)
    for item in node.keywords:
        yield str(item.arg), item.value
