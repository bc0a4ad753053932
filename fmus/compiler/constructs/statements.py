"""Statements: assignments, if, while, return, match."""

import ast
from collections.abc import Callable

from fmus.compiler.constructs.columns import may_write, write
from fmus.compiler.constructs.conditions import condition
from fmus.compiler.constructs.items import change_item, item_change
from fmus.compiler.constructs.replacing import is_replace
from fmus.compiler.constructs.unpacking import items_of, unpack_assignment
from fmus.compiler.source.bindings import block
from fmus.compiler.source.diagnostics import CannotError
from fmus.compiler.source.types import (
    INT,
    NOTHING,
    Array,
    Kind,
    Mixed,
    NoKindError,
    Open,
    Struct,
    describe,
    is_store,
    kind_of,
)
from fmus.compiler.target.access import is_at, looks_at_place
from fmus.compiler.target.aggregates import coerce
from fmus.compiler.target.body import STATEMENTS, FunctionBody
from fmus.compiler.target.storage import materialise, put, put_whole, text_of
from fmus.compiler.target.values import UNKNOWN, Place, Value, is_scalar
from fmus.compiler.target.variables import bind, variable


def assign(body: FunctionBody, node: ast.Assign) -> None:
    """Write ``x = ...`` and ``a, b = ...``."""
    if len(node.targets) > 1:
        raise CannotError(node, "several names bound by one assignment", "write one line for each")
    target = node.targets[0]
    if isinstance(target, ast.Name):
        _assign_name(body, target, node.value, node)
    elif isinstance(target, ast.Tuple):
        may_write(body, node.value)
        unpack_assignment(body, target, node.value, node)
    elif isinstance(target, ast.Subscript):
        write(body, target, node.value, node)
    else:
        what = "a change of a list" if isinstance(target, ast.List) else f"a change of {ast.unparse(target)}"
        raise CannotError(node, what, "bind a new value: x = x._replace(field=...), or a new tuple")


def _assign_name(body: FunctionBody, target: ast.Name, source: ast.expr, node: ast.AST) -> None:
    item = item_change(source, target)
    if item is not None:
        known = variable(body, target.id)
        if known.kind is None or (known.parameter and known.fixed):
            raise CannotError(node, f"another item in the argument {target.id}", "bind it to a variable first")
        change_item(body, known, target.id, *item)
        return
    may_write(body, source, target.id)
    value = body.value(source)
    if value.kind == NOTHING:
        raise CannotError(node, f"{ast.unparse(source)} gives no value", "leave the name out")
    if is_store(value.kind):
        raise CannotError(node, f"{target.id} as a second name for a store", "use the name that it has")
    bind(body, target.id, value, node, source)


def assign_annotated(body: FunctionBody, node: ast.AnnAssign) -> None:
    """Write ``x: float = ...``; the type must be that of the value."""
    if node.value is None or not isinstance(node.target, ast.Name):
        raise CannotError(node, "a type without a value", "bind the variable where it gets its value")
    kind = _annotation(body, node.annotation)
    may_write(body, node.value, node.target.id)
    value = body.value(node.value)
    if isinstance(kind, Open) and isinstance(value.kind, Array) and value.kind.item == kind.item:
        kind = value.kind
    why = f"{node.target.id} is declared {describe(kind)}"
    bind(body, node.target.id, coerce(body, value, kind, node, why), node, node.value)


def _annotation(body: FunctionBody, node: ast.expr) -> Kind:
    try:
        hint = eval(compile(ast.Expression(node), body.module.file, "eval"), body.function.__globals__)
        return kind_of(hint)
    except NoKindError as error:
        raise CannotError(node, error.what, error.advice) from None
    except Exception:
        raise CannotError(node, f"the type {ast.unparse(node)}", "name a type that the module knows") from None


def assign_augmented(body: FunctionBody, node: ast.AugAssign) -> None:
    """Write ``x += ...``."""
    if isinstance(node.target, ast.Subscript):
        here = ast.copy_location(ast.Subscript(node.target.value, node.target.slice, ast.Load()), node)
        changed = ast.copy_location(ast.BinOp(here, node.op, node.value), node)
        write(body, node.target, changed, node)
        return
    if not isinstance(node.target, ast.Name):
        what = f"a change of {ast.unparse(node.target)}"
        raise CannotError(node, what, "bind a new value: x = x._replace(field=...), or a new tuple")
    left = ast.copy_location(ast.Name(node.target.id, ast.Load()), node)
    whole = ast.copy_location(ast.BinOp(left, node.op, node.value), node)
    _assign_name(body, node.target, whole, node)


def expression(body: FunctionBody, node: ast.Expr) -> None:
    """Refuse an expression whose value goes nowhere; a string is a comment."""
    if isinstance(node.value, ast.Constant):
        if not isinstance(node.value.value, str):
            return
        body.emit(f"/* {' '.join(node.value.value.split()).replace('*/', '* /')} */")
        return
    may_write(body, node.value)
    value = body.value(node.value)  # says what is wrong with it, if anything is
    if value.kind == NOTHING:
        body.emit(f"{value.text};")
        return
    raise CannotError(
        node, f"the value of {ast.unparse(node.value)[:60]} is not used", "bind it to a name, or remove it"
    )


def nothing(body: FunctionBody, node: ast.Pass) -> None:
    """Write nothing."""


def branch(body: FunctionBody, node: ast.If) -> None:
    """Write if, elif and else."""
    test = condition(body, node.test)
    body.emit(f"if ({test.text}) {{")
    body.statements(node.body, block(body.frames[-1].path, node, "body"))
    _rest(body, node)
    body.emit("}")


def _rest(body: FunctionBody, node: ast.If) -> None:
    """Write what follows the first branch; an ``elif`` stays one where its condition takes no statements."""
    if not node.orelse:
        return
    path = block(body.frames[-1].path, node, "else")
    only = node.orelse[0]
    if len(node.orelse) == 1 and isinstance(only, ast.If) and not body.comments_between(node, only):
        with body.frame(path), body.capture() as lines:
            body.begin_statement()
            test = condition(body, only.test)
        if not any(lines):
            body.emit(f"}} else if ({test.text}) {{")
            room = body.frames[-1].slot  # an elif has no block of its own: what it shares stands before the first if
            with body.frame(path):
                body.frames[-1].slot = room
                body.statements(only.body, block(path, only, "body"))
                _rest(body, only)
            return
    body.emit("} else {")
    body.statements(node.orelse, path)


def loop(body: FunctionBody, node: ast.While) -> None:
    """Write while."""
    if node.orelse:
        raise CannotError(node.orelse[0], "else after a loop", "set a bool in the loop and test it after")
    with body.capture() as lines:
        test = condition(body, node.test)
    if test.const is not UNKNOWN and test.const:
        advice = "write for _ in range(N): with the largest number of rounds, and break"
        raise CannotError(node, "a loop without an end", advice)
    inside = block(body.frames[-1].path, node, "body")
    if lines:
        body.emit("for (;;) {")
        body.lines += lines
        body.emit(f"if (!({test.text})) {{")
        body.emit("break;")
        body.emit("}")
    else:
        body.emit(f"while ({test.text}) {{")
    body.statements(node.body, inside)
    body.emit("}")


def leave(body: FunctionBody, node: ast.Break) -> None:
    """Write break."""
    body.emit("break;")


def next_round(body: FunctionBody, node: ast.Continue) -> None:
    """Write continue."""
    body.emit("continue;")


def give(body: FunctionBody, node: ast.Return) -> None:
    """Write return."""
    if node.value is None and body.result == NOTHING:
        body.emit("return;")
        return
    if node.value is None:
        raise CannotError(node, "a return without a value", "return a value of the annotated type")
    if isinstance(node.value, ast.IfExp) and _by_branches(body, node.value):
        return
    may_write(body, node.value)
    value = body.value(node.value)
    name = _own_copy(body, node.value)
    if name and body.changed is None:
        known = variable(body, name)
        put(body, known.place, value)
        value = known.value()
    _give_value(body, node.value, value)


def _own_copy(body: FunctionBody, node: ast.expr) -> str:
    """Return the variable of which ``return x._replace(...)`` may change the fields: nobody sees it afterwards."""
    if is_replace(node) and isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
        base = node.func.value
        if isinstance(base, ast.Name) and base.id in body.bindings.local:
            known = variable(body, base.id)
            if isinstance(known.kind, Struct) and not known.fixed:
                return base.id
    return ""


def _by_branches(body: FunctionBody, source: ast.IfExp) -> bool:
    """Write ``return a if c else b`` of what is no number as two returns."""
    with body.capture() as lines:
        value = body.value(source)
    if is_scalar(value.kind) and not lines:
        return False
    test = condition(body, source.test)
    body.emit(f"if ({test.text}) {{")
    give(body, ast.copy_location(ast.Return(source.body), source.body))
    body.emit("}")
    give(body, ast.copy_location(ast.Return(source.orelse), source.orelse))
    return True


def _give_value(body: FunctionBody, node: ast.expr, value: Value) -> None:
    """Write the return of ``value``: as the function's value, or to where its pointers say."""
    wanted = body.result
    name = body.function.__name__
    if isinstance(wanted, Open):
        if not isinstance(value.kind, Array) or value.kind.item != wanted.item:
            what = f"{describe(value.kind)} where {name}() returns {describe(wanted)}"
            raise CannotError(node, what, "return such a tuple")
        wanted = body.result = body.made.result = value.kind
    value = coerce(body, value, wanted, node, f"{name}() returns {describe(wanted)}")
    if not body.outs:
        body.emit(f"return {text_of(body, value, 'made')};")
        return
    if isinstance(wanted, Mixed) and value.fill_items is not None:
        _give_items(body, value, value.fill_items)
    else:
        items = items_of(body, value, node) if isinstance(wanted, Mixed) else (value,)
        pairs = list(zip(body.outs, items, strict=True))
        for place, item in pairs:
            if place != body.changed:
                put(body, place, item)
        for place, item in pairs:
            if place == body.changed:  # last: the others may be made of it
                put_whole(body, place, item)
    body.emit("return;")


def _give_items(body: FunctionBody, value: Value, fill_items: Callable[[list[Place]], None]) -> None:
    """Write a call whose results are this function's, each to where it goes."""
    changed = body.changed
    if changed is None or (value.base is not None and is_at(body, value.base, changed)):
        fill_items(body.outs)
        return
    assert isinstance(value.kind, Mixed)
    if not any(looks_at_place(body, word, changed) for word in value.held or ()):
        fill_items(body.outs)
        return
    made = Place(body.names.add("next"))
    body.emit(f"{body.program.declaration(value.kind.items[body.outs.index(changed)], made.text)};")
    fill_items([made if place == changed else place for place in body.outs])
    body.emit(f"{changed.whole} = {made.text};")


def match(body: FunctionBody, node: ast.Match) -> None:
    """Write match over an integer: a switch, or ifs where a case has a condition or leaves a loop."""
    subject = body.value(node.subject)
    if subject.kind != INT:
        raise CannotError(node.subject, f"match of {describe(subject.kind)}", "match an int, or write if and elif")
    subject = materialise(body, subject, "subject")
    labels = [_labels(body, case.pattern) for case in node.cases]
    _refuse_twice(body, node)
    leaves = any(isinstance(item, ast.Break) for case in node.cases for part in case.body for item in ast.walk(part))
    if leaves or any(case.guard for case in node.cases):
        _match_by_ifs(body, node, subject, labels)
        return
    body.emit(f"switch ({subject.text}) {{")
    for case, names in zip(node.cases, labels, strict=True):
        for name in names or []:
            body.emit(f"case {name}:")
        if names is None:
            body.emit("default:")
        body.emit("{")
        body.statements(case.body, block(body.frames[-1].path, case, "body"))
        if not isinstance(case.body[-1], ast.Return | ast.Continue):
            body.emit("break;")
        body.emit("}")
    if None not in labels:
        body.emit("default:")
        body.emit("break;")
    body.emit("}")


def _refuse_twice(body: FunctionBody, node: ast.Match) -> None:
    """Refuse a case whose value an earlier one has: it is never reached."""
    seen: set[int] = set()
    for case in node.cases:
        patterns = case.pattern.patterns if isinstance(case.pattern, ast.MatchOr) else [case.pattern]
        for pattern in patterns:
            if isinstance(pattern, ast.MatchValue):
                value = int(body.value(pattern.value).const)
                if value in seen:
                    raise CannotError(pattern, f"the case {ast.unparse(pattern)} for the second time", "remove it")
                seen |= {value} if case.guard is None else set()


def _match_by_ifs(body: FunctionBody, node: ast.Match, subject: Value, labels: list[list[str] | None]) -> None:
    """Write match as ifs, one inside the else of the one before where its condition takes statements."""
    depth = 0
    for number, (case, names) in enumerate(zip(node.cases, labels, strict=True)):
        tests = [] if names is None else [" || ".join(f"{subject.text} == {name}" for name in names)]
        lines: list[object] = []
        if case.guard:
            with body.capture() as lines:
                tests.append(condition(body, case.guard).text)
        text = " && ".join(f"({test})" for test in tests) if len(tests) > 1 else (tests or ["true"])[0]
        if lines:
            depth += 1
            body.lines += ["} else {"] if number else ["{"]
            body.lines += [*lines, f"if ({text}) {{"]
        else:
            body.emit(f"{'} else if' if number else 'if'} ({text}) {{")
        body.statements(case.body, block(body.frames[-1].path, case, "body"))
    body.lines += ["}"] * (depth + 1)


def _labels(body: FunctionBody, pattern: ast.pattern) -> list[str] | None:
    """Return the constants of a case; None for the one of all others."""
    if isinstance(pattern, ast.MatchValue):
        value = body.value(pattern.value)
        if value.kind != INT or value.const is UNKNOWN:
            raise CannotError(pattern, f"the case {ast.unparse(pattern)}", "write an enum member or an integer")
        return [value.text if value.narrow else str(value.const)]
    if isinstance(pattern, ast.MatchOr):
        parts = [_labels(body, item) for item in pattern.patterns]
        return None if None in parts else [name for part in parts for name in part or []]
    if isinstance(pattern, ast.MatchAs) and pattern.pattern is None and pattern.name is None:
        return None
    raise CannotError(pattern, f"the case {ast.unparse(pattern)}", "write enum members, integers or _")


STATEMENTS |= {
    ast.Assign: assign,
    ast.AnnAssign: assign_annotated,
    ast.AugAssign: assign_augmented,
    ast.Expr: expression,
    ast.Pass: nothing,
    ast.If: branch,
    ast.While: loop,
    ast.Break: leave,
    ast.Continue: next_round,
    ast.Return: give,
    ast.Match: match,
}
