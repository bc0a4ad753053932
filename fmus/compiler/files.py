"""The two files of a translated model: the header, and the C file with a section for each Python file."""

import re
from collections.abc import Iterable
from typing import Any

from fmus.compiler.entries import Entries
from fmus.compiler.source.types import Mixed, hints_of
from fmus.compiler.target import runtime
from fmus.compiler.target.functions import Instance
from fmus.compiler.target.layout import comment, indent_and_wrap
from fmus.compiler.target.program import Program
from fmus.compiler.target.writing import Writer, in_order
from modelkit.model import Model

MEANINGS = (
    "Start values of parameters and inputs.",
    "State and outputs at time zero.",
    "State and outputs dt_ns nanoseconds later, the inputs held. The pointers must not overlap.",
)
PRAGMA = (
    "#if defined(__clang__)",
    "#pragma STDC FP_CONTRACT OFF",
    "#elif defined(__GNUC__)",
    '#pragma GCC optimize ("fp-contract=off", "rounding-math")',
    "#elif defined(_MSC_VER)",
    "#pragma fp_contract(off)",
    "#endif",
)
"""No a * b + c rounded once; and sin() of what is known is left to the C library, where compilers have their own."""


class Files:
    """The text of what a :class:`Program` has found."""

    def __init__(self, program: Program, entries: Entries, model: Model) -> None:
        self.program, self.entries, self.model = program, entries, model
        self.writer = Writer(program)
        stores = [] if model.store is None else [model.store]
        self.classes = in_order([model.params, model.inputs, model.outputs, model.state, *stores])
        self.enums = self._enums()
        self.tuples: set[Mixed] = set()
        """Tuples of different kinds that have their type already."""

    def _enums(self) -> list[Any]:
        """Return the enums that name the values of fields in the header."""
        hints = [hint for cls in self.classes for hint in hints_of(cls).values()]
        marks = [mark for hint in hints for mark in getattr(hint, "__metadata__", ())]
        found = dict.fromkeys(getattr(mark, "states", None) for mark in marks)
        return [enum for enum in found if enum is not None and enum in self.program.types]

    def header(self) -> str:
        """Return the text of the header: the types of the interface and the three functions."""
        name, writer = self.model.name, self.writer
        guard = f"{name.upper()}_H"
        packages = " and ".join(package.__name__ for package in self.model.sources())
        lines = comment(f"{name}: {self.model.description}.\nMade from the Python of {packages}.")
        lines += [f"#ifndef {guard}", f"#define {guard}", "", "#include <stdbool.h>", "#include <stdint.h>"]
        lines += [line for enum in self.enums for line in writer.enum(enum, header=True)]
        lines += [line for cls in self.classes for line in writer.struct(cls, header=True)]
        lines += ["", "/* All memory of an instance. */", "typedef struct {"]
        lines += [f"    {type_name} {group};" for group, type_name in self.entries.types().items()]
        lines += [f"}} {name};", "", "#ifdef __cplusplus", 'extern "C" {', "#endif"]
        for head, meaning in zip(self.entries.heads(), MEANINGS, strict=True):
            lines += ["", f"/* {meaning} */", *indent_and_wrap([f"{head};"])]
        return "\n".join([*lines, "", "#ifdef __cplusplus", "}", "#endif", "", "#endif", ""])

    def source(self, entries: list[list[str]]) -> str:
        """Return the text of the C file."""
        program = self.program
        constants = {module: self.writer.constants(module) for module in program.modules}  # may name more enums
        sections: list[str] = []
        for module in program.modules:
            lines = self._section(module, constants[module])
            sections += [*_rule(program.library.module(module).file), *lines] if lines else []
        head = [f"/* {self.model.name} in C99, made from Python: each part says from which file. */", ""]
        head += [f'#include "{self.model.name}.h"', "", "#include <math.h>", "", *PRAGMA]
        ends = [line for lines in entries for line in ["", *indent_and_wrap(lines)]]
        return "\n".join([*head, *runtime.text(program.helpers), *sections, *_rule("entries"), *ends, ""])

    def _section(self, module: str, constants: list[str]) -> list[str]:
        """Return what one Python file has become: types, constants, functions."""
        program, writer = self.program, self.writer
        known = {*self.classes, *self.enums}
        enums = sorted((item for item in self._own(program.enums, module) if item not in known), key=_name)
        classes = [cls for cls in self._own(in_order(program.structs), module) if cls not in known]
        functions = [made for made in program.instances.values() if made.function.__module__ == module]
        functions.sort(key=_line)
        types = [line for enum in enums for line in writer.enum(enum, header=False)]
        types += [line for cls in classes for line in writer.struct(cls, header=False)]
        types += [line for cls in self._own(program.choosers, module) for line in writer.chooser(cls)]
        rest = constants + writer.prototypes(functions)
        rest += [line for made in functions for line in writer.function(made)]
        tuples = [kind for kind, name in program.mixed.items() if kind not in self.tuples and _mentions(rest, name)]
        self.tuples |= set(tuples)
        return [*types, *(line for kind in tuples for line in writer.tuple_type(kind)), *rest]

    def _own(self, items: Iterable[Any], module: str) -> list[Any]:
        return [item for item in items if item.__module__ == module]


def _rule(title: str) -> list[str]:
    return ["", f"/* {'-' * 8} {title} {'-' * (100 - len(title))} */"]


def _name(enum: Any) -> str:
    return str(enum.__name__)


def _line(made: Instance) -> tuple[int, str]:
    return made.node.lineno, made.name


def _mentions(lines: list[str], name: str) -> bool:
    return any(re.search(rf"\b{name}\b", line) for line in lines)
