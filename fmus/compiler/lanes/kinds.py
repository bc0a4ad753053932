"""Kinds of C values: numbers that all lanes share or that each lane has, structs, arrays and pointers."""

from typing import Any, NamedTuple

from pycparser import c_ast


class NoLanesError(TypeError):
    """Something for which there is no form in lanes."""


class Number(NamedTuple):
    """A number: ``double``, ``int`` (any width) or ``bool``."""

    name: str
    is_shared: bool
    """All lanes have the same one: a plain C number."""


class LaneStruct(NamedTuple):
    """A struct by its name."""

    name: str


class Pointer(NamedTuple):
    """A pointer, the same one in all lanes."""

    to: "Kind"


class LaneArray(NamedTuple):
    """An array of a fixed length."""

    item: "Kind"
    length: int


class Void(NamedTuple):
    """No value."""


Kind = Number | LaneStruct | Pointer | LaneArray | Void

DOUBLE, INT, BOOL = Number("double", False), Number("int", False), Number("bool", False)
SHARED_DOUBLE, SHARED_INT, SHARED_BOOL = Number("double", True), Number("int", True), Number("bool", True)
C_TYPES = {"double": "lane_d", "int": "lane_i", "bool": "lane_i"}
SHARED_C_TYPES = {"double": "double", "int": "int64_t", "bool": "bool"}
NUMBERS = {"double": "double", "int64_t": "int", "int": "int", "bool": "bool"}


class LaneValue(NamedTuple):
    """A C expression and its kind."""

    text: str
    kind: Kind


def kind_of_type(node: Any, lengths: dict[str, int], is_shared: bool = False) -> Kind:
    """Return the kind of a type in the syntax tree; ``lengths``: enum members that an array's length may be."""
    if isinstance(node, c_ast.Typename | c_ast.TypeDecl):
        return kind_of_type(node.type, lengths, is_shared)
    if isinstance(node, c_ast.PtrDecl):
        return Pointer(kind_of_type(node.type, lengths, is_shared))
    if isinstance(node, c_ast.ArrayDecl):
        length = lengths[node.dim.name] if isinstance(node.dim, c_ast.ID) else int(node.dim.value)
        return LaneArray(kind_of_type(node.type, lengths, is_shared), length)
    if isinstance(node, c_ast.IdentifierType):
        name = " ".join(node.names)
        if name == "void":
            return Void()
        if name in NUMBERS:
            return Number(NUMBERS[name], is_shared)
        if not name.endswith("_t"):
            return LaneStruct(name)
    raise NoLanesError(f"{type(node).__name__} {getattr(node, 'names', '')}")


def declaration(kind: Kind, name: str) -> str:
    """Return the C declaration of ``name``."""
    dimensions = ""
    while isinstance(kind, LaneArray):
        dimensions += f"[{kind.length}]"
        kind = kind.item
    if isinstance(kind, Pointer):
        if isinstance(kind.to, LaneArray):
            return f"{declaration(kind.to, f'(*{name})')}{dimensions}"
        return f"{type_name(kind.to)} *{name}{dimensions}"
    return f"{type_name(kind)} {name}{dimensions}"


def type_name(kind: Kind) -> str:
    """Return the C type of a number or a struct."""
    if isinstance(kind, Number):
        return (SHARED_C_TYPES if kind.is_shared else C_TYPES)[kind.name]
    if isinstance(kind, LaneStruct):
        return kind.name
    if isinstance(kind, Void):
        return "void"
    raise NoLanesError(f"no name for {kind}")


def own(kind: Number) -> Number:
    """Return the number that each lane has."""
    return Number(kind.name, False)


def convert(value: LaneValue, wanted: Number) -> str:
    """Return the text of a number as the ``wanted`` one."""
    kind = value.kind
    if not isinstance(kind, Number):
        raise NoLanesError(f"{kind} where a number is needed")
    text = value.text
    if kind == wanted:
        return text
    if wanted.is_shared:
        if not kind.is_shared:
            raise NoLanesError(f"{text} differs between lanes")
        return f"({SHARED_C_TYPES[wanted.name]})({text})"
    if kind.is_shared:
        if wanted.name == "bool":
            return f"LANE_INT(-(int64_t)(({text}) != 0))"
        return f"LANE_DOUBLE({text})" if wanted.name == "double" else f"LANE_INT({text})"
    if wanted.name == "bool":
        return f"(({text}) != 0)"
    if kind.name == "bool":
        text, kind = f"(-({text}))", INT
    if wanted.name == "double":
        return f"__builtin_convertvector({text}, lane_d)" if kind.name == "int" else text
    if kind.name == "double":
        raise NoLanesError(f"{text} as an integer")
    return text
