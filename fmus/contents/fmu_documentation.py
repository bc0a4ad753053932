"""What an FMU of any kind carries beside its code: page, licence, icon, terminals, reference result."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from fmus.contents.arrays import visible_arrays
from fmus.contents.pages import index_page
from fmus.contents.variables import visible_variables
from fmus.contents.xml_file import xml_bytes
from modelkit.model import Model, Terminal
from modelkit.variables import flattener, variables

HERE = Path(__file__).parent
LS_REF = "extra/org.fmi-standard.fmi-ls-ref"
LS_NAMESPACE = "http://fmi-standard.org/fmi-ls-manifest"
MOST_ROWS = 600
Run = Callable[[Model, Iterable[int]], Iterator[list[float]]]
"""``run(model, steps)``: outputs at the start and after each step [ns], with the inputs at their start values."""
SQUARE = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
ALL_PORTS = (
    Terminal("inputs", "all inputs, by name", ("all inputs",)),
    Terminal("outputs", "all outputs, by name", ("all outputs",)),
)


def documentation(model: Model, needs: str, fmi: int = 2) -> dict[str, bytes]:
    """Return path -> content; ``needs`` is HTML that says what the host must have."""
    return {
        "documentation/index.html": index_page(model, needs, fmi),
        "documentation/licenses/license.txt": (HERE / "license.txt").read_bytes(),
        "terminalsAndIcons/icon.png" if fmi == 3 else "model.png": (HERE / "icon.png").read_bytes(),
        "terminalsAndIcons/terminalsAndIcons.xml": terminals(model, fmi),
    }


def terminals(model: Model, fmi: int = 2) -> bytes:
    """Return terminalsAndIcons.xml, as FMI 3.0 defines it and FMI 2.0 may have it: buses of signals, and the icon.

    Its version is that of the model description: FMI Library refuses an FMU in which the two differ.
    """
    if fmi == 3:
        ports = {item.name: item.first.causality for item in visible_arrays(model)}
    else:
        ports = {item.name: item.causality for item in visible_variables(model)}
    root = Element("fmiTerminalsAndIcons", fmiVersion=f"{fmi}.0")
    picture = SubElement(root, "GraphicalRepresentation")
    SubElement(picture, "CoordinateSystem", SQUARE, suggestedScalingFactorTo_mm="0.1")
    SubElement(picture, "Icon", SQUARE)
    node = SubElement(root, "Terminals")
    for name, text, members in model.terminals or ALL_PORTS:
        chosen = [port for port, causality in ports.items() if _is_member(port, causality, members)]
        if chosen:
            terminal = SubElement(node, "Terminal", name=name, matchingRule="bus", description=text)
            for port in chosen:
                attributes = {"variableName": port, "memberName": port, "variableKind": "signal"}
                SubElement(terminal, "TerminalMemberVariable", attributes)
    return xml_bytes(root)


def _is_member(port: str, causality: str, members: tuple[str, ...]) -> bool:
    """Return whether an input or output is one of ``members``, or in one of them, or all of its kind are meant."""
    if causality not in ("input", "output"):
        return False
    return f"all {causality}s" in members or any(re.match(rf"{re.escape(name)}(?![^.\[])", port) for name in members)


def in_python(model: Model, steps: Iterable[int]) -> Iterator[list[float]]:
    """Run the model's own functions: a ``Run``."""
    params, inputs = model.first_params(), model.inputs()
    step = model.stepper(model.new_store())
    state, outputs = model.initialize(params)
    flat = flattener(outputs)
    yield flat(outputs)
    for dt_ns in steps:
        state, outputs = step(state, inputs, params, dt_ns)
        yield flat(outputs)


@cache
def reference_result(model: Model, run: Run = in_python) -> Mapping[str, bytes]:
    """Return path -> content of the default experiment's outputs, inputs at their start values, and its manifest.

    The rows are at whole multiples of the default step, at most about 600 of them. They are the same in each kind of
    FMU and take seconds.
    """
    file = f"{model.name}_out.csv"
    ElementTree.register_namespace("fmi-ls", LS_NAMESPACE)
    names = {"name": "org.fmi-standard.fmi-ls-ref", "version": "1.0.0-alpha.1", "description": "Reference results"}
    root = Element("fmiReferences", {f"{{{LS_NAMESPACE}}}fmi-ls-{key}": value for key, value in names.items()})
    SubElement(
        root, "Related", type="text/csv", source=file, role="result", description="Outputs of the default experiment"
    )
    outputs = {item.name for item in visible_variables(model) if item.causality == "output"}
    kept = [place for place, item in enumerate(variables(model.outputs)) if item.name in outputs]
    lines = [",".join(f'"{name}"' for name in ["time", *(variables(model.outputs)[place].name for place in kept)])]
    lines += [",".join(repr(float(value)) for value in row) for row in _rows(model, kept, run)]
    table = ("\n".join(lines) + "\n").encode()
    return {f"{LS_REF}/fmi-ls-manifest.xml": xml_bytes(root), f"{LS_REF}/{file}": table}


def _rows(model: Model, kept: list[int], run: Run) -> Iterator[list[float]]:
    """Yield [time, outputs...] of the default experiment; of the outputs those at the places ``kept``."""
    count = round(model.stop_time / model.step_size)
    every = max(1, -(-count // MOST_ROWS))
    ends = [round(number * model.step_size * 1e9) for number in range(count + 1)]
    steps = (end - begin for begin, end in pairwise(ends))
    for number, outputs in enumerate(run(model, steps)):
        if number % every == 0:
            yield [number * model.step_size, *(outputs[place] for place in kept)]
