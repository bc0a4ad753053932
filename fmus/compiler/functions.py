"""Functions: what they take and give, and one C function for each combination of tuple lengths."""

import ast
import sys
import typing
from dataclasses import dataclass, field
from types import FunctionType
from typing import Any, NamedTuple

from fmus.compiler.body import Body, Variable
from fmus.compiler.flow import Flow
from fmus.compiler.kinds import Array, Kind, NoKindError, Open, Struct, kind_of
from fmus.compiler.program import Program
from fmus.compiler.refusals import AlreadySaidError, CannotError
from fmus.compiler.values import is_scalar


class Signature(NamedTuple):
    """What a function takes and gives, by its annotations."""

    kinds: dict[str, Kind]
    defaults: dict[str, Any]
    result: Kind


@dataclass
class Parameter:
    """An argument of a C function."""

    name: str
    kind: Kind
    by_pointer: bool
    text: str = ""


@dataclass
class Instance:
    """A C function: a Python function for arguments of certain lengths."""

    name: str
    function: FunctionType
    node: ast.FunctionDef
    parameters: list[Parameter]
    result: Kind | None
    lines: list[Any] = field(default_factory=list)
    calls: list["Instance"] = field(default_factory=list)
    head: str = ""
    done: bool = False


def signature(program: Program, function: FunctionType, node: ast.AST) -> Signature:
    """Return the signature of ``function``; what is wrong with it is noted once."""
    if function not in program.signatures:
        program.signatures[function] = _read_signature(program, function, node)
    found: Signature | None = program.signatures[function]
    if found is None:
        raise AlreadySaidError
    return found


def _read_signature(program: Program, function: FunctionType, call: ast.AST) -> Signature | None:
    node = program.library.function(function)
    module = function.__module__
    before = len(program.refusals)

    def refuse(place: ast.AST, what: str, advice: str) -> None:
        program.refuse(module, place, what, advice)

    if node.decorator_list and not _is_property(node):
        refuse(node.decorator_list[0], f"the decorator of {node.name}", "write the function without it")
    arguments = node.args
    if arguments.vararg or arguments.kwarg:
        refuse(node, f"{node.name}() with * or ** arguments", "name each argument, or take a tuple")
    try:
        hints = typing.get_type_hints(function, include_extras=True)
    except Exception as error:
        refuse(node, f"annotations of {node.name} that cannot be read ({error})", "name types that the module knows")
        return None
    kinds: dict[str, Kind] = {}
    for item in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs):
        if item.arg not in hints and item.arg == "self" and "." in function.__qualname__:
            kinds["self"] = Struct(_owner(function))
        elif item.arg not in hints:
            refuse(item, f"{node.name}() takes {item.arg} without a type", f"write {item.arg}: float, or what it is")
        else:
            _read_kind(refuse, item, f"{node.name}() takes {item.arg}", hints[item.arg], kinds, item.arg)
    if "return" not in hints or node.returns is None:
        refuse(node, f"{node.name}() has no result type", "write -> float, or what it returns, before the colon")
    else:
        _read_kind(refuse, node.returns, f"{node.name}() returns", hints["return"], kinds, "return")
    defaults = _defaults(program, function, node, kinds)
    if len(program.refusals) > before:
        return None
    return Signature({name: kind for name, kind in kinds.items() if name != "return"}, defaults, kinds["return"])


def _read_kind(refuse: Any, place: ast.AST, what: str, hint: Any, kinds: dict[str, Kind], name: str) -> None:
    try:
        kinds[name] = kind_of(hint)
    except NoKindError as error:
        refuse(place, f"{what}: {error.what}", error.advice)


def _defaults(
    program: Program, function: FunctionType, node: ast.FunctionDef, kinds: dict[str, Kind]
) -> dict[str, Any]:
    code = function.__code__
    names = code.co_varnames[: code.co_argcount]
    values = function.__defaults__ or ()
    found = dict(zip(names[len(names) - len(values) :], values, strict=True)) | (function.__kwdefaults__ or {})
    for name, value in found.items():
        if name in kinds:
            try:
                program.check_value(kinds[name], value)
            except NoKindError as error:
                what = f"{node.name}() takes {name}, by default {error.what}"
                program.refuse(function.__module__, node, what, error.advice)
    return found


def _owner(function: FunctionType) -> Any:
    return getattr(sys.modules[function.__module__], function.__qualname__.split(".")[0])


def _is_property(node: ast.FunctionDef) -> bool:
    return [ast.unparse(item) for item in node.decorator_list] == ["property"]


def instance_of(program: Program, function: FunctionType, kinds: tuple[Kind, ...], node: ast.AST | None) -> Instance:
    """Return the C function for arguments of these kinds; it is translated now if it is new."""
    known = signature(program, function, node or ast.Pass())
    if function in program.stack:
        advice = "write a loop with a fixed number of rounds"
        raise CannotError(node, f"recursion: {function.__name__}() calls itself", advice)
    made: Instance | None = program.instances.get((function, kinds))
    if made is None:
        tree = program.library.function(function)
        name = program.functions[function]
        if any(other is function for other, _ in program.instances):
            lengths = [str(kind.length) for kind, asked in zip(kinds, known.kinds.values(), strict=True)
                       if isinstance(kind, Array) and isinstance(asked, Open)]  # fmt: skip
            name = program.names.add("_".join([name, *lengths]), function.__module__)
        result = None if isinstance(known.result, Open) else known.result
        made = Instance(name, function, tree, [], result)
        program.instances[function, kinds] = made
        program.stack.append(function)
        try:
            translate(program, made, dict(zip(known.kinds, kinds, strict=True)), known.result)
        finally:
            program.stack.pop()
    if program.caller is not None and made not in program.caller.calls:
        program.caller.calls.append(made)
    return made


def translate(program: Program, made: Instance, kinds: dict[str, Kind], result: Kind) -> None:
    """Write the C function ``made``."""
    caller, program.caller = program.caller, made
    body = Body(program, made.function, made.node)
    body.result, body.made = result, made
    for fault in Flow(made.node, kinds, body.bindings.local).faults:
        body.refuse(fault, made.node)
    with body.frame(()):
        body.begin_statement()
        made.parameters = [_parameter(body, name, kind) for name, kind in kinds.items()]
        body.result_name = body.names.add("result") if isinstance(result, Array | Open) else ""
        body.more_statements(_without_docstring(made.node.body))
    made.lines = body.lines
    made.head = _head(program, made, body.result_name)
    made.done = True
    program.caller = caller


def _without_docstring(nodes: list[ast.stmt]) -> list[ast.stmt]:
    if nodes and isinstance(nodes[0], ast.Expr) and isinstance(nodes[0].value, ast.Constant):
        if isinstance(nodes[0].value.value, str):
            return nodes[1:]
    return nodes


def _parameter(body: Body, name: str, kind: Kind) -> Parameter:
    """Return an argument; a struct comes as pointer to const, or by value if the function binds its name anew."""
    variable = body.variable(name)
    variable.kind, variable.line = kind, body.node.lineno
    rebound = body.bindings.rebound(name)
    if is_scalar(kind):
        variable.fixed = not rebound
        return Parameter(name, kind, False, body.program.declared(kind, variable.c))
    if isinstance(kind, Array):
        return _array_parameter(body, name, kind, variable, rebound)
    if rebound:
        return Parameter(name, kind, False, body.program.declared(kind, variable.c))
    variable.pointer = variable.fixed = True
    return Parameter(name, kind, True, body.program.pointed(kind, variable.c))


def _array_parameter(body: Body, name: str, kind: Array, variable: Variable, rebound: bool) -> Parameter:
    given = variable.c
    if rebound:
        given = body.names.add(f"{name}_given")
        body.emit(f"{body.program.declared(kind, variable.c)};")
        from fmus.compiler.values import Value

        body.put(variable.c, Value(kind, given, place=True))
    variable.fixed = not rebound
    return Parameter(name, kind, True, f"const {body.program.declared(kind, given)}")


def _head(program: Program, made: Instance, result_name: str) -> str:
    texts = [parameter.text for parameter in made.parameters]
    result = made.result
    if isinstance(result, Array):
        texts.append(program.declared(result, result_name))
        return f"static void {made.name}({', '.join(texts)})"
    kind = "void" if result is None or isinstance(result, Open) else program.type_name(result)
    return f"static {kind} {made.name}({', '.join(texts) or 'void'})"
