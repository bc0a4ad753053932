"""The text of functions without their dead statements, arguments and fields."""

import ast
import copy
from collections.abc import Callable
from types import FunctionType
from typing import Any, NamedTuple, cast

from fmus.compiler.slicing.code_kinds import Scope, has_open
from fmus.compiler.slicing.liveness import Solver, Visitor
from fmus.compiler.source.types import Kind, Mixed, Struct, fields_of, is_named_tuple, whole_of


class DeadValue(NamedTuple):
    """The value of a constant in a slice: that of something nobody reads."""

    kind: Kind


class Rewriter:
    """The text of a function without its dead statements, arguments and fields."""

    def __init__(self, solver: Solver, function: FunctionType) -> None:
        self.solver, self.own = solver, function
        self.known = solver.function(function)
        self.visitor = Visitor(solver, function)

    def rewritten(self) -> ast.FunctionDef:
        """Return the sliced function."""
        made = copy.copy(self.known.node)
        made.body = self.block(made.body)
        return made

    def block(self, nodes: list[ast.stmt], in_loop: bool = False) -> list[ast.stmt]:
        """Return the live statements of a block, as new nodes."""
        found = []
        for node in nodes:
            comment = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
            writes = self.own in self.solver.writers
            if comment or writes or self.visitor.is_live(node, in_loop):
                found.append(self.statement(node, in_loop))
        return found or [ast.copy_location(ast.Pass(), nodes[0])]

    def statement(self, node: ast.stmt, in_loop: bool) -> ast.stmt:
        """Return a live statement as a new node."""
        made = copy.copy(node)
        if isinstance(made, ast.If):
            made.test = self.expression(made.test)
            made.body = self.block(made.body, in_loop)
            made.orelse = self.block(made.orelse, in_loop) if self._any_live(made.orelse, in_loop) else []
        elif isinstance(made, ast.For):
            made.iter, made.body = self.expression(made.iter), self.block(made.body, True)
        elif isinstance(made, ast.While):
            made.test, made.body = self.expression(made.test), self.block(made.body, True)
        elif isinstance(made, ast.Match):
            made.subject = self.expression(made.subject)
            made.cases = [self._case(case, in_loop) for case in made.cases]
        elif isinstance(made, ast.Return):
            made.value = None if made.value is None else self.visit_result(made.value)
        elif isinstance(made, ast.Assign):
            made.value = self.rewrite_value(made.targets[0], made.value)
        else:
            made = self.expression(made)
        return made

    def _any_live(self, nodes: list[ast.stmt], in_loop: bool) -> bool:
        return any(self.own in self.solver.writers or self.visitor.is_live(node, in_loop) for node in nodes)

    def _case(self, case: ast.match_case, in_loop: bool) -> ast.match_case:
        made = copy.copy(case)
        made.guard = None if case.guard is None else self.expression(case.guard)
        made.body = self.block(case.body, in_loop)
        return made

    def visit_result(self, value: ast.expr) -> ast.expr:
        """Return a returned value without the items that nobody reads."""
        result = self.known.result
        if isinstance(value, ast.IfExp):
            made = copy.copy(value)
            made.test = self.expression(value.test)
            made.body, made.orelse = self.visit_result(value.body), self.visit_result(value.orelse)
            return made
        if isinstance(value, ast.Tuple) and isinstance(result, Mixed) and len(result.items) == len(value.elts):
            items = copy.copy(value)
            items.elts = [
                self.expression(item) if self.solver.is_live_item(self.own, number) else dead(item, kind)
                for number, (item, kind) in enumerate(zip(value.elts, result.items, strict=True))
            ]
            return items
        return cast("ast.expr", self.expression(value))

    def rewrite_value(self, target: ast.expr, value: ast.expr) -> ast.expr:
        """Return what is assigned, without the items of a tuple that get dead names."""
        if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple) and len(target.elts) == len(value.elts):
            made = copy.copy(value)
            made.elts = [
                self.expression(item) if self.visitor.binds_live(part) else self._dead_item(item)
                for part, item in zip(target.elts, value.elts, strict=True)
            ]
            return made
        return cast("ast.expr", self.expression(value))

    def _dead_item(self, item: ast.expr) -> ast.expr:
        kind = self.solver.kind(self.known, item, {})
        return cast("ast.expr", self.expression(item)) if kind is None or has_open(kind) else dead(item, kind)

    def expression(self, node: Any) -> Any:
        """Return an expression with zeros for dead arguments and fields, as a new node."""
        return _Zeros(self).visit(copy.deepcopy(node))


class _Zeros(ast.NodeTransformer):
    """Writes zeros for dead arguments and fields; scopes of generators are followed for the kinds of their names."""

    def __init__(self, rewriter: Rewriter) -> None:
        self.solver, self.known = rewriter.solver, rewriter.known
        self.scope: Scope = {}

    def visit_GeneratorExp(self, node: ast.GeneratorExp) -> ast.AST:
        """Follow the names that a generator binds."""
        before, self.scope = self.scope, self.scope | self.solver.bound(self.known, node, self.scope)
        made = self.generic_visit(node)
        self.scope = before
        return made

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Write zeros for the dead arguments of a call."""
        solver = self.solver
        found = solver.static(self.known, node.func, self.scope)
        target = found.value if found is not None else None
        if is_named_tuple(target):
            cls = whole_of(target)
            kinds = fields_of(cls)
            self._replace(node, list(kinds), lambda name: (cls, name) in solver.fields, lambda name: kinds[name])
        elif isinstance(target, FunctionType):
            self._zero_arguments(node, target, 0)
        elif found is None and isinstance(node.func, ast.Attribute):
            if node.func.attr == "_replace":
                kind = solver.kind(self.known, node.func.value, self.scope)
                if isinstance(kind, Struct):
                    node.keywords = [item for item in node.keywords if (kind.cls, item.arg) in solver.fields]
                    if not node.keywords:
                        return self.visit(node.func.value)  # type: ignore[no-any-return]
            else:
                method = solver.method(self.known, node.func, self.scope)
                if method is not None:
                    self._zero_arguments(node, method, 1)
        return self.generic_visit(node)

    def _zero_arguments(self, node: ast.Call, target: FunctionType, first: int) -> None:
        known = self.solver.function(target)
        self._replace(
            node,
            known.names[first:],
            lambda name: self.solver.is_live_parameter(target, name),
            lambda name: known.kinds[name],
        )

    def _replace(
        self,
        node: ast.Call,
        names: list[str],
        is_live: Callable[[str], bool],
        kind_of_name: Callable[[str], Kind | None],
    ) -> None:
        node.args = [item if is_live(name) else dead(item, kind_of_name(name))
                     for name, item in zip(names, node.args, strict=False)]  # fmt: skip
        for item in node.keywords:
            if not is_live(str(item.arg)):
                item.value = dead(item.value, kind_of_name(str(item.arg)))


def dead(node: ast.expr, kind: Any) -> ast.expr:
    """Return a zero of ``kind`` where ``node`` stands."""
    return ast.copy_location(ast.Constant(DeadValue(kind)), node)  # type: ignore[arg-type]
