"""What the C of an FMU must know of its model's variables: where each is kept, what may be set, and to what.

The lines are read twice by ``core.h``, once for the places and once for names and limits, and once by ``state.c``.
"""

import math
from collections.abc import Mapping, Sequence

from fmus.compiler import Member, members
from fmus.contents.arrays import FmiArray, fmi_arrays
from fmus.contents.description import FmiVariable, fmi_variables, limits
from modelkit.model import Model

KINDS = {float: "REAL", int: "INTEGER", bool: "BOOLEAN"}
ROLES = {"input": "INPUT", "output": "CALCULATED", "local": "CALCULATED", "independent": "CALCULATED"}
"""Of all causalities but ``parameter``, whose role is its variability."""
VARIABLES_HEAD = """/* The variables in the order of their value references:
 * VARIABLE(place, kind, role, name, least, greatest, shape) */
"""
RUNS_HEAD = """/* Stretches of the memory without padding, RUN(first, last): a serialized state is made of them */
"""


def variables_file(model: Model, fmi: int = 2) -> str:
    """Return a line for each variable of FMI 2.0, where all are scalars, or of FMI 3.0."""
    paths = {item.name: item.path for item in members(model)}
    known = fmi_arrays(model) if fmi == 3 else [_alone(item) for item in fmi_variables(model)]
    ordered = sorted(known, key=lambda item: item.vr)
    if [item.vr for item in ordered] != list(range(len(ordered))):
        raise ValueError(f"{model.name}: value references must be 0 to {len(ordered) - 1}, each once")
    return VARIABLES_HEAD + "".join(_line(item, paths) for item in ordered)


def _alone(item: FmiVariable) -> FmiArray:
    return FmiArray(item.name, item.vr, (item,), ())


def _line(item: FmiArray, paths: Mapping[str, str]) -> str:
    first = item.first
    place = "CLOCK" if first.causality == "independent" else f"MODEL({paths[first.name]})"
    kind = "ENUMERATION" if item.states is not None else KINDS[first.kind]
    role = ROLES[first.causality] if first.causality != "parameter" else first.variability.upper()
    low, high = limits(first)
    least, greatest = number(-math.inf if low is None else low), number(math.inf if high is None else high)
    shape = _shape(item.shape, [paths[element.name] for element in item.elements] if item.shape else [])
    return f'VARIABLE({place}, {kind}, {role}, "{item.name}", {least}, {greatest}, {shape})\n'


def _shape(shape: Sequence[int], paths: Sequence[str]) -> str:
    """Return how many elements there are, and the next along each dimension: itself if there is no next."""
    if not shape:
        return "SCALAR"
    columns = shape[1] if len(shape) == 2 else 1
    next_row = paths[columns if shape[0] > 1 else 0]
    if len(shape) == 1:
        return f"ARRAY({shape[0]}, {next_row})"
    return f"TABLE({shape[0]}, {next_row}, {columns}, {paths[1 if columns > 1 else 0]})"


def number(value: float) -> str:
    """Return a C constant with all digits of ``value``."""
    if math.isinf(value):
        return "INFINITY" if value > 0.0 else "-INFINITY"
    return repr(float(value))


def longest_name(model: Model) -> int:
    """Return how many characters the longest name has, at most."""
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
