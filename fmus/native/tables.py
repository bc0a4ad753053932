"""What the C of an FMU must know of its model's variables: where each is kept, what may be set, and to what.

The lines are read twice by ``core.h``, once for the places and once for names and limits, and once by ``state.c``.
"""

import math
from collections.abc import Iterable, Mapping

from fmus.compiler import Member, members
from fmus.contents.description import FmiVariable, fmi_variables, limits
from modelkit.model import Model

KINDS = {float: "REAL", int: "INTEGER", bool: "BOOLEAN"}
ROLES = {"input": "INPUT", "output": "CALCULATED", "local": "CALCULATED", "independent": "CALCULATED"}
"""Of all causalities but ``parameter``, whose role is its variability."""
VARIABLES_HEAD = """/* The variables in the order of their value references:
 * VARIABLE(place, kind, role, name, least, greatest, shape) */
"""
RUNS_HEAD = """/* Stretches of the model's memory without padding, RUN(first, last): what a serialized state is made of. */
"""


def variables_file(model: Model) -> str:
    """Return a line for each FMI 2.0 variable."""
    known = fmi_variables(model)
    check_references([item.vr for item in known])
    paths = member_paths(model)
    lines = (
        variable_line(item, place_of(item.name, paths), KINDS[item.kind], item.name, "SCALAR")
        for item in sorted(known, key=lambda item: item.vr)
    )
    return VARIABLES_HEAD + "".join(lines)


def check_references(references: Iterable[int]) -> None:
    """Raise ``ValueError`` unless the value references are 0, 1, 2... in some order."""
    found = sorted(references)
    if found != list(range(len(found))):
        raise ValueError(f"value references must be 0 to {len(found) - 1}, each once")


def member_paths(model: Model) -> dict[str, str]:
    """Return flat name -> C expression of the member, below the struct of all memory."""
    return {item.name: item.path for item in members(model)}


def place_of(name: str, paths: Mapping[str, str]) -> str:
    """Return the C expression of a variable's offset."""
    return "CLOCK" if name == "time" else f"MODEL({paths[name]})"


def variable_line(item: FmiVariable, place: str, kind: str, name: str, shape: str) -> str:
    """Return the line of one variable, or of one array whose first element is ``item``."""
    role = ROLES[item.causality] if item.causality != "parameter" else item.variability.upper()
    low, high = limits(item)
    least, greatest = number(-math.inf if low is None else low), number(math.inf if high is None else high)
    return f'VARIABLE({place}, {kind}, {role}, "{name}", {least}, {greatest}, {shape})\n'


def number(value: float) -> str:
    """Return a C constant with all digits of ``value``."""
    if math.isinf(value):
        return "INFINITY" if value > 0.0 else "-INFINITY"
    return repr(float(value))


def longest_name(model: Model) -> int:
    """Return how many characters the longest name has."""
    return max(len(item.name) for item in fmi_variables(model))


def runs_file(model: Model) -> str:
    """Return a line for each stretch of memory without padding.

    Numbers have eight bytes and follow each other without a gap, whatever structs they are in; truth values do so
    within one struct.
    """
    lines: list[list[str]] = []
    before = None
    for item in members(model, state=True):
        key = _stretch(item)
        if key != before:
            lines.append([item.path, item.path])
        lines[-1][1] = item.path
        before = key
    return RUNS_HEAD + "".join(f"RUN({first}, {last})\n" for first, last in lines)


def _stretch(item: Member) -> str:
    return item.path.rpartition(".")[0] if item.kind is bool else "numbers"
