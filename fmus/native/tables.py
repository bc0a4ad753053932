"""What the C of an FMU must know of its model's variables: where each is kept, what may be set, and to what.

The lines are read twice by ``core.h``, once for the places and once for names and limits, and once by ``state.c``.
"""

import math
from collections.abc import Mapping, Sequence

from fmus.compiler import Member, members
from fmus.compiler.target.names import member_name
from fmus.contents.arrays import FmiArray, fmi_arrays
from fmus.contents.variables import FmiVariable, fmi_variables, limits
from modelkit.model import Model
from modelkit.store import columns_of
from modelkit.variables import variables

KINDS = {float: "REAL", int: "INTEGER", bool: "BOOLEAN"}
ROLES = {"input": "INPUT", "output": "CALCULATED", "local": "CALCULATED", "independent": "CALCULATED"}
"""Of all causalities but ``parameter``, whose role is its variability."""
ALL_MEMORY = ("params", "inputs", "outputs", "state")
"""Parts of an instance in the order in which they lie in memory."""
VARIABLES_HEAD = """/* The variables in the order of their value references:
 * VARIABLE(place, kind, role, name, least, greatest, shape) */
"""
RUNS_HEAD = """/* Stretches of the memory without padding, RUN(first, last): a serialized state is made of them */
"""


def variables_file(model: Model, fmi: int = 2) -> str:
    """Return a line for each variable of FMI 2.0, where all are scalars, or of FMI 3.0."""
    paths = {item.name: item.path for item in members(model)}
    known: Sequence[FmiArray | FmiVariable] = fmi_arrays(model) if fmi == 3 else fmi_variables(model)
    ordered = sorted(known, key=lambda item: item.vr)
    if [item.vr for item in ordered] != list(range(len(ordered))):
        raise ValueError(f"{model.name}: value references must be 0 to {len(ordered) - 1}, each once")
    return VARIABLES_HEAD + "".join(_line(item, paths) for item in ordered)


def _line(item: FmiArray | FmiVariable, paths: Mapping[str, str]) -> str:
    first = item.first if isinstance(item, FmiArray) else item
    place = "CLOCK" if first.causality == "independent" else f"MODEL({paths[first.name]})"
    kind = "ENUMERATION" if item.fmi_type == "Enumeration" else KINDS[first.kind]
    role = ROLES[first.causality] if first.causality != "parameter" else first.variability.upper()
    low, high = limits(first)
    least, greatest = number(-math.inf if low is None else low), number(math.inf if high is None else high)
    shape = _shape(item, paths) if isinstance(item, FmiArray) and item.shape else "SCALAR"
    return f'VARIABLE({place}, {kind}, {role}, "{item.name}", {least}, {greatest}, {shape})\n'


def _shape(item: FmiArray, paths: Mapping[str, str]) -> str:
    """Return how many elements there are, and the next along each dimension: itself if there is no next."""
    rows, columns = item.shape if len(item.shape) == 2 else (item.shape[0], 1)
    next_row, next_column = (paths[item.elements[place].name] for place in (columns * (rows > 1), columns > 1))
    return (
        f"ARRAY({rows}, {next_row})" if len(item.shape) == 1 else f"TABLE({rows}, {next_row}, {columns}, {next_column})"
    )


def number(value: float) -> str:
    """Return a C constant with all digits of ``value``."""
    if math.isinf(value):
        return "INFINITY" if value > 0.0 else "-INFINITY"
    return repr(float(value))


def longest_name(model: Model) -> int:
    """Return how many characters the longest name has, at most."""
    return max(len(item.name) for item in fmi_variables(model))


def signal_count(model: Model) -> int:
    """Return how many values a call may be about that reads or writes signals: inputs, outputs and the time."""
    return len(variables(model.inputs)) + len(variables(model.outputs)) + 1


def runs_file(model: Model) -> str:
    """Return a line for each stretch of memory without padding.

    Numbers have eight bytes and follow each other without a gap, whatever structs they are in; truth values do so
    within one struct, numbers of a store within one column.
    """
    lines: list[list[str]] = []
    before = None
    for item in members(model, ALL_MEMORY):
        key = _stretch(item)
        if key != before:
            lines.append([item.path, item.path])
        lines[-1][1] = item.path
        before = key
    stores = () if model.store is None else columns_of(model.store)
    lines += [[f"store.{member_name(name)}"] * 2 for name in stores]
    return RUNS_HEAD + "".join(f"RUN({first}, {last})\n" for first, last in lines)


def _stretch(item: Member) -> str:
    return item.path.rpartition(".")[0] if item.kind is bool else "numbers"
