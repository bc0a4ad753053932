"""One Python function on its way to C: its variables, the lines written so far, and how values are put into places."""

import ast
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import FunctionType
from typing import Any

from fmus.compiler.source.advice import EXPRESSION_ADVICE, STATEMENT_ADVICE
from fmus.compiler.source.bindings import Path
from fmus.compiler.source.diagnostics import AlreadySaidError, CannotError
from fmus.compiler.source.resolve import Static, static
from fmus.compiler.source.types import FLOAT, Kind, describe
from fmus.compiler.target.names import FUNCTIONS, LocalNames
from fmus.compiler.target.program import Program
from fmus.compiler.target.runtime import TEXTS
from fmus.compiler.target.values import Place, Value, is_scalar

EXPRESSIONS: dict[type[ast.AST], Callable[["FunctionBody", Any], Value]] = {}
STATEMENTS: dict[type[ast.AST], Callable[["FunctionBody", Any], None]] = {}
METHODS: dict[type, Callable[["FunctionBody", Value, str, ast.AST], Value]] = {}
"""Kind of a member of a NamedTuple that is no field -> what its value is."""


@dataclass
class Frame:
    """A block being written, with room for declarations before the statement in hand."""

    path: Path
    slot: list[Any] = field(default_factory=list)


class FunctionBody:
    """The translation of one function."""

    def __init__(self, program: Program, function: FunctionType, node: ast.FunctionDef) -> None:
        self.program = program
        self.function = function
        self.node = node
        self.module = program.library.module(function.__module__)
        self.bindings = program.bindings_of(function)
        self.lines: list[Any] = []
        self.frames: list[Frame] = []
        self.variables: dict[tuple[str, Path], Any] = {}
        self.c_names: dict[str, str] = {}
        self.scopes: list[dict[str, Any]] = []
        """Variables of generators."""
        self.names = LocalNames([*TEXTS, *self._file_names_used()])
        self.result: Kind = FLOAT
        self.made: Any = None
        """The C function in the making."""
        self.outs: list[Place] = []
        """Where the results go that are not returned by value."""
        self.changed: Place | None = None
        """The argument that is changed into a result."""
        self.borrowed: set[str] = set()
        """Variables that stand for fields of it."""
        self.result_of: dict[str, tuple[Place, Kind]] = {}
        """Variables that are the result on every way: they live where it goes."""
        self.anew = {name for name in self.bindings.parameters if self._begins_anew(name)}
        """Parameters that are bound to something new for all the rest of the function."""
        self.aliases: dict[str, tuple[tuple[str, ...], ...]] = {}
        """What pointers point to."""
        self.commented = node.lineno
        self.may_write: ast.AST | None = None
        """The call that may write to a store: it is all there is to its statement."""

    def _begins_anew(self, name: str) -> bool:
        first = next((mention for mention in self.bindings.mentions.get(name, ()) if mention.store), None)
        return first is not None and first.path == ()

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
            if isinstance(node, ast.Call):
                word = node.func.attr if isinstance(node.func, ast.Attribute) else ast.unparse(node.func)
                yield from ("fabs", "trunc", "rint", word) if word in FUNCTIONS | {"int"} else ()

    # ---- what is said of the source

    def refuse(self, error: CannotError, node: ast.AST) -> None:
        """Note that something is refused."""
        place = error.node if error.node is not None and hasattr(error.node, "lineno") else node
        self.program.refuse(self.module.name, place, error.what, error.advice)

    def static(self, node: ast.expr) -> Static | None:
        """Return the Python object that ``node`` names, unless it is a variable."""
        local = self.bindings.local.union(*self.scopes)
        return static(node, self.function.__globals__, local, self.program.library)

    def number(self, node: ast.expr) -> int | None:
        """Return the integer that ``node`` is, if it is written out or a constant of the module."""
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            value = self.number(node.operand)
            return None if value is None else -value
        found = node.value if isinstance(node, ast.Constant) else getattr(self.static(node), "value", None)
        return int(found) if isinstance(found, int) and not isinstance(found, bool) else None

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
                    raise CannotError(node, *refuse_statement(node))
                handler(self, node)
            except CannotError as error:
                self.refuse(error, node)
            except AlreadySaidError:
                pass  # what it binds has no kind, and what needs that is not refused again
            except RecursionError:
                self.refuse(CannotError(node, "an expression nested too deeply", "write it in several lines"), node)
            except Exception as error:  # a fault of the translator's own: the user gets its place all the same
                what = f"what the translator does not understand ({type(error).__name__}: {error})"
                self.refuse(CannotError(node, what, "write it in simpler steps"), node)

    def begin_statement(self) -> None:
        """Make room for declarations."""
        slot: list[Any] = []
        self.lines.append(slot)
        self.frames[-1].slot = slot

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

    # ---- expressions

    def value(self, node: ast.expr) -> Value:
        """Return an expression in C."""
        handler = EXPRESSIONS.get(type(node))
        if handler is None:
            raise CannotError(node, *refuse_expression(node))
        return handler(self, node)

    def scalar(self, node: ast.expr) -> Value:
        """Return an expression in C that is a number or truth value."""
        value = self.value(node)
        if not is_scalar(value.kind):
            what = f"{describe(value.kind)} where a number is expected"
            raise CannotError(node, what, "name the field or the index that is meant")
        return value


def refuse_expression(node: ast.AST) -> tuple[str, str]:
    """Return what an expression is that is not of the language, and what to write."""
    return EXPRESSION_ADVICE.get(type(node), (f"the expression {ast.unparse(node)}", "write it in simpler steps"))


def refuse_statement(node: ast.AST) -> tuple[str, str]:
    """Return what a statement is that is not of the language, and what to write."""
    return STATEMENT_ADVICE.get(type(node), ("this statement", "write it in simpler steps"))
