"""Truth: comparisons and their chains, ``in``, ``and``, ``or``, ``not``, and the choice between two values."""

import ast
from typing import Any

from fmus.compiler.constructs.arithmetic import unary
from fmus.compiler.source.diagnostics import CannotError
from fmus.compiler.source.types import BOOL, FLOAT, INT, Array, Scalar, describe
from fmus.compiler.target.aggregates import elements
from fmus.compiler.target.body import EXPRESSIONS, FunctionBody
from fmus.compiler.target.storage import hoist, materialise, put
from fmus.compiler.target.values import (
    AND,
    BIT_AND,
    BIT_OR,
    CHOICE,
    EQUAL,
    MAX_EXACT_INTEGER,
    OR,
    ORDER,
    SHIFT,
    UNARY,
    UNKNOWN,
    Place,
    Value,
    as_float,
    as_int,
    both,
    is_scalar,
    literal,
    place_of,
    truth,
    within,
)

SIGNS: dict[type[ast.cmpop], tuple[str, int]] = {
    ast.Lt: ("<", ORDER),
    ast.LtE: ("<=", ORDER),
    ast.Gt: (">", ORDER),
    ast.GtE: (">=", ORDER),
    ast.Eq: ("==", EQUAL),
    ast.NotEq: ("!=", EQUAL),
}


def condition(body: FunctionBody, node: ast.expr) -> Value:
    """Return the truth of an expression."""
    if isinstance(node, ast.BoolOp):
        return _all_or_any(body, node)
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        return negation(condition(body, node.operand))
    value = body.value(node)
    if not is_scalar(value.kind):
        what = f"the truth of {describe(value.kind)}"
        raise CannotError(node, what, "write the comparison that is meant")
    return truth(value)


def negation(value: Value) -> Value:
    """Return ``not value``."""
    if value.const is not UNKNOWN:
        return literal(not value.const)
    return Value(BOOL, f"!{within(value, UNARY)}", UNARY)


def unary_or_not(body: FunctionBody, node: ast.UnaryOp) -> Value:
    """Return ``not x`` and the unary operators of arithmetic."""
    return condition(body, node) if isinstance(node.op, ast.Not) else unary(body, node)


def comparison(body: FunctionBody, node: ast.Compare) -> Value:
    """Return ``a < b``, ``a < b < c``, ``a in (B, C)``."""
    left = body.value(node.left)
    terms = []
    for number, (sign, right_node) in enumerate(zip(node.ops, node.comparators, strict=True)):
        if isinstance(sign, ast.In | ast.NotIn):
            terms.append(_membership(body, node, left, right_node, isinstance(sign, ast.NotIn)))
            right = left
        else:
            right = body.value(right_node)
            if number + 1 < len(node.ops) and is_scalar(right.kind):
                right = materialise(body, right, "middle")
            terms.append(_comparison(body, node, left, sign, right))
        left = right
    if len(terms) == 1:
        return terms[0]
    if any(isinstance(sign, ast.In | ast.NotIn) for sign in node.ops):
        raise CannotError(node, "'in' in a chain of comparisons", "join two comparisons with 'and'")
    return Value(BOOL, " && ".join(within(term, BIT_AND) for term in terms), AND)


def _comparison(body: FunctionBody, node: ast.Compare, left: Value, sign: ast.cmpop, right: Value) -> Value:
    if isinstance(sign, ast.Is | ast.IsNot):
        word = "is" if isinstance(sign, ast.Is) else "is not"
        raise CannotError(node, f"'{word}'", f"write {'==' if word == 'is' else '!='}")
    for value in (left, right):
        if not is_scalar(value.kind):
            what = f"a comparison of {describe(value.kind)}"
            raise CannotError(node, what, "compare the fields or items that are meant")
    text, level = SIGNS[type(sign)]
    if (left.kind == FLOAT) != (right.kind == FLOAT):
        mixed = _int_with_float(body, left, text, right)
        if mixed is not None:
            return mixed
        left, right = as_float(left), as_float(right)
    elif left.kind != right.kind:
        left, right = as_int(left), as_int(right)
    return Value(BOOL, f"{within(left, SHIFT)} {text} {within(right, SHIFT)}", level)


def _int_with_float(body: FunctionBody, left: Value, sign: str, right: Value) -> Value | None:
    """Return the exact comparison of an integer that may be larger than a float holds; None if it is not."""
    whole = left if left.kind != FLOAT else right
    if whole.real or whole.lies_in(-MAX_EXACT_INTEGER, MAX_EXACT_INTEGER):
        return None
    helper = body.program.helper("compare_int_float")
    one, other = (left, right) if whole is left else (right, left)
    other = materialise(body, other, "real")
    turned = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}.get(sign, sign) if whole is right else sign
    exact = f"{helper}({one.text}, {other.text}) {turned} 0"
    if sign == "!=":
        return Value(BOOL, f"{within(other, SHIFT)} != {within(other, SHIFT)} || {exact}", OR)
    return Value(BOOL, f"{within(other, SHIFT)} == {within(other, SHIFT)} && {exact}", AND)


def _membership(body: FunctionBody, node: ast.Compare, left: Value, right_node: ast.expr, absent: bool) -> Value:
    """Return ``left in (A, B)`` of integers: Python compares floats by identity first, C cannot."""
    if isinstance(right_node, ast.List | ast.Set):
        right_node = ast.copy_location(ast.Tuple(right_node.elts, ast.Load()), right_node)
    right = body.value(right_node)
    if not isinstance(right.kind, Array) or right.kind.item not in (INT, BOOL) or left.kind not in (INT, BOOL):
        what = f"'in' of {describe(left.kind)} and {describe(right.kind)}"
        raise CannotError(node, what, "look for an int in a tuple of ints; compare others with ==")
    left = materialise(body, as_int(left), "sought")
    equal = [
        f"{within(left, SHIFT)} {'!=' if absent else '=='} {within(as_int(item), SHIFT)}"
        for item in elements(body, right)
    ]
    if len(equal) == 1:
        return Value(BOOL, equal[0], EQUAL)
    return Value(BOOL, (" && " if absent else " || ").join(equal), AND if absent else OR)


def arm(body: FunctionBody, node: ast.expr, as_truth: bool = False) -> tuple[list[Any], Value]:
    """Return the statements that an expression takes, which may not run, and its value."""
    with body.capture() as lines:
        value = condition(body, node) if as_truth else body.value(node)
    return lines, value


def _all_or_any(body: FunctionBody, node: ast.BoolOp) -> Value:
    """Return the truth of ``a and b`` or ``a or b``."""
    return _join(body, node, [arm(body, item, as_truth=True) for item in node.values])


def _join(body: FunctionBody, node: ast.BoolOp, arms: list[tuple[list[Any], Value]]) -> Value:
    """Return truth values joined."""
    if any(lines for lines, _ in arms[1:]):
        return _one_by_one(body, node, arms, "holds")
    is_and = isinstance(node.op, ast.And)
    level = AND if is_and else OR
    body.lines += arms[0][0]
    parts = [within(value, level if value.level == level else BIT_OR) for _, value in arms]
    return Value(BOOL, (" && " if is_and else " || ").join(parts), level)


def _one_by_one(body: FunctionBody, node: ast.BoolOp, arms: list[tuple[list[Any], Value]], name: str) -> Value:
    """Return the operand that decides, in a variable; those after it are not worked out."""
    kind = arms[0][1].kind
    assert isinstance(kind, Scalar)
    result = Value(kind, body.names.add(name))
    goes_on = truth(result) if isinstance(node.op, ast.And) else negation(truth(result))
    body.lines += arms[0][0]
    body.emit(f"{kind.c} {result.text} = {arms[0][1].text};")
    for lines, value in arms[1:]:
        body.emit(f"if ({goes_on.text}) {{")
        body.lines += lines
        body.emit(f"{result.text} = {value.text};")
        body.emit("}")
    return result


def boolean(body: FunctionBody, node: ast.BoolOp) -> Value:
    """Return ``a and b``, ``a or b`` as a value: of truth values, or the operand itself for numbers of one kind."""
    arms = [arm(body, item) for item in node.values]
    kind = arms[0][1].kind
    if all(value.kind == BOOL for _, value in arms):
        return _join(body, node, arms)
    word = "and" if isinstance(node.op, ast.And) else "or"
    if any(value.kind != kind for _, value in arms) or not isinstance(kind, Scalar):
        what = f"'{word}' between {' and '.join(dict.fromkeys(describe(value.kind) for _, value in arms))}"
        raise CannotError(node, what, "write a comparison for each, or a if c else b")
    return _one_by_one(body, node, arms, "chosen")


def choice(body: FunctionBody, node: ast.IfExp) -> Value:
    """Return ``a if c else b``."""
    test = condition(body, node.test)
    (first_lines, first), (other_lines, other) = arm(body, node.body), arm(body, node.orelse)
    if {first.kind, other.kind} == {INT, BOOL}:
        first, other = as_int(first), as_int(other)
    if first.kind != other.kind:
        what = f"{describe(first.kind)} or {describe(other.kind)}, by a condition"
        advice = "make both the same: 1.0, not 1" if FLOAT in (first.kind, other.kind) else "make both the same"
        raise CannotError(node, what, advice)
    if not first_lines and not other_lines:
        simple = _simple_choice(test, first, other)
        if simple is not None:
            return simple
    return _choice_by_if(body, test, (first_lines, first), (other_lines, other))


def _simple_choice(test: Value, first: Value, other: Value) -> Value | None:
    head = within(test, OR)
    if is_scalar(first.kind):
        text = f"{head} ? {within(first, OR)} : {within(other, CHOICE)}"
        low, high = both(min, first.least(), other.least()), both(max, first.most(), other.most())
        real = f"({head} ? {as_float(first).text} : {as_float(other).text})" if first.real and other.real else ""
        return Value(first.kind, text, CHOICE, narrow=first.narrow and other.narrow, low=low, high=high, real=real)
    if first.place and other.place:
        fixed = first.fixed and other.fixed
        if isinstance(first.kind, Array):
            text = f"({head} ? {first.text} : {other.text})"
            return Value(first.kind, text, place=True, fixed=fixed)
        ends = [place_of(item).address for item in (first, other)]
        return Value(first.kind, f"({head} ? {ends[0]} : {ends[1]})", place=True, pointer=True, fixed=fixed)
    return None


def _choice_by_if(
    body: FunctionBody, test: Value, first: tuple[list[Any], Value], other: tuple[list[Any], Value]
) -> Value:
    """Return a choice of which only the side that is meant is worked out."""

    def fill(place: Place) -> None:
        body.emit(f"if ({test.text}) {{")
        body.lines += first[0]
        put(body, place, first[1])
        body.emit("} else {")
        body.lines += other[0]
        put(body, place, other[1])
        body.emit("}")

    value = Value(first[1].kind, fill=fill)
    return hoist(body, value, "chosen") if is_scalar(value.kind) else value


EXPRESSIONS |= {ast.Compare: comparison, ast.BoolOp: boolean, ast.UnaryOp: unary_or_not, ast.IfExp: choice}
