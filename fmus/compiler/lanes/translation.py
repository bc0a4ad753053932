"""From the translator's C to the same model in lanes."""

from fmus.compiler.lanes.expressions import HELPERS, Expressions
from fmus.compiler.lanes.kinds import INT, Kind, LaneArray, LaneStruct, Number, declaration, type_name
from fmus.compiler.lanes.reading import Declarations, is_table
from fmus.compiler.lanes.statements import Function, signature
from fmus.compiler.slicing import Slice
from fmus.compiler.target import runtime
from fmus.compiler.translation import Translation

IN_VECTORS = ("int_abs", "int_min", "int_max", "float_min", "float_max", "index_in", "int_of",
              "shift_left", "shift_right")  # fmt: skip
"""Functions of the runtime that ``lanes.h`` has in a form for vectors."""


def lanes_of(code: Translation, outputs: str, live: Slice) -> str:
    """Return the C in lanes of the slice ``live`` of a model, made of its ``code``.

    ``outputs``: the struct of its outputs. Raises ``NoLanesError`` where there is no form in lanes.
    """
    live_fields = frozenset(name.partition(".")[0].partition("[")[0] for name in live.outputs)
    file = Declarations(code.header, code.source, outputs, live_fields)
    needed: set[str] = set()
    calls: list[int] = []
    functions = [line for node in file.functions.values() for line in ["", *Function(file, needed, calls, node).text()]]
    constants = _constants(file)
    lines = [
        f"/* {code.name} in lanes. */",
        "#include <math.h>",
        "#include <stdint.h>",
        *runtime.text(set(runtime.TEXTS)),
        '#include "lane_math.h"',
        *_helpers(needed),
        "",
    ]
    for name, value in file.lengths.items():
        if name not in ("true", "false"):
            lines.append(f"#define {name} INT64_C({value})")
    for name, fields in file.structs.items():
        body = [f"    {declaration(kind, field)};" for field, kind in fields.items()]
        lines += ["", "typedef struct {", *body, f"}} {name};"]
    for name in file.structs:
        lines += _struct_functions(file, name)
    lines += ["", f"#define LANE_CALLS (LANE_FUNCTIONS + {len(calls)})", "", *constants, ""]
    lines += [f"{signature(file, name)};" for name in file.functions]
    return "\n".join([*lines, *functions, ""])


def _constants(file: Declarations) -> list[str]:
    write = Expressions(file, set(), [])
    lines = []
    for name, kind in file.constants.items():
        if not is_table(kind):
            kind = _own(kind)
        node = file.initials[name]
        lines.append(f"static const {declaration(kind, name)} = {write.initial(node, kind)};")
        file.constants[name] = kind
    return lines


def _own(kind: Kind) -> Kind:
    if isinstance(kind, Number):
        return Number(kind.name, False)
    return LaneArray(_own(kind.item), kind.length) if isinstance(kind, LaneArray) else kind


def _struct_functions(file: Declarations, name: str) -> list[str]:
    """Return the functions that put a struct into some lanes, and take one lane of a struct."""
    put = [f"static inline void {name}_put({name} *to, const {name} *from, lane_i where)", "{"]
    take = [f"static inline void {name}_take({name} *to, const {name} *from, int l)", "{"]
    for field, kind in file.structs[name].items():
        put += _each(field, kind, "from->")
        take += _each(field, kind, "from->", "l")
    return ["", *put, "}", "", *take, "}"]


def _each(field: str, kind: Kind, source: str, lane: str = "") -> list[str]:
    lines, index, depth = [], "", 1
    while isinstance(kind, LaneArray):
        lines.append(f"{'    ' * depth}for (int i{depth} = 0; i{depth} < {kind.length}; ++i{depth})")
        index += f"[i{depth}]"
        depth, kind = depth + 1, kind.item
    to, value = f"to->{field}{index}", f"{source}{field}{index}"
    if isinstance(kind, LaneStruct):
        text = f"{kind.name}_take(&{to}, &{value}, l);" if lane else f"{kind.name}_put(&{to}, &{value}, where);"
    elif lane:
        text = f"{to}[l] = {value}[l];"
    else:
        assert isinstance(kind, Number)
        text = f"{to} = lane_pick_{kind.name[0]}(where, {value}, {to});"
    return [*lines, f"{'    ' * depth}{text}"]


def _helpers(needed: set[str]) -> list[str]:
    """Return the functions of the runtime that are called lane by lane."""
    lines = []
    for name, (result, *kinds) in HELPERS.items():
        if name in needed and name not in IN_VECTORS:
            params = ", ".join(declaration(kind, f"x{place}") for place, kind in enumerate(kinds))
            given = ", ".join(f"x{place}[l]" for place in range(len(kinds)))
            lines += ["", f"static inline {type_name(result)} lane_{name}({params})", "{"]
            lines += [f"    {type_name(result)} r;", *_shortcut(name, result, kinds)]
            lines += [f"    LANE_EACH(l) r[l] = {name}({given});", "    return r;", "}"]
    return lines


def _shortcut(name: str, result: Number, kinds: list[Number]) -> list[str]:
    """Return the line that calls a function of integers once where all lanes have the same ones."""
    if INT not in kinds:
        return []
    differ = " | ".join(f"(x{place} != x{place}[0])" for place in range(len(kinds)))
    call = f"{name}({', '.join(f'x{place}[0]' for place in range(len(kinds)))})"
    return [f"    if (!lane_any({differ})) return LANE_{'DOUBLE' if result.name == 'double' else 'INT'}({call});"]
