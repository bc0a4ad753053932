"""Statements: assignments, if, while, return, match."""

import ast
from dataclasses import replace

from fmus.compiler.bindings import block, reads
from fmus.compiler.body import STATEMENTS, Body
from fmus.compiler.calls import replace_in_place
from fmus.compiler.conditions import condition
from fmus.compiler.kinds import INT, Array, Kind, Mixed, NoKindError, Open, Struct, described, kind_of
from fmus.compiler.refusals import CannotError
from fmus.compiler.values import UNKNOWN, Value, is_scalar, rvalue


def assign(body: Body, node: ast.Assign) -> None:
    """Write ``x = ...`` and ``a, b = ...``."""
    if len(node.targets) > 1:
        raise CannotError(node, "several names bound by one assignment", "write one line for each")
    target = node.targets[0]
    if isinstance(target, ast.Name):
        _assign_name(body, target, node.value, node)
    elif isinstance(target, ast.Tuple):
        _unpack(body, target, node.value, node)
    else:
        what = "a change of a list" if isinstance(target, ast.List) else f"a change of {ast.unparse(target)}"
        raise CannotError(node, what, "bind a new value: x = x._replace(field=...), or a new tuple")


def _assign_name(body: Body, target: ast.Name, source: ast.expr, node: ast.AST) -> None:
    variable = body.variable(target.id)
    if variable.kind is not None and _is_replace_of(source, target.id) and not variable.pointer:
        assert isinstance(source, ast.Call)
        if body.bindings.loads[target.id] > 1:
            replace_in_place(body, variable.c, source, variable.value(), target.id)
            return
    body.bind(target.id, body.value(source), node, source)


def _is_replace_of(node: ast.expr, name: str) -> bool:
    return (
        isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr == "_replace"
        and isinstance(node.func.value, ast.Name)
        and node.func.value.id == name
    )


def annotated(body: Body, node: ast.AnnAssign) -> None:
    """Write ``x: float = ...``; the type must be that of the value."""
    if node.value is None or not isinstance(node.target, ast.Name):
        raise CannotError(node, "a type without a value", "bind the variable where it gets its value")
    kind = _annotation(body, node.annotation)
    value = body.value(node.value)
    if isinstance(kind, Open) and isinstance(value.kind, Array) and value.kind.item == kind.item:
        kind = value.kind
    why = f"{node.target.id} is declared {described(kind)}"
    body.bind(node.target.id, body.coerced(value, kind, node, why), node, node.value)


def _annotation(body: Body, node: ast.expr) -> Kind:
    try:
        hint = eval(compile(ast.Expression(node), body.module.file, "eval"), body.function.__globals__)
        return kind_of(hint)
    except NoKindError as error:
        raise CannotError(node, error.what, error.advice) from None
    except Exception:
        raise CannotError(node, f"the type {ast.unparse(node)}", "name a type that the module knows") from None


def augmented(body: Body, node: ast.AugAssign) -> None:
    """Write ``x += ...``."""
    if not isinstance(node.target, ast.Name):
        what = f"a change of {ast.unparse(node.target)}"
        raise CannotError(node, what, "bind a new value: x = x._replace(field=...), or a new tuple")
    left = ast.copy_location(ast.Name(node.target.id, ast.Load()), node)
    whole = ast.copy_location(ast.BinOp(left, node.op, node.value), node)
    _assign_name(body, node.target, whole, node)


def _unpack(body: Body, target: ast.Tuple, source: ast.expr, node: ast.AST) -> None:
    """Write ``a, b = ...``: all of the right side is worked out before any name is bound."""
    value = body.value(source)
    names = [item.id for item in ast.walk(target) if isinstance(item, ast.Name)]
    if value.items is not None and any(reads(source, name) for name in names):
        value = _apart(body, value, target, source)
    elif value.items is None:
        value = body.settled(value, result_name(source))
    unpack(body, target, value, node)


def _apart(body: Body, value: Value, target: ast.Tuple, source: ast.expr) -> Value:
    """Return items of which those are worked out first that read a name bound before them."""
    assert value.items is not None
    nodes = source.elts if isinstance(source, ast.Tuple) else [source] * len(value.items)
    done: list[str] = []
    items = []
    for item, from_node, to in zip(value.items, nodes, target.elts, strict=False):
        if any(reads(from_node, name) for name in done):
            item = body.hoist(item, f"next_{to.id}" if isinstance(to, ast.Name) else "next")
        items.append(item)
        done += [name.id for name in ast.walk(to) if isinstance(name, ast.Name)]
    return replace(value, items=(*items, *value.items[len(items) :]), braces="")


def result_name(node: ast.AST) -> str:
    """Return a name for what an expression gives."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        return f"{node.func.id}_result"
    return "items"


def unpack(body: Body, target: ast.expr, value: Value, node: ast.AST) -> None:
    """Write that the names of ``target`` get the items of ``value``."""
    if isinstance(target, ast.Name):
        if target.id != "_" or body.bindings.loads["_"]:
            body.bind(target.id, value, node)
        return
    if isinstance(target, ast.Starred):
        raise CannotError(target, "a star on the left side", "name each item")
    if not isinstance(target, ast.Tuple | ast.List):
        raise CannotError(target, f"a change of {ast.unparse(target)}", "bind a new value to a name")
    items = items_of(body, value, target)
    if len(items) != len(target.elts):
        what = f"{len(target.elts)} names for {len(items)} items"
        raise CannotError(target, what, "write one name for each item")
    for part, item in zip(target.elts, items, strict=True):
        unpack(body, part, item, node)


def items_of(body: Body, value: Value, node: ast.AST) -> tuple[Value, ...]:
    """Return the items of a tuple or the fields of a NamedTuple."""
    from fmus.compiler.arithmetic import elements
    from fmus.compiler.tuples import field

    if value.items is not None:
        return value.items
    if isinstance(value.kind, Array):
        return elements(body, value)
    if isinstance(value.kind, Mixed):
        whole = body.settled(value, "items")
        from fmus.compiler.values import member

        return tuple(
            Value(kind, member(whole, f"item{at}"), place=True, fixed=whole.fixed)
            for at, kind in enumerate(value.kind.items)
        )
    if isinstance(value.kind, Struct):
        whole = body.settled(value, "items")
        return tuple(field(body, whole, name, node) for name in body.program.fields(value.kind.cls, node))
    raise CannotError(node, f"the items of {described(value.kind)}", "only tuples have items")


def expression(body: Body, node: ast.Expr) -> None:
    """Refuse an expression whose value goes nowhere; a string is a comment."""
    if isinstance(node.value, ast.Constant):
        if not isinstance(node.value.value, str):
            return
        body.emit(f"/* {' '.join(node.value.value.split()).replace('*/', '* /')} */")
        return
    if isinstance(node.value, ast.Call):
        body.value(node.value)  # says what is wrong with it, if anything is
    raise CannotError(
        node, f"the value of {ast.unparse(node.value)[:60]} is not used", "bind it to a name, or remove it"
    )


def nothing(body: Body, node: ast.Pass) -> None:
    """Write nothing."""


def branch(body: Body, node: ast.If) -> None:
    """Write if, elif and else."""
    test = condition(body, node.test)
    body.emit(f"if ({test.text}) {{")
    body.statements(node.body, block(body.frames[-1].path, node, "body"))
    _rest(body, node)
    body.emit("}")


def _rest(body: Body, node: ast.If) -> None:
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
            with body.frame(path):
                body.statements(only.body, block(path, only, "body"))
                _rest(body, only)
            return
    body.emit("} else {")
    body.statements(node.orelse, path)


def loop(body: Body, node: ast.While) -> None:
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


def leave(body: Body, node: ast.Break) -> None:
    """Write break."""
    body.emit("break;")


def next_round(body: Body, node: ast.Continue) -> None:
    """Write continue."""
    body.emit("continue;")


def give(body: Body, node: ast.Return) -> None:
    """Write return."""
    if node.value is None:
        raise CannotError(node, "a return without a value", "return a value of the annotated type")
    source = node.value
    if isinstance(source, ast.IfExp) and _by_branches(body, node, source):
        return
    copy = _own_copy(body, source)
    if copy is not None:
        variable_name, call = copy
        made = body.variable(variable_name)
        replace_in_place(body, made.c, call, made.value(), variable_name)
        value = made.value()
    else:
        value = body.value(source)
    _give_value(body, node, value)


def _own_copy(body: Body, node: ast.expr) -> tuple[str, ast.Call] | None:
    """Return the variable of which ``return x._replace(...)`` may change the fields: nobody sees it afterwards."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and isinstance(node.func.value, ast.Name):
        name = node.func.value.id
        if _is_replace_of(node, name) and name in body.bindings.local:
            variable = body.variable(name)
            if variable.kind is not None and not variable.pointer and not variable.fixed:
                return name, node
    return None


def _by_branches(body: Body, node: ast.Return, source: ast.IfExp) -> bool:
    """Write ``return a if c else b`` of large values as two returns."""
    with body.capture() as lines:
        value = body.value(source)
    if is_scalar(value.kind) and not lines:
        return False
    if not lines and value.fill is None:
        return False
    test = condition(body, source.test)
    body.emit(f"if ({test.text}) {{")
    for part in (source.body, source.orelse):
        give(body, ast.copy_location(ast.Return(part), part))
        if part is source.body:
            body.emit("}")
    return True


def _give_value(body: Body, node: ast.Return, value: Value) -> None:
    wanted = body.result
    name = body.function.__name__
    if isinstance(wanted, Open):
        if not isinstance(value.kind, Array) or value.kind.item != wanted.item:
            what = f"{described(value.kind)} where {name}() returns {described(wanted)}"
            raise CannotError(node, what, "return such a tuple")
        wanted = body.result = body.made.result = value.kind
    assert node.value is not None
    value = body.coerced(value, wanted, node.value, f"{name}() returns {described(wanted)}")
    if isinstance(wanted, Array):
        body.put(body.result_name, value)
        body.emit("return;")
    elif value.fill is not None and not value.braces:
        made = body.names.add("made")
        body.emit(f"{body.program.declared(wanted, made)};")
        body.put(made, value)
        body.emit(f"return {made};")
    elif value.braces:
        body.emit(f"return ({body.program.type_name(wanted)}){value.braces};")
    else:
        body.emit(f"return {rvalue(value)};")


def match(body: Body, node: ast.Match) -> None:
    """Write match over an integer: a switch, or ifs where a case has a condition or leaves a loop."""
    subject = body.value(node.subject)
    if subject.kind != INT:
        raise CannotError(node.subject, f"match of {described(subject.kind)}", "match an int, or write if and elif")
    subject = body.settled(subject, "subject")
    labels = [_labels(body, case.pattern) for case in node.cases]
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


def _match_by_ifs(body: Body, node: ast.Match, subject: Value, labels: list[list[str] | None]) -> None:
    head = "if"
    for case, names in zip(node.cases, labels, strict=True):
        tests = [] if names is None else [" || ".join(f"{subject.text} == {name}" for name in names)]
        if case.guard:
            with body.capture() as lines:
                guard = condition(body, case.guard)
            if lines:
                raise CannotError(case.guard, "a condition of a case that takes a calculation", "work it out before")
            tests.append(guard.text)
        text = " && ".join(f"({test})" for test in tests) if len(tests) > 1 else (tests or ["true"])[0]
        body.emit(f"{head} ({text}) {{")
        body.statements(case.body, block(body.frames[-1].path, case, "body"))
        head = "} else if"
    body.emit("}")


def _labels(body: Body, pattern: ast.pattern) -> list[str] | None:
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
    ast.AnnAssign: annotated,
    ast.AugAssign: augmented,
    ast.Expr: expression,
    ast.Pass: nothing,
    ast.If: branch,
    ast.While: loop,
    ast.Break: leave,
    ast.Continue: next_round,
    ast.Return: give,
    ast.Match: match,
}
