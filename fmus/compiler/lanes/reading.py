"""The translator's C as a syntax tree, and what its structs, functions and constants are."""

import re
from collections.abc import Iterator
from typing import Any

from pycparser import c_ast, c_parser

from fmus.compiler.lanes.kinds import (
    SHARED_INT,
    Kind,
    LaneArray,
    LaneStruct,
    NoLanesError,
    Number,
    Pointer,
    kind_of_type,
)
from fmus.compiler.target import runtime

COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
CPLUSPLUS = re.compile(r"#ifdef __cplusplus.*?#endif", re.DOTALL)
DIRECTIVE = re.compile(r"^\s*#.*$", re.MULTILINE)
PROLOGUE = """
typedef int int32_t; typedef int int16_t; typedef int int8_t; typedef long int64_t; typedef unsigned long uint64_t;
typedef int bool; enum { false, true };
"""


class Declarations:
    """The parts of a C file."""

    def __init__(self, header: str, source: str, outputs: str, live_outputs: frozenset[str]) -> None:
        self.outputs, self.live_outputs = LaneStruct(outputs), live_outputs
        """The struct of the model's outputs, and those of its fields that the study needs."""
        text = PROLOGUE + DIRECTIVE.sub("", CPLUSPLUS.sub("", COMMENT.sub("", header + source)))
        try:
            tree: Any = c_parser.CParser().parse(text)
        except c_parser.ParseError as error:
            raise NoLanesError(str(error)) from error
        self.enums: dict[str, str] = {}
        """Enum member -> its value in C."""
        self.lengths: dict[str, int] = {}
        self.structs: dict[str, dict[str, Kind]] = {}
        self.signatures: dict[str, tuple[Kind, list[tuple[str, Kind]]]] = {}
        self.functions: dict[str, Any] = {}
        self.constants: dict[str, Kind] = {}
        self.initials: dict[str, Any] = {}
        self._read_only: set[tuple[str, str]] = set()
        for node in tree.ext:
            self._read(node)
        self._share_tables()

    def _read(self, node: Any) -> None:
        if isinstance(node, c_ast.Typedef):
            if isinstance(node.type.type, c_ast.Struct):
                fields = node.type.type.decls
                self.structs[node.name] = {item.name: kind_of_type(item.type, self.lengths) for item in fields}
        elif isinstance(node, c_ast.FuncDef):
            if node.decl.name not in runtime.TEXTS:
                self._sign(node.decl)
                self.functions[node.decl.name] = node
        elif isinstance(node.type, c_ast.Enum):
            self._number(node.type)
        elif isinstance(node.type, c_ast.FuncDecl):
            self._sign(node)
        else:
            kind = kind_of_type(node.type, self.lengths, True)
            self.constants[node.name], self.initials[node.name] = kind, node.init

    def _number(self, enum: Any) -> None:
        for item in enum.values.enumerators:
            if item.value is not None:
                negative = isinstance(item.value, c_ast.UnaryOp)
                digits = (item.value.expr if negative else item.value).value
                self.lengths[item.name] = -int(digits) if negative else int(digits)
            self.enums[item.name] = item.name

    def _share_tables(self) -> None:
        """Give parameters the kind of the table that every call passes there: numbers that all lanes share."""
        passed: dict[tuple[str, int], set[Kind | None]] = {}
        for function in self.functions.values():
            for call in calls_in(function):
                for place, item in enumerate(call.args.exprs if call.args else []):
                    name = item.name if isinstance(item, c_ast.ID) else ""
                    kind = self.constants.get(name)
                    is_array = isinstance(kind, LaneArray) and is_table(kind)
                    passed.setdefault((call.name.name, place), set()).add(kind if is_array else None)
        for (function, place), kinds in passed.items():
            kind = kinds.pop() if len(kinds) == 1 else None
            if isinstance(kind, LaneArray) and function in self.signatures:
                params = self.signatures[function][1]
                params[place] = (params[place][0], Pointer(kind.item))

    def _sign(self, decl: Any) -> None:
        params = decl.type.args.params if decl.type.args else []
        known = [(item.name, self._parameter(item)) for item in params if item.name]
        self._read_only |= {(decl.name, item.name) for item in params if is_const(item.type)}
        self.signatures[decl.name] = (kind_of_type(decl.type.type, self.lengths), known)

    def _parameter(self, item: Any) -> Kind:
        kind = kind_of_type(item.type, self.lengths)
        return Pointer(kind.item) if isinstance(kind, LaneArray) else kind

    def is_read_only(self, function: str, parameter: str) -> bool:
        """Return whether a function only reads what a parameter points to."""
        return (function, parameter) in self._read_only

    def field(self, kind: Kind, name: str) -> Kind:
        """Return the kind of a field of a struct."""
        if not isinstance(kind, LaneStruct):
            raise NoLanesError(f".{name} of {kind}")
        return self.structs[kind.name][name]

    def name(self, name: str) -> Kind | None:
        """Return the kind of a constant of the file, None if there is none of that name."""
        if name in self.enums:
            return SHARED_INT
        return self.constants.get(name)


def is_const(node: Any) -> bool:
    """Return whether a declared number, or what a pointer points to, is only read."""
    while isinstance(node, c_ast.PtrDecl | c_ast.ArrayDecl):
        node = node.type
    return "const" in node.quals


def calls_in(node: Any) -> Iterator[Any]:
    """Yield the calls in a part of the syntax tree."""
    if isinstance(node, c_ast.FuncCall):
        yield node
    for _, child in node.children():
        yield from calls_in(child)


def is_table(kind: Kind) -> bool:
    """Return whether a constant is a number, or an array of numbers, that all lanes share."""
    while isinstance(kind, LaneArray):
        kind = kind.item
    return isinstance(kind, Number)
