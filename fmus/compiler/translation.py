"""From a model to the text of its header and its C file."""

from typing import Any, NamedTuple

from fmus.compiler import arithmetic, calls, conditions, loops, runtime, statements, tuples
from fmus.compiler.entries import NAMES, Entries, roots
from fmus.compiler.functions import Instance
from fmus.compiler.kinds import Kind, Mixed, NoKindError, Struct
from fmus.compiler.layout import laid_out
from fmus.compiler.program import Program
from fmus.compiler.refusals import AlreadySaidError, CannotError, Refused
from fmus.compiler.writing import Writer, types_in_order
from modelkit.model import Model

LANGUAGE = (arithmetic, calls, conditions, loops, statements, tuples)
"""The files that know what to make of each part of the language."""


class Translation(NamedTuple):
    """A model in C99."""

    name: str
    header: str
    source: str


def translate(model: Model) -> Translation:
    """Return the C99 of ``model``; ``Refused`` says all that stands in the way."""
    interface = [model.state, model.params, model.inputs, model.outputs]
    program = Program(model.name, roots(model), interface, NAMES)
    entries = Entries(program, model)
    try:
        for cls in interface:
            program.need(Struct(cls))
        functions = entries.texts()
    except (CannotError, NoKindError) as error:
        node = getattr(error, "node", None)
        program.refuse(model.initialize.__module__, node, error.what, error.advice)
    except AlreadySaidError:
        pass
    if program.refusals:
        raise Refused(program.refusals)
    types = types_in_order([Struct(cls) for cls in interface])
    return Translation(model.name, header(program, model, entries, types), source(program, entries, functions, types))


def header(program: Program, model: Model, entries: Entries, types: list[Kind]) -> str:
    """Return the text of the header: types of the interface and the three functions."""
    writer = Writer(program)
    guard = f"{model.name.upper()}_H"
    classes = [kind.cls for kind in types if isinstance(kind, Struct)]
    lines = [f"/* {model.name}: {model.description}. Made from Python, see {model.package.__name__}. */"]
    lines += [f"#ifndef {guard}", f"#define {guard}", "", "#include <stdbool.h>", "#include <stdint.h>"]
    for enum in interface_enums(program, classes):
        program.enums.discard(enum)
        lines += writer.enum(enum, header=True)
    for cls in classes:
        lines += writer.struct(cls, header=True)
    lines += ["", "/* All memory of an instance. */", "typedef struct {"]
    lines += [f"    {type_name} {group};" for group, type_name in entries.types().items()]
    lines += [f"}} {model.name};", "", "#ifdef __cplusplus", 'extern "C" {', "#endif"]
    for head, meaning in zip(entries.heads(), MEANINGS, strict=True):
        lines += ["", f"/* {meaning} */", *laid_out([f"{head};"])]
    lines += ["", "#ifdef __cplusplus", "}", "#endif", "", "#endif", ""]
    return "\n".join(lines)


MEANINGS = (
    "Start values of parameters and inputs.",
    "State and outputs at time zero.",
    "State and outputs dt_ns nanoseconds later, the inputs held. The pointers must not overlap.",
)


def interface_enums(program: Program, classes: list[Any]) -> list[Any]:
    """Return the enums that the fields of the interface have as their values' names."""
    from fmus.compiler.kinds import hints_of

    found: dict[Any, None] = {}
    for cls in classes:
        for hint in hints_of(cls).values():
            for mark in getattr(hint, "__metadata__", ()):
                states = getattr(mark, "states", None)
                if states is not None and states in program.types:
                    found[states] = None
    return list(found)


def source(program: Program, entries: Entries, texts: list[list[str]], types: list[Kind]) -> str:
    """Return the text of the C file."""
    writer = Writer(program)
    known = set(types)
    by_module: dict[str, list[str]] = {module: [] for module in program.modules}
    inner = types_in_order([*(Struct(cls) for cls in program.structs), *program.mixed])
    in_interface = {kind.cls for kind in known if isinstance(kind, Struct)}
    named_in_header = set(interface_enums(program, list(in_interface)))
    functions = sorted(program.instances.values(), key=lambda made: _order(program, made))
    body: list[str] = []
    mixed = [kind for kind in inner if isinstance(kind, Mixed)]
    tail: dict[str, list[str]] = {}
    for module in program.modules:
        own = [made for made in functions if made.function.__module__ == module]
        section = _constants_and_types(program, writer, module, inner, in_interface, named_in_header)
        by_module[module] = section
        tail[module] = [line for made in own for line in writer.function(made)]
    placed: set[Any] = set(in_interface)
    for module in program.modules:
        section = by_module[module]
        placed |= {cls for cls in program.structs if cls.__module__ == module}
        ready = [kind for kind in mixed if kind not in placed and _all_placed(kind, placed)]
        placed |= set(ready)
        pairs = [line for kind in ready for line in writer.mixed(kind)]
        own = [made for made in functions if made.function.__module__ == module]
        prototypes = writer.prototypes(own)
        lines = section + pairs + (["", *prototypes] if prototypes else []) + tail[module]
        if lines:
            file = program.library.module(module).file
            body += ["", f"/* {'-' * 8} {file} {'-' * (100 - len(file))} */", *lines]
    head = [f"/* {entries.model.name} in C99. Made from Python, see the comment before each part. */", ""]
    head += [f'#include "{entries.model.name}.h"', "", "#include <math.h>", "", *PRAGMA]
    helpers = runtime.text(program.helpers)
    rule = f"/* {'-' * 8} entries {'-' * 93} */"
    ends = [line for lines in texts for line in ["", *laid_out(lines)]]
    return "\n".join([*head, *helpers, *body, "", rule, *ends, ""])


PRAGMA = (
    "#if defined(__clang__)",
    "#pragma STDC FP_CONTRACT OFF",
    "#elif defined(_MSC_VER)",
    "#pragma fp_contract(off)",
    "#endif",
)
"""gcc has no such pragma: there it is the option -ffp-contract=off."""


def _all_placed(kind: Kind, placed: set[Any]) -> bool:
    from fmus.compiler.kinds import parts

    if isinstance(kind, Struct):
        return kind.cls in placed
    if isinstance(kind, Mixed) and kind in placed:
        return True
    return all(_all_placed(part, placed) for part in parts(kind))


def _order(program: Program, made: Instance) -> tuple[int, int, str]:
    module = made.function.__module__
    return program.modules.index(module), made.node.lineno, made.name


def _constants_and_types(
    program: Program, writer: Writer, module: str, types: list[Kind], header_types: set[Any], header_enums: set[Any]
) -> list[str]:
    lines: list[str] = []
    for enum in sorted(program.enums, key=lambda item: program.types[item]):
        if enum.__module__ == module and enum not in header_enums:
            lines += writer.enum(enum, header=False)
    for kind in types:
        if isinstance(kind, Struct) and kind.cls.__module__ == module and kind.cls not in header_types:
            lines += writer.struct(kind.cls, header=False)
    for cls, name in program.choosers.items():
        if cls.__module__ == module:
            lines += writer.chooser(cls, name)
    known = program.library.module(module)
    constants = [(place[1], found) for place, found in program.constants.items() if place[0] == module]
    constants.sort(key=lambda pair: known.lines.get(pair[0], 0))
    if constants:
        lines.append("")
    for name, constant in constants:
        lines += writer.constant(constant, known.meanings.get(name, ""))
    defaults = [cls for cls in program.defaults if cls.__module__ == module]
    for cls in sorted(defaults, key=lambda item: program.defaults[item]):
        note = f"/* {cls.__name__}() */"
        lines += ["", note, *writer.static(Struct(cls), program.defaults[cls], cls())]
    return lines
