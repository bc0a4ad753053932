"""What functions take and give, by their annotations."""

import ast
import typing
from types import FunctionType
from typing import Any, NamedTuple

from fmus.compiler.source.diagnostics import AlreadySaidError
from fmus.compiler.source.resolve import owner_of
from fmus.compiler.source.types import NOTHING, Kind, NoKindError, Struct, kind_of
from fmus.compiler.target.program import Program


class Signature(NamedTuple):
    """What a function takes and gives, by its annotations."""

    kinds: dict[str, Kind]
    defaults: dict[str, Any]
    result: Kind


def signature(program: Program, function: FunctionType) -> Signature:
    """Return the signature of ``function``; what is wrong with it is noted once."""
    if function not in program.signatures:
        program.signatures[function] = _read_signature(program, function)
    found: Signature | None = program.signatures[function]
    if found is None:
        raise AlreadySaidError
    return found


def _read_signature(program: Program, function: FunctionType) -> Signature | None:
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
            kinds["self"] = Struct(owner_of(function))
        elif item.arg not in hints:
            refuse(item, f"{node.name}() takes {item.arg} without a type", f"write {item.arg}: float, or what it is")
        else:
            _read_kind(refuse, item, f"{node.name}() takes {item.arg}", hints[item.arg], kinds, item.arg)
    if "return" not in hints or node.returns is None:
        refuse(node, f"{node.name}() has no result type", "write -> float, or what it returns, before the colon")
    elif hints["return"] is type(None) and function in program.writers:
        kinds["return"] = NOTHING
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


def _is_property(node: ast.FunctionDef) -> bool:
    return [ast.unparse(item) for item in node.decorator_list] == ["property"]
