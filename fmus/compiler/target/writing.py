"""The text of the C file and its header: types, constants and functions, in the order of the Python files."""

import ast
import inspect
from collections.abc import Iterable
from enum import IntEnum
from typing import Any

from fmus.compiler.source.reading import field_meanings, plain
from fmus.compiler.source.types import Array, Kind, Mixed, Open, Scalar, Struct, fields_of, hints_of, parts
from fmus.compiler.target.functions import Instance
from fmus.compiler.target.layout import MAX_LINE_LENGTH, comment, flat, indent_and_wrap
from fmus.compiler.target.names import member_name
from fmus.compiler.target.program import Constant, Program
from fmus.compiler.target.values import INT32, float_text, int_text
from modelkit.states import parts_of

NO_FIELD = "none"
"""The only member of a NamedTuple that has no fields."""


class Writer:
    """Writes what a :class:`Program` has found."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.done: set[Any] = set()

    # ---- types

    def struct(self, cls: Any, header: bool) -> list[str]:
        """Return the C type of a NamedTuple, each field with its unit and meaning."""
        name = self.program.types[cls]
        meanings = field_meanings(self.program.library.class_node(cls))
        lines = ["", *self._doc(cls), "typedef struct {"]
        if not fields_of(cls):
            lines.append(f"    bool {NO_FIELD}; /* C has no struct without members */")
        for field, kind in fields_of(cls).items():
            line = f"    {self.program.declaration(kind, member_name(field))};"
            note = signal_text(hints_of(cls)[field]) or meanings.get(field, "")
            lines += with_note(line, note)
        lines.append(f"}} {name};")
        return self._include_guard(cls, name, lines) if header else lines

    def tuple_type(self, kind: Mixed) -> list[str]:
        """Return the C type of a tuple of different kinds."""
        lines = ["", "typedef struct {"]
        lines += [f"    {self.program.declaration(item, f'item{at}')};" for at, item in enumerate(kind.items)]
        return [*lines, f"}} {self.program.mixed[kind]};"]

    def enum(self, cls: type[IntEnum], header: bool) -> list[str]:
        """Return an enum's members as constants."""
        name = self.program.types[cls]
        nodes = [self.program.library.class_node(part) for part in parts_of(cls)]
        meanings = {name: text for node in reversed(nodes) for name, text in field_meanings(node).items()}
        lines = ["", *self._doc(cls), "enum {"]
        last = list(cls.__members__)[-1]
        for word, member in cls.__members__.items():
            comma = "" if word == last else ","
            lines += with_note(f"    {name}_{word} = {int(member)}{comma}", meanings.get(word, ""))
        lines.append("};")
        return self._include_guard(cls, name, lines) if header else lines

    def _include_guard(self, cls: Any, name: str, lines: list[str]) -> list[str]:
        """Return a type of modelkit so that the headers of two models may be included in one file."""
        if not cls.__module__.startswith("modelkit."):
            return lines
        guard = f"MODELKIT_{name.upper()}"
        return ["", f"#ifndef {guard}", f"#define {guard}", *lines[1:], "#endif"]

    def _doc(self, item: Any) -> list[str]:
        text = inspect.cleandoc(item.__doc__ or "") if item.__doc__ else ""
        if text.startswith(f"{getattr(item, '__name__', '')}("):
            text = ""  # made by typing.NamedTuple
        return comment(text) if text else []

    # ---- constants

    def value_lines(self, kind: Kind, value: Any, hint: Any = None) -> list[str]:
        """Return the initializer of a constant: on one line if it fits, else a line for each part."""
        if isinstance(kind, Scalar):
            return [self.scalar_text(value, hint)]
        if not value:
            return [f"{{.{NO_FIELD} = false}}"]
        heads, kinds, values, hints = self._parts(kind, value)
        inner = [self.value_lines(*part) for part in zip(kinds, values, hints, strict=True)]
        if all(len(lines) == 1 for lines in inner):
            one = "{" + ", ".join(head + lines[0] for head, lines in zip(heads, inner, strict=True)) + "}"
            if len(one) < MAX_LINE_LENGTH - 40:
                return [one]
            if isinstance(kind, Array) and isinstance(kind.item, Scalar):
                return [one]
        result = ["{"]
        for head, lines in zip(heads, inner, strict=True):
            result += [head + lines[0], *lines[1:]]
            result[-1] += ","
        result[-1] = result[-1][:-1]
        return [*result, "}"]

    def _parts(self, kind: Kind, value: Any) -> tuple[list[str], list[Kind], list[Any], list[Any]]:
        if isinstance(kind, Struct):
            fields = fields_of(kind.cls)
            hints = [hints_of(kind.cls)[name] for name in fields]
            heads = [f".{member_name(name)} = " for name in fields]
            return heads, list(fields.values()), [getattr(value, name) for name in fields], hints
        if isinstance(kind, Mixed):
            return [f".item{at} = " for at in range(len(value))], list(kind.items), list(value), [None] * len(value)
        assert isinstance(kind, Array | Open)
        return [""] * len(value), [kind.item] * len(value), list(value), [None] * len(value)

    def scalar_text(self, value: Any, hint: Any = None) -> str:
        """Return a number in C; a mode by its name."""
        states = next(
            (mark.states for mark in getattr(hint, "__metadata__", ()) if getattr(mark, "states", None)), None
        )
        if states is not None and not isinstance(value, bool) and value in states._value2member_map_:
            value = states(value)
        if isinstance(value, IntEnum):
            return self.program.member(value).text
        if isinstance(value, bool):
            return "true" if value else "false"
        return int_text(value) if isinstance(value, int) else float_text(value)

    def constants(self, module: str) -> list[str]:
        """Return the constants of a module in its order, then what its NamedTuples are by default."""
        program, known = self.program, self.program.library.module(module)
        found = [(place[1], constant) for place, constant in program.constants.items() if place[0] == module]
        found.sort(key=lambda pair: known.lines.get(pair[0], 0))
        lines = [""] if found else []
        for name, constant in found:
            lines += self.constant(constant, known.meanings.get(name, ""))
        own = [cls for cls in program.defaults if cls.__module__ == module]
        for cls in sorted(own, key=program.defaults.__getitem__):
            lines += ["", f"/* {cls.__name__}() */", *self.static(Struct(cls), program.defaults[cls], cls())]
        return lines

    def constant(self, constant: Constant, meaning: str) -> list[str]:
        """Return a module constant under its own name."""
        note = comment(meaning) if meaning else []
        if isinstance(constant.kind, Scalar):
            text = self.scalar_text(constant.value)
            if isinstance(constant.value, int) and -INT32 < constant.value < INT32:
                return [*note, f"enum {{ {constant.name} = {text} }};"]
            return [*note, f"static const {self.program.declaration(constant.kind, constant.name)} = {text};"]
        return [*note, *self.static(constant.kind, constant.name, constant.value)]

    def static(self, kind: Kind, name: str, value: Any) -> list[str]:
        """Return the definition of a constant struct or table."""
        first, *others = self.value_lines(kind, value)
        lines = [f"static const {self.program.declaration(kind, name)} = {first}", *others]
        lines[-1] += ";"
        return indent_and_wrap(lines)

    def chooser(self, cls: Any) -> list[str]:
        """Return the function that chooses a field of a NamedTuple by its index."""
        name, fields = self.program.choosers[cls], fields_of(cls)
        (kind,) = set(fields.values())
        *others, last = fields
        lines = [f"static {self.program.type_name(kind)} {name}(const {self.program.types[cls]} *from, int64_t index)"]
        lines += ["{", "switch (index) {"]
        for place, field in enumerate(others):
            lines += [f"case {place}:", f"return from->{member_name(field)};"]
        lines += ["default:", f"return from->{member_name(last)};", "}", "}"]
        return ["", f"/* The field of {cls.__name__} that is at an index. */", *indent_and_wrap(lines)]

    # ---- functions

    def function(self, made: Instance) -> list[str]:
        """Return a C function with its docstring."""
        text = ast.get_docstring(made.node) or ""
        if made.changed is not None:
            text = f"{text}\n\nChanges ``{made.changed.name}``.".strip()
        lines = indent_and_wrap([made.head, "{", *flat(made.lines), "}"])
        return ["", *(comment(text) if text else []), *lines]

    def prototypes(self, functions: list[Instance]) -> list[str]:
        """Return declarations of those functions that are called before they are defined."""
        found = []
        for made in functions:
            self.done.add(made.name)
            for called in made.calls:
                if called.name not in self.done:
                    self.done.add(called.name)
                    found.append(called)
        return ["", *(line for made in found for line in indent_and_wrap([f"{made.head};"]))] if found else []


def signal_text(hint: Any) -> str:
    """Return unit and meaning of a field from its ``Signal``."""
    for mark in (*getattr(hint, "__metadata__", ()), *_inner_marks(hint)):
        if hasattr(mark, "unit") and hasattr(mark, "text"):
            unit = "" if mark.unit == "1" else f"[{mark.unit}] "
            states = getattr(mark, "states", None)
            return plain(f"{unit}{mark.text}" + (f": {states.__name__}" if states else ""))
    return ""


def _inner_marks(hint: Any) -> tuple[Any, ...]:
    arguments = getattr(hint, "__args__", ())
    return tuple(mark for item in arguments for mark in getattr(item, "__metadata__", ()))


def with_note(line: str, note: str) -> list[str]:
    """Return a line with a comment beside it, or above it if there is no room."""
    if not note:
        return [line]
    (text, *more) = comment(note, 1)
    if not more and len(line) + 2 + len(text) <= MAX_LINE_LENGTH:
        return [f"{line} {text}"]
    return [f"    {part}" for part in (text, *more)] + [line]


def in_order(classes: Iterable[Any]) -> list[Any]:
    """Return NamedTuples so that each comes after those it contains."""
    done: dict[Any, None] = {}

    def visit(kind: Kind) -> None:
        if isinstance(kind, Struct) and kind.cls in done:
            return
        for part in parts(kind):
            visit(part)
        if isinstance(kind, Struct):
            done[kind.cls] = None

    for cls in classes:
        visit(Struct(cls))
    return list(done)
