"""One Python function on its way to C: its variables, the lines written so far, and how values are put into places."""

import ast
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import FunctionType
from typing import Any

from fmus.compiler.advice import EXPRESSION_ADVICE, STATEMENT_ADVICE
from fmus.compiler.bindings import Path, stored_in
from fmus.compiler.kinds import BOOL, FLOAT, INT, Array, Kind, Mixed, Open, Scalar, Struct, described
from fmus.compiler.names import FUNCTIONS, LocalNames, member_name
from fmus.compiler.program import Program
from fmus.compiler.refusals import AlreadySaidError, CannotError
from fmus.compiler.resolve import Static, static
from fmus.compiler.runtime import TEXTS
from fmus.compiler.values import UNKNOWN, Value, as_int, element, initial, is_scalar, rvalue

EXPRESSIONS: dict[type[ast.AST], Callable[["Body", Any], Value]] = {}
STATEMENTS: dict[type[ast.AST], Callable[["Body", Any], None]] = {}


@dataclass
class Variable:
    """A variable of the function."""

    c: str
    kind: Kind | None = None
    """None: not bound yet."""
    failed: bool = False
    """What it was bound to is refused."""
    pointer: bool = False
    fixed: bool = False
    const: Any = UNKNOWN
    low: int | None = None
    high: int | None = None
    line: int = 0

    def value(self) -> Value:
        """Return the variable as an expression."""
        assert self.kind is not None
        return Value(
            self.kind, self.c, place=True, fixed=self.fixed, pointer=self.pointer, const=self.const,
            low=self.low, high=self.high,
        )  # fmt: skip


@dataclass
class Frame:
    """A block being written, with room for declarations before the statement in hand."""

    path: Path
    slot: list[Any] = field(default_factory=list)


class Body:
    """The translation of one function."""

    def __init__(self, program: Program, function: FunctionType, node: ast.FunctionDef) -> None:
        self.program = program
        self.function = function
        self.node = node
        self.module = program.library.module(function.__module__)
        self.bindings = program.bindings_of(function)
        self.lines: list[Any] = []
        self.frames: list[Frame] = []
        self.scopes: list[dict[str, Variable]] = [{}]
        self.names = LocalNames([*TEXTS, *self._file_names_used()])
        self.result: Kind = FLOAT
        self.made: Any = None
        """The C function in the making."""
        self.result_name = "result"
        self.commented = node.lineno
        self.temporaries: dict[str, int] = {}

    def _file_names_used(self) -> Iterator[str]:
        """Yield the names of C's outermost level that the function mentions."""
        program = self.program
        for use in program.found.uses.get(self.function, ()):
            if use in program.functions:
                yield program.functions[use]
            elif use in program.constant_names:
                yield program.constant_names[use]
        yield from program.types.values()
        for node in ast.walk(self.node):
            if isinstance(node, ast.Name | ast.Attribute):
                yield from {(node.attr if isinstance(node, ast.Attribute) else node.id)} & FUNCTIONS
                if (node.attr if isinstance(node, ast.Attribute) else node.id) == "abs":
                    yield "fabs"

    # ---- what is said of the source

    def refuse(self, error: CannotError, node: ast.AST) -> None:
        """Note that something is refused."""
        place = error.node if error.node is not None and hasattr(error.node, "lineno") else node
        self.program.refuse(self.module.name, place, error.what, error.advice)

    def static(self, node: ast.expr) -> Static | None:
        """Return the Python object that ``node`` names, unless it is a variable."""
        local = self.bindings.local | {name for scope in self.scopes for name in scope}
        return static(node, self.function.__globals__, local, self.program.library)

    # ---- lines

    def emit(self, text: str) -> None:
        """Write a line."""
        self.lines.append(text)

    @contextmanager
    def capture(self) -> Iterator[list[Any]]:
        """Write to a list of its own."""
        before, self.lines = self.lines, []
        try:
            yield self.lines
        finally:
            self.lines = before

    @contextmanager
    def frame(self, path: Path) -> Iterator[None]:
        """Write a block of the function."""
        self.frames.append(Frame(path))
        yield
        self.frames.pop()

    def statements(self, nodes: list[ast.stmt], path: Path) -> None:
        """Write the statements of a block."""
        with self.frame(path):
            self.more_statements(nodes)

    def more_statements(self, nodes: list[ast.stmt]) -> None:
        """Write statements into the block in hand."""
        for node in nodes:
            self.begin_statement()
            self.comments_before(node)
            try:
                handler = STATEMENTS.get(type(node))
                if handler is None:
                    raise CannotError(node, *refused_statement(node))
                handler(self, node)
            except CannotError as error:
                self.refuse(error, node)
                self._give_up(node)
            except AlreadySaidError:
                self._give_up(node)

    def begin_statement(self) -> None:
        """Make room for declarations."""
        slot: list[Any] = []
        self.lines.append(slot)
        self.frames[-1].slot = slot

    def _give_up(self, node: ast.stmt) -> None:
        for name in stored_in([node]):
            variable = self.variable(name)
            variable.failed = variable.kind is None

    def comments_before(self, node: ast.stmt) -> None:
        """Write the comments of the lines up to ``node``, and those beside it."""
        compound = isinstance(node, ast.If | ast.For | ast.While | ast.Match)
        last = node.lineno if compound else node.end_lineno or node.lineno
        for line in range(self.commented, last + 1):
            if line in self.module.comments:
                self.emit(f"/* {self.module.comments[line].replace('*/', '* /')} */")
        self.commented = max(self.commented, last + 1)

    def comments_between(self, first: ast.stmt, then: ast.stmt) -> bool:
        """Return whether there are comments that stand before ``then``, inside ``first``."""
        return any(line in self.module.comments for line in range(self.commented, then.lineno))

    # ---- variables

    def variable(self, name: str) -> Variable:
        """Return the variable called ``name``."""
        for scope in reversed(self.scopes):
            if name in scope:
                return scope[name]
        self.scopes[0][name] = Variable(self.names.add(name))
        return self.scopes[0][name]

    def is_inline(self, name: str) -> bool:
        """Return whether ``name`` can be declared right here, where it is bound first."""
        return self.frames[-1].path == self.bindings.homes.get(name) and name not in self.bindings.parameters

    def is_once(self, name: str) -> bool:
        """Return whether ``name`` is bound at one place only."""
        return self.bindings.stores[name] == 1 and name not in self.bindings.parameters

    def bind(self, name: str, value: Value, node: ast.AST, source: ast.AST | None = None) -> None:
        """Write that ``name`` gets ``value``; ``source`` is the expression it comes from."""
        variable = self.variable(name)
        if variable.kind is not None:
            value = self.coerced(value, variable.kind, node, f"{name} is {described(variable.kind)} before")
            self.store(variable, value, name, source)
            return
        if isinstance(value.kind, Open):
            raise AlreadySaidError
        variable.kind, variable.line, variable.failed = value.kind, getattr(node, "lineno", 0), False
        if not self.bindings.loads[name]:
            return
        if not self.is_inline(name):
            frame = next((f for f in self.frames if f.path == self.bindings.homes[name]), self.frames[0])
            frame.slot.append(f"{self.program.declared(value.kind, variable.c)};")
            self.store(variable, value, name, source)
            return
        self._declare(variable, value, self.is_once(name))

    def _declare(self, variable: Variable, value: Value, once: bool) -> None:
        """Write the declaration of a variable with its first value."""
        kind = value.kind
        declared = self.program.declared(kind, variable.c)
        if once and value.place and value.fixed and not is_scalar(kind):
            text = value.text if value.pointer or isinstance(kind, Array) else f"&{value.text}"
            self.emit(f"{self.program.pointed(kind, variable.c)} = {text};")
            variable.pointer, variable.fixed = not isinstance(kind, Array), True
            variable.const = value.const
            return
        start = self.start_of(value)
        variable.fixed = once
        if once and is_scalar(kind):
            variable.const, variable.low, variable.high = value.const, value.low, value.high
        if start is None:
            self.emit(f"{declared};")
            self.put(variable.c, value)
        else:
            self.emit(f"{'const ' if once else ''}{declared} = {start};")

    def start_of(self, value: Value) -> str | None:
        """Return the text that a declaration can begin with; None if it takes statements."""
        if isinstance(value.kind, Array):
            return value.braces or None
        if value.fill is not None and not value.braces:
            return None
        return value.braces or rvalue(value)

    def store(self, variable: Variable, value: Value, name: str, source: ast.AST | None) -> None:
        """Write the assignment of ``value``; through a temporary if it is made while the variable is still read."""
        if not self.bindings.loads[name]:
            return
        busy = source is not None and any(
            isinstance(item, ast.Name) and item.id == name and isinstance(item.ctx, ast.Load)
            for item in ast.walk(source)
        )
        needs_room = value.fill is not None and not (value.braces and not isinstance(value.kind, Array))
        if busy and needs_room:
            value = self.hoist(value, f"next_{name}")
        self.put(variable.c, value)

    # ---- values into places

    def put(self, place: str, value: Value) -> None:
        """Write the statements that make ``place`` equal to ``value``, which does not read it meanwhile."""
        if isinstance(value.kind, Array) and value.fill is None:
            self._copy(place, value, value.kind)
        elif value.fill is not None and (isinstance(value.kind, Array) or not value.braces):
            value.fill(place)
        elif value.braces:
            self.emit(f"{place} = ({self.program.type_name(value.kind)}){value.braces};")
        elif rvalue(value) != place:
            self.emit(f"{place} = {rvalue(value)};")

    def _copy(self, place: str, value: Value, kind: Array) -> None:
        if value.text == place:
            return
        index = self.names.add("i")
        self.emit(f"for (int {index} = 0; {index} < {kind.length}; ++{index}) {{")
        item = Value(kind.item, element(value, index), place=True)
        self.put(f"{place}[{index}]", item)
        self.emit("}")
        self.names.taken.discard(index)

    def hoist(self, value: Value, name: str) -> Value:
        """Return ``value`` as a constant of its own, declared here."""
        kind = value.kind
        c = self.names.add(name)
        declared = self.program.declared(kind, c)
        if value.place and not is_scalar(kind):
            if isinstance(kind, Array):
                self.emit(f"{declared};")
                self.put(c, value)
            else:
                self.emit(f"const {declared} = {rvalue(value)};")
            return Value(kind, c, place=True, fixed=True, const=value.const)
        start = self.start_of(value)
        if start is None:
            self.emit(f"{declared};")
            self.put(c, value)
        else:
            self.emit(f"const {declared} = {start};")
        return Value(kind, c, place=True, fixed=True, const=value.const, low=value.low, high=value.high)

    def settled(self, value: Value, name: str) -> Value:
        """Return ``value`` as something that may be mentioned often and pointed at."""
        if value.place or (is_scalar(value.kind) and value.const is not UNKNOWN):
            return value
        return self.hoist(value, name)

    def address(self, value: Value, name: str) -> str:
        """Return a pointer to a struct, or to the first item of an array."""
        if isinstance(value.kind, Array):
            if value.braces and not value.place:
                return f"({self.program.declared(value.kind, '').replace(' ', '', 1)}){value.braces}"
            return self.settled(value, name).text
        if value.pointer:
            return value.text
        if value.braces and not value.place:
            return f"&({self.program.type_name(value.kind)}){value.braces}"
        return f"&{self.settled(value, name).text}"

    # ---- expressions

    def value(self, node: ast.expr) -> Value:
        """Return an expression in C."""
        handler = EXPRESSIONS.get(type(node))
        if handler is None:
            raise CannotError(node, *refused_expression(node))
        return handler(self, node)

    def scalar(self, node: ast.expr) -> Value:
        """Return an expression in C that is a number or truth value."""
        value = self.value(node)
        if not is_scalar(value.kind):
            what = f"{described(value.kind)} where a number is expected"
            raise CannotError(node, what, "name the field or the index that is meant")
        return value

    def coerced(self, value: Value, kind: Kind, node: ast.AST, why: str) -> Value:
        """Return ``value`` as ``kind``; refuse what Python would not keep apart but C would."""
        if value.kind == kind:
            return value
        if kind == INT and value.kind == BOOL:
            return as_int(value)
        if value.items is not None and isinstance(kind, Array | Mixed):
            kinds = (kind.item,) * kind.length if isinstance(kind, Array) else kind.items
            if len(kinds) == len(value.items):
                pairs = zip(value.items, kinds, strict=True)
                return tuple_of(self, tuple(self.coerced(item, one, node, why) for item, one in pairs), kind)
        raise CannotError(node, f"{described(value.kind)} where {why}", advice_for(value, kind))


def tuple_of(body: Body, items: tuple[Value, ...], kind: Kind | None = None) -> Value:
    """Return a tuple of ``items``."""
    kinds = tuple(item.kind for item in items)
    if kind is None:
        kind = Array(kinds[0], len(kinds)) if len(set(kinds)) == 1 else Mixed(kinds)
    texts = [initial(item) for item in items]
    braces = "" if None in texts else "{" + ", ".join(str(text) for text in texts) + "}"
    const = tuple(item.const for item in items)

    def fill(place: str) -> None:
        for number, item in enumerate(items):
            body.put(f"{place}.item{number}" if isinstance(kind, Mixed) else f"{place}[{number}]", item)

    known = UNKNOWN if any(item is UNKNOWN for item in const) else const
    text = ""
    if isinstance(kind, Mixed):
        text = f"({body.program.type_name(kind)}){braces}"
    return Value(kind, text, fill=fill, braces=braces, items=items, const=known)


def written_out(body: Body, constant: Any, kind: Kind) -> Value:
    """Return a constant that has no name of its own."""
    if isinstance(kind, Scalar):
        value = body.program.number(constant)
        return as_int(value) if kind == INT else value
    if isinstance(kind, Struct):
        cls = kind.cls
        body.program.need(kind)
        if len(cls._field_defaults) == len(cls._fields) and repr(constant) == repr(cls()):
            return Value(kind, body.program.default(cls), place=True, fixed=True, const=constant)
        kinds = body.program.fields(cls, None)
        fields = {name: written_out(body, getattr(constant, name), part) for name, part in kinds.items()}
        return struct_of(body, kind, fields)
    kinds_of = (kind.item,) * len(constant) if isinstance(kind, Array | Open) else kind.items
    return tuple_of(body, tuple(written_out(body, item, one) for item, one in zip(constant, kinds_of, strict=True)))


def struct_of(body: Body, kind: Struct, fields: dict[str, Value]) -> Value:
    """Return a struct of ``fields``."""
    texts = {name: initial(value) for name, value in fields.items()}
    if None not in texts.values():
        braces = "{" + ", ".join(f".{member_name(name)} = {text}" for name, text in texts.items()) + "}"
        return Value(kind, f"({body.program.type_name(kind)}){braces}", braces=braces)

    def fill(place: str) -> None:
        for name, value in fields.items():
            body.put(f"{place}.{member_name(name)}", value)

    return Value(kind, fill=fill)


def advice_for(value: Value, kind: Kind) -> str:
    """Return what to write so that ``value`` is of ``kind``."""
    if kind == FLOAT and value.kind in (INT, BOOL):
        if value.const is not UNKNOWN:
            return f"write {float(value.const)!r}"
        return "write float(...) around it"
    if kind == INT and value.kind == FLOAT:
        return "write int(...) or math.floor(...) around it"
    if kind == BOOL and isinstance(value.kind, Scalar):
        return "write a comparison, such as x != 0"
    if isinstance(kind, Array) and isinstance(value.kind, Array) and kind.item == value.kind.item:
        return f"make it {kind.length} items long"
    return f"make it {described(kind)}"


def refused_expression(node: ast.AST) -> tuple[str, str]:
    """Return what an expression is that is not of the language, and what to write."""
    return EXPRESSION_ADVICE.get(type(node), (f"the expression {ast.unparse(node)}", "write it in simpler steps"))


def refused_statement(node: ast.AST) -> tuple[str, str]:
    """Return what a statement is that is not of the language, and what to write."""
    return STATEMENT_ADVICE.get(type(node), ("this statement", "write it in simpler steps"))
