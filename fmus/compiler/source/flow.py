"""Whether every variable is bound before it is used, whether every way through a function ends in a return."""

import ast
from collections.abc import Callable, Iterable

from fmus.compiler.source.bindings import names_in
from fmus.compiler.source.diagnostics import CannotError

State = frozenset[str] | None
"""The names that are certainly bound; None: this place is never reached."""


class DefiniteAssignment:
    """One walk through a function in the order it runs; ``faults`` holds what is wrong."""

    def __init__(
        self,
        function: ast.FunctionDef,
        parameters: Iterable[str],
        local: set[str],
        number: Callable[[ast.expr], int | None],
        may_end: bool = False,
    ) -> None:
        self.local, self.number = local, number
        self.faults: list[CannotError] = []
        self.breaks: list[list[State]] = []
        self.continues: list[list[State]] = []
        self.said: set[str] = set()
        self.unsure = False
        end = self.body(function.body, frozenset(parameters))
        if end is not None and not self.unsure and not may_end:
            advice = "end every way through the function in a return"
            self.faults.append(CannotError(function.body[-1], f"{function.name} may end without a return", advice))

    def body(self, nodes: list[ast.stmt], state: State) -> State:
        """Return the state after ``nodes``."""
        for node in nodes:
            if state is None:
                self.faults.append(CannotError(node, "this statement is never reached", "remove it"))
                return None
            state = self.statement(node, state)
        return state

    def statement(self, node: ast.stmt, state: frozenset[str]) -> State:
        """Return the state after one statement."""
        if isinstance(node, ast.If):
            self.use(node.test, state)
            return join_paths(self.body(node.body, state), self.body(node.orelse, state))
        if isinstance(node, ast.For):
            return self.for_loop(node, state)
        if isinstance(node, ast.While):
            return self.while_loop(node, state)
        if isinstance(node, ast.Match):
            return self.match(node, state)
        if isinstance(node, ast.Return):
            self.use(node, state)
            return None
        if isinstance(node, ast.Break | ast.Continue):
            (self.breaks if isinstance(node, ast.Break) else self.continues)[-1].append(state)
            return None
        if isinstance(node, ast.Try | ast.With | ast.TryStar):
            self.unsure = True  # refused anyway
        else:
            self.use(node, state)
        return state | {name.id for name in names_in(node) if isinstance(name.ctx, ast.Store)}

    def use(self, node: ast.AST, state: frozenset[str]) -> None:
        """Note what ``node`` reads without having been bound."""
        read = [name for name in names_in(node) if isinstance(name.ctx, ast.Load)]
        if isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name):
            read.append(node.target)
        for name in read:
            if name.id in self.local and name.id not in state and name.id not in self.said:
                self.said.add(name.id)
                advice = "give it a value before, on every way that leads here"
                self.faults.append(CannotError(name, f"{name.id} may not be bound here", advice))

    def for_loop(self, node: ast.For, state: frozenset[str]) -> State:
        """Return the state after a for loop; one that certainly runs binds what its body binds."""
        self.use(node.iter, state)
        inside = state | {name.id for name in names_in(node.target)}
        ends, end = self.loop(node.body, inside)
        if certainly_runs(node.iter, self.number):
            return _join_all([end, *ends]) if ends else end
        return _join_all([state, end, *ends])

    def while_loop(self, node: ast.While, state: frozenset[str]) -> State:
        """Return the state after a while loop, whose body may not run."""
        self.use(node.test, state)
        ends, _ = self.loop(node.body, state)
        return _join_all([state, *ends])

    def loop(self, body: list[ast.stmt], state: frozenset[str]) -> tuple[list[State], State]:
        """Return the states at breaks, and at the end of a round."""
        self.breaks.append([])
        self.continues.append([])
        end = self.body(body, state)
        return self.breaks.pop(), _join_all([end, *self.continues.pop()])

    def match(self, node: ast.Match, state: frozenset[str]) -> State:
        """Return the state after a match."""
        self.use(node.subject, state)
        ends: list[State] = []
        whole = False
        for case in node.cases:
            if case.guard:
                self.use(case.guard, state)
            ends.append(self.body(case.body, state))
            wild = isinstance(case.pattern, ast.MatchAs) and case.pattern.pattern is None
            whole = whole or (wild and case.guard is None)
        return _join_all(ends if whole else [*ends, state])


def join_paths(a: State, b: State) -> State:
    """Return what is bound whichever way was taken."""
    if a is None or b is None:
        return b if a is None else a
    return a & b


def _join_all(states: Iterable[State]) -> State:
    result: State = None
    for state in states:
        result = join_paths(result, state)
    return result


def certainly_runs(node: ast.expr, number: Callable[[ast.expr], int | None]) -> bool:
    """Return whether a loop runs at least once: over any tuple, none of which is empty, and over some ranges."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "range":
        numbers = [number(item) for item in node.args]
        known = [item for item in numbers if item is not None]
        return 0 < len(known) == len(numbers) < 4 and known[2:] != [0] and len(range(*known)) > 0
    return True
