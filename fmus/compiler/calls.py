"""Calls: functions of the model, NamedTuples, ``_replace``, and what is let in of Python's own and of math."""

import ast
import math
from types import FunctionType
from typing import Any

from fmus.compiler.bindings import reads
from fmus.compiler.body import EXPRESSIONS, Body, struct_of, written_out
from fmus.compiler.builtin import BUILTINS, math_call
from fmus.compiler.kinds import UNSET, Array, Kind, Open, Struct, described, is_named_tuple
from fmus.compiler.names import member_name
from fmus.compiler.refusals import AlreadySaidError, CannotError
from fmus.compiler.values import Value, rvalue


def call(body: Body, node: ast.Call) -> Value:
    """Return the result of a call."""
    if any(isinstance(item, ast.Starred) for item in node.args) or any(item.arg is None for item in node.keywords):
        raise CannotError(node, "a call with * or **", "write the arguments out")
    found = body.static(node.func)
    if found is None:
        return _method(body, node)
    target = found.value
    word = str(getattr(target, "__name__", ""))
    if getattr(math, word, None) is target:
        return math_call(body, node, word)
    if found.module == "builtins" or target in BUILTINS:
        handler = BUILTINS.get(target)
        if handler is None:
            raise CannotError(node, f"{found.name}()", ADVICE.get(found.name, "it has no place in model code"))
        return handler(body, node)
    if is_named_tuple(target):
        return construct(body, node, target)
    if isinstance(target, FunctionType):
        return invoke(body, node, target, node.args)
    name = ast.unparse(node.func)
    module = found.module.split(".")[0]
    if isinstance(target, type):
        raise CannotError(node, f"a call of {name}", "use the int itself; only NamedTuples are made in model code")
    raise CannotError(node, f"{name}() of {module}", f"use math and functions of the model; {module} has no C")


ADVICE = {
    "print": "keep output outside of the model: put what is of interest into the outputs",
    "isinstance": "annotate the type: it is known",
    "list": "write a tuple of fixed length",
    "sorted": "sort outside of the model, or compare the items one by one",
    "reversed": "write range(n - 1, -1, -1)",
    "map": "write tuple(f(x) for x in xs)",
    "filter": "write a loop with if",
    "dict": "write a NamedTuple",
    "set": "write x in (A, B)",
    "str": "text is made outside of the model",
    "pow": "write x * x, math.sqrt(x) or math.exp(y * math.log(x))",
    "divmod": "write a // b and a % b",
    "input": "give the model an input",
    "open": "read files outside of the model, and give the model parameters",
    "getattr": "name the field",
    "hash": "it differs from run to run",
    "round": "write math.floor(x + 0.5), which rounds halves up",
    "enumerate": "use it as what a for loop runs over",
    "zip": "use it as what a for loop runs over",
    "range": "use it as what a for loop runs over",
    "complex": "write the real and the imaginary part",
    "super": "NamedTuples of a model have no parents",
}


# ---- functions of the model


def invoke(
    body: Body, node: ast.Call, function: FunctionType, nodes: list[ast.expr], own: Value | None = None
) -> Value:
    """Return the result of a function of the model; ``own`` is what a method belongs to."""
    from fmus.compiler.functions import instance_of, signature

    known = signature(body.program, function, node)
    given = _arguments(node, function.__name__, list(known.kinds), nodes, own is not None)
    values: dict[str, Value] = {}
    sources: list[ast.expr] = []
    for place, (name, kind) in enumerate(known.kinds.items()):
        if place == 0 and own is not None:
            value = own
        elif name in given:
            value = body.value(given[name])
            sources.append(given[name])
        elif known.defaults.get(name, UNSET) is not UNSET:
            value = written_out(body, known.defaults[name], kind)
        else:
            advice = f"{function.__name__} takes {', '.join(known.kinds)}"
            raise CannotError(node, f"{function.__name__}() without its argument {name}", advice)
        values[name] = argument(body, value, kind, given.get(name, node), f"{function.__name__}() takes")
    made = instance_of(body.program, function, tuple(value.kind for value in values.values()), node)
    texts = []
    for parameter, value in zip(made.parameters, values.values(), strict=True):
        if parameter.by_pointer:
            texts.append(body.address(value, parameter.name))
        elif value.fill is not None and not value.braces:
            texts.append(body.hoist(value, parameter.name).text)
        elif value.braces and not value.text:
            texts.append(f"({body.program.type_name(value.kind)}){value.braces}")
        else:
            texts.append(rvalue(value))
    return _result(body, made, texts)


def _result(body: Body, made: Any, texts: list[str]) -> Value:
    kind = made.result
    if kind is None:
        raise AlreadySaidError
    if isinstance(kind, Array):

        def fill(place: str) -> None:
            body.emit(f"{made.name}({', '.join([*texts, place])});")

        return Value(kind, fill=fill)
    return Value(kind, f"{made.name}({', '.join(texts)})")


def argument(body: Body, value: Value, kind: Kind, node: ast.AST, why: str) -> Value:
    """Return an argument as the kind that is expected; a tuple of any length for ``tuple[X, ...]``."""
    if isinstance(kind, Open):
        if not isinstance(value.kind, Array) or value.kind.item != kind.item:
            raise CannotError(node, f"{described(value.kind)} where {why} {described(kind)}", "make it such a tuple")
        return value
    return body.coerced(value, kind, node, f"{why} {described(kind)}")


def _arguments(
    node: ast.Call, name: str, names: list[str], nodes: list[ast.expr], has_own: bool = False
) -> dict[str, ast.expr]:
    """Return the argument of each name."""
    places = names[1:] if has_own else names
    if len(nodes) > len(places):
        what = f"{name}() with {len(nodes)} arguments"
        raise CannotError(node, what, f"it takes {len(places)}: {', '.join(places)}")
    found = dict(zip(places, nodes, strict=False))
    for keyword in node.keywords:
        word = str(keyword.arg)
        if word not in places:
            raise CannotError(node, f"{name}() has no argument {word}", f"it takes {', '.join(places)}")
        if word in found:
            raise CannotError(node, f"{name}() with two values for {word}", "write one")
        found[word] = keyword.value
    return found


# ---- NamedTuples


def construct(body: Body, node: ast.Call, cls: Any) -> Value:
    """Return ``Cls(...)``; fields left out have their defaults."""
    kinds = body.program.fields(cls, node)
    given = _arguments(node, cls.__name__, list(kinds), node.args)
    kind = Struct(cls)
    body.program.need(kind)
    if not given and all(name in cls._field_defaults for name in kinds):
        return Value(kind, body.program.default(cls), place=True, fixed=True, const=cls())
    fields: dict[str, Value] = {}
    for name, wanted in kinds.items():
        if name in given:
            why = f"{cls.__name__}.{name} is {described(wanted)}"
            fields[name] = body.coerced(body.value(given[name]), wanted, given[name], why)
        elif name in cls._field_defaults:
            fields[name] = written_out(body, cls._field_defaults[name], wanted)
        else:
            raise CannotError(node, f"{cls.__name__}() without its field {name}", f"it has {', '.join(kinds)}")
    return struct_of(body, kind, fields)


def _method(body: Body, node: ast.Call) -> Value:
    """Return ``x._replace(...)`` or a method of a NamedTuple."""
    if not isinstance(node.func, ast.Attribute):
        raise CannotError(node, f"a call of {ast.unparse(node.func)}", "call a function of the model by its name")
    base = body.static(node.func.value)
    if base is not None and not isinstance(base.value, tuple):
        name = ast.unparse(node.func)
        if getattr(base.value, "__name__", "") == "math":
            raise CannotError(node, f"{name}() is not in math", "see which functions math has")
        raise CannotError(node, f"{name}() is not known", "call a function of the model by its name")
    value = body.value(node.func.value)
    if not isinstance(value.kind, Struct):
        what = f".{node.func.attr}() of {described(value.kind)}"
        raise CannotError(node, what, "write a function of the value, or a loop over the items")
    if node.func.attr == "_replace":
        return replaced(body, node, value)
    function = vars(value.kind.cls).get(node.func.attr)
    if not isinstance(function, FunctionType) or node.func.attr.startswith("_"):
        what = f"{value.kind.cls.__name__} has no method {node.func.attr}"
        raise CannotError(node, what, f"it has the fields {', '.join(value.kind.cls._fields)}")
    return invoke(body, node, function, node.args, value)


def call_property(body: Body, value: Value, name: str, node: ast.AST) -> Value:
    """Return a property of a NamedTuple."""
    assert isinstance(value.kind, Struct)
    found = vars(value.kind.cls).get(name)
    if not isinstance(found, property) or not isinstance(found.fget, FunctionType):
        what = f"{value.kind.cls.__name__} has no field {name}"
        raise CannotError(node, what, f"it has {', '.join(value.kind.cls._fields)}")
    empty = ast.copy_location(ast.Call(ast.Name(name, ast.Load()), [], []), node)
    return invoke(body, empty, found.fget, [], value)


def replaced(body: Body, node: ast.Call, value: Value) -> Value:
    """Return ``x._replace(a=...)`` as a copy with other fields."""
    changes = changed_fields(body, node, value)
    made = {name: body.coerced(body.value(item), kind, item, f"it is {described(kind)}")
            for name, (kind, item) in changes.items()}  # fmt: skip

    def fill(place: str) -> None:
        body.put(place, value)
        for name, item in made.items():
            body.put(f"{place}.{member_name(name)}", item)

    return Value(value.kind, fill=fill)


def changed_fields(body: Body, node: ast.Call, value: Value) -> dict[str, tuple[Kind, ast.expr]]:
    """Return kind and new value of each field that ``_replace`` changes."""
    assert isinstance(value.kind, Struct)
    if node.args:
        raise CannotError(node, "_replace() with a value that has no name", "write _replace(field=value)")
    kinds = body.program.fields(value.kind.cls, node)
    found = {}
    for keyword in node.keywords:
        if keyword.arg not in kinds:
            what = f"{value.kind.cls.__name__} has no field {keyword.arg}"
            raise CannotError(keyword.value, what, f"it has {', '.join(kinds)}")
        found[str(keyword.arg)] = (kinds[str(keyword.arg)], keyword.value)
    return found


def replace_in_place(body: Body, place: str, node: ast.Call, value: Value, name: str) -> None:
    """Write ``x = x._replace(...)`` without a copy; fields whose new values need old ones are worked out first."""
    changes = changed_fields(body, node, value)
    early = _early(changes, name, [keyword.value for keyword in node.keywords])
    ready: dict[str, Value] = {}
    for field, (kind, item) in changes.items():
        if field in early:
            new = body.coerced(body.value(item), kind, item, f"it is {described(kind)}")
            ready[field] = body.hoist(new, f"new_{field}")
    for field, (kind, item) in changes.items():
        target = f"{place}.{member_name(field)}"
        if field in ready:
            body.put(target, ready[field])
            continue
        inner = _inner_replace(body, item, target)
        if inner is not None and isinstance(item, ast.Call):
            replace_in_place(body, target, item, inner, name)
            continue
        new = body.coerced(body.value(item), kind, item, f"it is {described(kind)}")
        if new.fill is not None and not (new.braces and not isinstance(kind, Array)) and reads(item, name):
            new = body.hoist(new, f"new_{field}")
        body.put(target, new)


def _inner_replace(body: Body, node: ast.expr, target: str) -> Value | None:
    """Return what ``node`` replaces fields of, if that is the place it is stored to."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "_replace":
        if isinstance(node.func.value, ast.Name | ast.Attribute) and body.static(node.func.value) is None:
            value = body.value(node.func.value)
            if isinstance(value.kind, Struct) and value.text == target and not value.pointer:
                return value
    return None


def _early(changes: dict[str, tuple[Kind, ast.expr]], name: str, nodes: list[ast.expr]) -> set[str]:
    """Return the fields whose new values read what an assignment before theirs has changed."""
    done: list[str] = []
    found = set()
    for field, (_, item) in changes.items():
        seen = fields_read(item, name)
        if any(other in seen or "*" in seen for other in done):
            found.add(field)
        done.append(field)
    return found


def fields_read(node: ast.AST, name: str) -> set[str]:
    """Return the fields of ``name`` that an expression reads; '*' if it reads all."""
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == name:
        return {node.attr} if node.attr != "_replace" else {"*"}
    if isinstance(node, ast.Name) and node.id == name:
        return {"*"}
    return {field for child in ast.iter_child_nodes(node) for field in fields_read(child, name)}


EXPRESSIONS[ast.Call] = call
