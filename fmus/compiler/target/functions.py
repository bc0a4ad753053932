"""Functions: one C function for each combination of tuple lengths."""

import ast
import re
from dataclasses import dataclass, field
from types import FunctionType
from typing import Any

from fmus.compiler.source.alias_analysis import aliases_of
from fmus.compiler.source.diagnostics import CannotError
from fmus.compiler.source.flow import DefiniteAssignment
from fmus.compiler.source.types import NOTHING, Array, Kind, Mixed, Open, Struct, is_store
from fmus.compiler.target.body import FunctionBody
from fmus.compiler.target.in_place import InPlace, in_place
from fmus.compiler.target.layout import flat, without_unused
from fmus.compiler.target.program import Program
from fmus.compiler.target.signatures import signature
from fmus.compiler.target.storage import put
from fmus.compiler.target.values import Place, Value, is_result_by_value, is_scalar
from fmus.compiler.target.variables import variable

MAX_INLINE_LINES = 20
"""Functions of no more lines without a loop are inline."""
LOOPS = ("for (", "while (")


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
    changed: InPlace | None = None
    """The argument that is changed where it lies, and is a result then."""
    outs: list[tuple[str, Kind]] = field(default_factory=list)
    """Name and kind of the results that are written to pointers."""
    head: str = ""


def instance_of(program: Program, function: FunctionType, kinds: tuple[Kind, ...], node: ast.AST | None) -> Instance:
    """Return the C function for arguments of these kinds; it is translated now if it is new."""
    known = signature(program, function)
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
        made = Instance(name, function, tree, [], result, changed=in_place(program, function))
        if function in program.writers:
            program.writing.add(name)
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
    body = FunctionBody(program, made.function, made.node)
    body.result, body.made = result, made
    for fault in DefiniteAssignment(made.node, kinds, body.bindings.local, body.number, result == NOTHING).faults:
        body.refuse(fault, made.node)
    with body.frame(()):
        body.begin_statement()
        made.parameters = [_parameter(body, name, kind, made.changed) for name, kind in kinds.items()]
        _place_results(body, made, result)
        body.more_statements(_without_docstring(made.node.body))
    made.lines = without_unused(list(flat(body.lines)), program.writing)
    if made.lines and made.lines[-1] == "return;":
        made.lines.pop()
    made.head = _head(program, made)
    made.lines = [*_unread(made), *made.lines]
    program.caller = caller


def _unread(made: Instance) -> list[str]:
    """Return a line for each parameter that the function does not read, which marks it as unused for the C compiler."""
    names = [re.findall(r"\w+", parameter.text.partition("[")[0])[-1] for parameter in made.parameters]
    return [f"(void){name};" for name in names if not any(re.search(rf"\b{name}\b", line) for line in made.lines)]


def _without_docstring(nodes: list[ast.stmt]) -> list[ast.stmt]:
    if nodes and isinstance(nodes[0], ast.Expr) and isinstance(nodes[0].value, ast.Constant):
        if isinstance(nodes[0].value.value, str):
            return nodes[1:]
    return nodes


def _parameter(body: FunctionBody, name: str, kind: Kind, changed: InPlace | None) -> Parameter:
    """Return an argument: a struct as pointer to const, but by value if its name is bound again on some paths."""
    known = variable(body, name)
    known.kind, known.parameter = kind, True
    if changed is not None and name == changed.name:
        body.anew.discard(name)
        known.pointer, known.fixed = True, not body.bindings.rebound(name)
        if isinstance(kind, Struct):
            body.borrowed = aliases_of(body.node, name, kind.cls)
        return Parameter(known.c, kind, True, body.program.declaration(kind, f"*{known.c}"))
    changes = body.bindings.rebound(name) and (is_scalar(kind) or name not in body.anew)
    known.fixed = not body.bindings.rebound(name) or not changes
    if is_scalar(kind):
        return Parameter(known.c, kind, False, body.program.declaration(kind, known.c))
    if isinstance(kind, Array):
        given = known.c
        if changes:
            given = body.names.add(f"{name}_given")
            body.emit(f"{body.program.declaration(kind, known.c)};")
            put(body, known.place, Value(kind, given, place=True))
            known.parameter = False
        return Parameter(given, kind, True, f"const {body.program.declaration(kind, given)}")
    if changes:
        return Parameter(known.c, kind, False, body.program.declaration(kind, known.c))
    known.pointer = True
    if is_store(kind) and body.function in body.program.writers:
        return Parameter(known.c, kind, True, f"{body.program.type_name(kind)} *{known.c}")
    return Parameter(known.c, kind, True, body.program.pointer_declaration(kind, known.c))


def _place_results(body: FunctionBody, made: Instance, result: Kind) -> None:
    """Give a pointer to each result that is not returned by value.

    A variable that is the result on every way lives where the result goes, and lends it its name.
    """
    if not isinstance(result, Open) and is_result_by_value(result):
        return
    kinds = result.items if isinstance(result, Mixed) else (result,)
    names = _result_names(made.node, len(kinds) if isinstance(result, Mixed) else 0)
    for number, (kind, name) in enumerate(zip(kinds, names, strict=True)):
        if made.changed is not None and number == made.changed.result:
            body.changed = variable(body, made.changed.name).place
            body.outs.append(body.changed)
            continue
        usual = "result" if len(kinds) == 1 else _word(kind) or f"result{number}"
        given = name in body.bindings.parameters
        own = bool(name) and not is_scalar(kind) and (not given or name in body.anew)
        word = body.names.add(f"next_{name}" if given else name if own else f"{name}_out" if name else usual)
        place = Place(word, pointer=not isinstance(kind, Array | Open))
        body.outs.append(place)
        made.outs.append((word, kind))
        if own and len(body.bindings.homes.get(name, ())) == 1:
            body.result_of[name] = (place, kind)


def _word(kind: Kind) -> str:
    """Return the name of a NamedTuple as a variable would have it."""
    if not isinstance(kind, Struct):
        return ""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", kind.cls.__name__).lower()


def _result_names(node: ast.FunctionDef, count: int) -> list[str]:
    """Return the variable that each item of the result is on every path, or an empty string."""
    values = [item.value for item in ast.walk(node) if isinstance(item, ast.Return)]
    rows = [value.elts if isinstance(value, ast.Tuple) and count else [value] for value in values]
    if any(len(row) != max(count, 1) for row in rows):
        return [""] * max(count, 1)
    found = []
    for column in zip(*rows, strict=True):
        names = {item.id if isinstance(item, ast.Name) else "" for item in column}
        found.append(names.pop() if len(names) == 1 else "")
    return found or [""] * max(count, 1)


def _head(program: Program, made: Instance) -> str:
    texts = [parameter.text for parameter in made.parameters]
    for name, kind in made.outs:
        if isinstance(kind, Open):
            kind = made.result or kind
        if not isinstance(kind, Open):
            texts.append(program.declaration(kind, name if isinstance(kind, Array) else f"*{name}"))
    result = "void" if made.outs or made.changed or made.result is None else program.type_name(made.result)
    inline = (
        "inline "
        if len(made.lines) <= MAX_INLINE_LINES and not any(line.startswith(LOOPS) for line in made.lines)
        else ""
    )
    return f"static {inline}{result} {made.name}({', '.join(texts) or 'void'})"
