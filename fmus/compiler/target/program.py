"""One C file in the making: which functions, types and constants it needs, and what they are called."""

import ast
from enum import IntEnum
from types import FunctionType
from typing import Any

from fmus.compiler.source.bindings import Bindings, bindings
from fmus.compiler.source.diagnostics import CannotError, Diagnostic
from fmus.compiler.source.discovery import CallGraph
from fmus.compiler.source.reading import Library
from fmus.compiler.source.resolve import Static
from fmus.compiler.source.types import (
    BOOL,
    FLOAT,
    INT,
    Array,
    Cells,
    Kind,
    Mixed,
    NoKindError,
    Open,
    Scalar,
    Struct,
    describe,
    fields_of,
    first_modules,
    kind_of_value,
    parts,
)
from fmus.compiler.source.writers import Writers
from fmus.compiler.target import runtime
from fmus.compiler.target.names import FileNames
from fmus.compiler.target.values import INT32, INT64, Value, literal

PLACES = ("math", "builtins", "typing", "enum", "cmath", "sys", "os")
"""Modules whose constants are written out."""


class Constant:
    """A module constant that the C file has under a name of its own."""

    def __init__(self, name: str, value: Any, kind: Kind) -> None:
        self.name, self.value, self.kind = name, value, kind


class Program:
    """Everything a C file is made of, found while its functions are translated."""

    def __init__(
        self,
        models: tuple[str, ...],
        roots: list[FunctionType],
        types: list[Any],
        reserved: tuple[str, ...] = (),
        library: Library | None = None,
    ) -> None:
        self.library = library or Library()
        self.refusals: list[Diagnostic] = []
        entries = [f"{name}_{entry}" for name in models for entry in ("defaults", "initialize", "step")]
        taken = [*models, *reserved, *entries, *runtime.TEXTS]
        self.names = FileNames(taken)
        self.found = CallGraph(self.library, roots, types)
        first = [*first_modules(), *(root.__module__ for root in roots)]
        self.modules = self.library.order(first, self.found.modules())
        self.types: dict[Any, str] = {}
        self.functions: dict[FunctionType, str] = {}
        self.constant_names: dict[tuple[str, str], str] = {}
        self.constants: dict[tuple[str, str], Constant] = {}
        self.defaults: dict[Any, str] = {}
        self.choosers: dict[Any, str] = {}
        self.enums: set[type[IntEnum]] = set()
        self.structs: dict[Any, None] = {}
        self.mixed: dict[Mixed, str] = {}
        self.helpers: set[str] = set()
        self.instances: dict[tuple[FunctionType, tuple[Kind, ...]], Any] = {}
        self.bindings: dict[FunctionType, Bindings] = {}
        self.stack: list[FunctionType] = []
        self.signatures: dict[FunctionType, Any] = {}
        self.in_place: dict[FunctionType, Any] = {}
        self.caller: Any = None
        self.writers = Writers(self.library, self.bindings_of)
        self.writing: set[str] = set()
        """C functions that write to a store."""
        for module in self.modules:
            self._name_all_of(module)

    def _name_all_of(self, module: str) -> None:
        for cls in self.found.of(self.found.classes, module):
            self.types[cls] = self.names.add(cls.__name__, module)
        for enum in self.found.of(self.found.enums, module):
            self.types[enum] = self.names.add(enum.__name__, module)
            for member in enum.__members__:
                self.names.taken.add(f"{self.types[enum]}_{member}")
        for function in self.found.of(self.found.functions, module):
            self.functions[function] = self.names.add(function.__qualname__.replace(".", "_"), module)
        for place in sorted(place for place in self.found.constants if place[0] == module):
            self.constant_names[place] = self.names.add(place[1], module)

    def refuse(self, module: str, node: ast.AST | None, what: str, advice: str) -> None:
        """Note a refusal."""
        line = getattr(node, "lineno", 1)
        file = self.library.module(module).file if module in self.library.modules else module
        self.refusals.append(Diagnostic(file, line, what, advice))

    def helper(self, name: str) -> str:
        """Return the name of a function of the runtime, which is written from now on."""
        self.helpers.add(name)
        return name

    def bindings_of(self, function: FunctionType) -> Bindings:
        """Return what ``function`` does with its names."""
        if function not in self.bindings:
            self.bindings[function] = bindings(self.library.function(function))
        return self.bindings[function]

    def type_name(self, kind: Kind) -> str:
        """Return the C type of a scalar, struct or mixed tuple."""
        if isinstance(kind, Scalar):
            return kind.c
        if isinstance(kind, Struct):
            self.need(kind)
            return self.types[kind.cls]
        if isinstance(kind, Mixed):
            self.need(kind)
            return self.mixed[kind]
        raise AssertionError(kind)

    def need(self, kind: Kind) -> None:
        """Note that a type is used, and all that it is made of."""
        if (isinstance(kind, Struct) and kind.cls in self.structs) or (isinstance(kind, Mixed) and kind in self.mixed):
            return
        for part in parts(kind):
            self.need(part)
        if isinstance(kind, Struct):
            if kind.cls not in self.types:
                self.types[kind.cls] = self.names.add(kind.cls.__name__, kind.cls.__module__)
            self.structs[kind.cls] = None
            self.check_class(kind.cls)
        if isinstance(kind, Mixed):
            self.mixed[kind] = self.names.add("Tuple_" + "_".join(self._word(item) for item in kind.items), "tuple")

    def _word(self, kind: Kind) -> str:
        if isinstance(kind, Array | Open):
            return f"{self._word(kind.item)}{kind.length if isinstance(kind, Array) else ''}"
        return self.types[kind.cls] if isinstance(kind, Struct) else kind.name if isinstance(kind, Scalar) else "tuple"

    def declaration(self, kind: Kind, name: str) -> str:
        """Return the declaration of ``name``: ``double name[3]``."""
        if isinstance(kind, Cells):
            return f"{kind.c} {name}[{kind.length}]"
        dimensions = ""
        while isinstance(kind, Array):
            dimensions += f"[{kind.length}]"
            kind = kind.item
        return f"{self.type_name(kind)} {name}{dimensions}"

    def pointer_declaration(self, kind: Kind, name: str) -> str:
        """Return the declaration of a pointer to const: to a struct, or to the first item of an array."""
        if isinstance(kind, Array) and isinstance(kind.item, Array):
            return "const " + self.declaration(kind.item, f"(*{name})").replace(f"{name})[", f"{name})[", 1)
        return f"const {self.type_name(kind.item if isinstance(kind, Array) else kind)} *{name}"

    def constant(self, found: Static, node: ast.AST) -> Value:
        """Return a constant of Python as a C expression, under its own name where it has one."""
        value = found.value
        if isinstance(value, IntEnum):
            return self.member(value)
        if isinstance(value, bool) or (found.module in PLACES and type(value) in (int, float)):
            return literal(value)
        kind = self.kind_of_constant(value, node)
        place = (found.module, found.name)
        if place not in self.constant_names:
            self.constant_names[place] = self.names.add(found.name, found.module)
        name = self.constant_names[place]
        self.need(kind)
        self.constants.setdefault(place, Constant(name, value, kind))
        if isinstance(kind, Scalar):
            if not isinstance(value, float) and not -INT64 <= value < INT64:
                raise CannotError(node, f"{found.name} does not fit in 64 bits", "keep integers within +-2^63")
            return Value(kind, name, const=value, narrow=isinstance(value, int) and -INT32 < value < INT32)
        return Value(kind, name, place=True, fixed=True, const=value)

    def kind_of_constant(self, value: Any, node: ast.AST) -> Kind:
        """Return the kind of a constant; refuse those that have none."""
        try:
            kind = kind_of_value(value)
            self.check_value(kind, value)
        except NoKindError as error:
            raise CannotError(node, error.what, error.advice) from None
        return kind

    def check_value(self, kind: Kind, value: Any) -> None:
        """Raise ``NoKindError`` unless ``value`` is exactly of ``kind``, all its parts too."""
        if isinstance(kind, Struct):
            if type(value) is not kind.cls:
                raise NoKindError(f"{value!r}, no {describe(kind)}", f"write {describe(kind)}(...)")
            cls: Any = kind.cls
            for name, part in fields_of(cls).items():
                self.check_value(part, getattr(value, name))
        elif isinstance(kind, Array | Mixed | Open):
            count = (
                kind.length if isinstance(kind, Array) else len(kind.items) if isinstance(kind, Mixed) else len(value)
            )
            if not isinstance(value, tuple) or len(value) != count:
                raise NoKindError(f"{value!r}, no {describe(kind)}", f"write {describe(kind)}")
            kinds = kind.items if isinstance(kind, Mixed) else (kind.item,) * count
            for part, item in zip(kinds, value, strict=True):
                self.check_value(part, item)
        else:
            self._check_scalar(kind, value)

    def _check_scalar(self, kind: Kind, value: Any) -> None:
        actual = kind_of_value(value)
        if kind == FLOAT and actual == INT:
            raise NoKindError(f"the int {value}", f"write {float(value)!r}: a float stays a float")
        if kind != actual and (kind, actual) != (INT, BOOL):
            raise NoKindError(f"{value!r}, no {describe(kind)}", f"write a value that is {describe(kind)}")
        if actual == INT and not -INT64 <= value < INT64:
            raise NoKindError(f"the integer {value}", "keep integers within 64 bits")

    def check_class(self, cls: Any) -> None:
        """Note fields of a NamedTuple whose default is not of the annotated kind."""
        node = self.library.class_node(cls)
        lines = {part.target.id: part for part in node.body if isinstance(part, ast.AnnAssign)
                 and isinstance(part.target, ast.Name)} if node else {}  # fmt: skip
        for name, kind in fields_of(cls).items():
            if name in cls._field_defaults:
                try:
                    self.check_value(kind, cls._field_defaults[name])
                except NoKindError as error:
                    what = f"{cls.__name__}.{name} is {describe(kind)}, its default {error.what}"
                    self.refuse(cls.__module__, lines.get(name, node), what, error.advice)

    def member(self, member: IntEnum) -> Value:
        """Return an enum member by name."""
        enum = type(member)
        if enum not in self.types:
            self.types[enum] = self.names.add(enum.__name__, enum.__module__)
        self.enums.add(enum)
        return Value(INT, f"{self.types[enum]}_{member.name}", const=int(member), narrow=True)

    def number(self, value: Any) -> Value:
        """Return a number written out, an enum member by name."""
        return self.member(value) if isinstance(value, IntEnum) else literal(value)

    def default(self, cls: Any) -> str:
        """Return the name of the constant that holds ``cls()``."""
        if cls not in self.defaults:
            self.need(Struct(cls))
            self.defaults[cls] = self.names.add(f"{self.types[cls]}_DEFAULT", cls.__module__)
        return self.defaults[cls]

    def item_function(self, cls: Any) -> str:
        """Return the name of the function that chooses a field of a NamedTuple by its index."""
        if cls not in self.choosers:
            self.choosers[cls] = self.names.add(f"{self.types[cls]}_item", cls.__module__)
        return self.choosers[cls]

    def fields(self, cls: Any, node: ast.AST | None) -> dict[str, Kind]:
        """Return the kinds of the fields of a NamedTuple."""
        try:
            return fields_of(cls)
        except NoKindError as error:
            raise CannotError(node, error.what, error.advice) from None
