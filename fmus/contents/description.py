"""From a model package's types to FMI 2.0's modelDescription.xml, the same for every kind of FMU."""

import math
from collections.abc import Iterable, Iterator
from importlib.metadata import PackageNotFoundError, version
from typing import Any, NamedTuple
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from fmus.contents.units import unit
from modelkit.model import Model
from modelkit.signal import Signal
from modelkit.variables import variables

GENERATED = "2000-01-01T00:00:00Z"
AUTHOR = "The apa-cosim authors"
"""Date written into every FMU: the content decides the bytes, not the day."""
FMI_TYPES = {float: "Real", int: "Integer", bool: "Boolean"}
LARGEST_INTEGER = 2**31 - 1
TIME = Signal("s", "simulation time")
LOG_CATEGORIES = {
    "logStatusWarning": "Messages with fmi2Warning",
    "logStatusDiscard": "Messages with fmi2Discard",
    "logStatusError": "Messages with fmi2Error: wrong calls, exceptions with their traceback",
    "logStatusFatal": "Messages with fmi2Fatal",
    "logAll": "All messages",
}


class FmiVariable(NamedTuple):
    """One scalar variable of an FMU."""

    name: str
    vr: int
    """Value reference: the place in the list, from 0; one running number over all FMI types."""
    kind: type
    """``float``, ``int`` or ``bool``."""
    causality: str
    variability: str
    initial: str | None
    start: Any
    """Start value of a parameter or input; None for outputs and time, which are calculated."""
    signal: Signal

    @property
    def fmi_type(self) -> str:
        """Return ``Real``, ``Integer`` or ``Boolean``."""
        return FMI_TYPES[self.kind]


def fmi_variables(model: Model) -> list[FmiVariable]:
    """Return all variables in the order of their value references: parameters, inputs, outputs, then ``time``.

    Raises ``ValueError`` for a name used twice, a missing description or a start value outside its range.
    """
    found: list[FmiVariable] = []
    groups = (("parameter", model.params), ("input", model.inputs), ("output", model.outputs))
    for causality, cls in groups:
        for item in variables(cls):
            variability = "fixed" if causality == "parameter" else "continuous" if item.kind is float else "discrete"
            initial = {"parameter": "exact", "input": None, "output": "calculated"}[causality]
            start = None if causality == "output" else item.start
            found.append(
                FmiVariable(item.name, len(found), item.kind, causality, variability, initial, start, item.signal)
            )
    found.append(FmiVariable("time", len(found), float, "independent", "continuous", None, None, TIME))
    _check(model.name, found)
    return found


def describe(variable: FmiVariable) -> str:
    """Return the variable's description: meaning, names of the states, source of a default."""
    signal = variable.signal
    text = signal.text
    if signal.states is not None:
        text += ": " + ", ".join(f"{state.value} {state.name}" for state in signal.states)
    if signal.source:
        text += f" (default: {signal.source})"
    return text


def limits(variable: FmiVariable) -> tuple[float | None, float | None]:
    """Return the smallest and largest value allowed, None where there is no limit; a mode's from its states."""
    if variable.kind is bool:
        return None, None
    low, high = variable.signal.low, variable.signal.high
    if variable.signal.states is not None:
        low, high = max(low, min(variable.signal.states)), min(high, max(variable.signal.states))
    return (low if math.isfinite(low) else None), (high if math.isfinite(high) else None)


def model_description(
    model: Model, *, guid: str, generation_tool: str, flags: dict[str, bool], sources: tuple[str, ...] = ()
) -> bytes:
    """Return modelDescription.xml. ``flags`` are the capability attributes of the CoSimulation element.

    ``sources`` are the files in the folder ``sources`` that a compiler is given.
    """
    known = fmi_variables(model)
    root = Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=model.name,
        guid=guid,
        description=model.description,
        author=AUTHOR,
        version=project_version(),
        copyright="Copyright (c) the apa-cosim authors",
        license="MIT",
        generationTool=generation_tool,
        generationDateAndTime=GENERATED,
        variableNamingConvention="structured",
    )
    root.append(_interface(model, flags, sources))
    root.append(unit_definitions(known))
    categories = SubElement(root, "LogCategories")
    for name, text in LOG_CATEGORIES.items():
        SubElement(categories, "Category", name=name, description=text)
    SubElement(
        root, "DefaultExperiment", startTime="0.0", stopTime=as_text(model.stop_time), stepSize=as_text(model.step_size)
    )
    scalars = SubElement(root, "ModelVariables")
    scalars.extend(_scalar(variable) for variable in known)
    root.append(_structure(known))
    ElementTree.indent(root)
    content: bytes = ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True)
    return content + b"\n"


def _interface(model: Model, flags: dict[str, bool], sources: tuple[str, ...]) -> Element:
    capabilities = {"modelIdentifier": model.name} | {name: as_text(value) for name, value in flags.items()}
    interface = Element("CoSimulation", capabilities)
    if sources:
        files = SubElement(interface, "SourceFiles")
        for name in sources:
            SubElement(files, "File", name=name)
    return interface


def project_version() -> str:
    """Return the version of this project, ``0`` if it runs without having been installed."""
    try:
        return version("apa-cosim")
    except PackageNotFoundError:
        return "0"


def as_text(value: Any) -> str:
    """Return a number or truth value as XML has it; floats with all their digits."""
    return str(value).lower() if isinstance(value, bool) else repr(value)


def unit_definitions(known: Iterable[FmiVariable]) -> Element:
    """Return UnitDefinitions, the same in FMI 2.0 and 3.0."""
    definitions = Element("UnitDefinitions")
    for name in sorted({variable.signal.unit for variable in known if variable.kind is float}):
        this = unit(name)
        node = SubElement(definitions, "Unit", name=name)
        exponents = {base: str(power) for base, power in this.exponents.items()}
        factor = {} if this.factor == 1.0 else {"factor": as_text(this.factor)}
        SubElement(node, "BaseUnit", exponents | factor)
        if this.display is not None:
            SubElement(node, "DisplayUnit", name=this.display, factor=as_text(this.display_factor))
    return definitions


def _scalar(variable: FmiVariable) -> Element:
    attributes = {
        "name": variable.name,
        "valueReference": str(variable.vr),
        "description": describe(variable),
        "causality": variable.causality,
        "variability": variable.variability,
        "initial": variable.initial,
    }
    node = Element("ScalarVariable", {name: value for name, value in attributes.items() if value is not None})
    SubElement(node, variable.fmi_type, dict(_type_attributes(variable)))
    return node


def _type_attributes(variable: FmiVariable) -> Iterator[tuple[str, str]]:
    if variable.kind is float:
        this = unit(variable.signal.unit)
        yield "unit", this.name
        if this.display is not None:
            yield "displayUnit", this.display
    low, high = limits(variable)
    if low is not None:
        yield "min", as_text(variable.kind(low))
    if high is not None:
        yield "max", as_text(variable.kind(high))
    if variable.kind is float and unit(variable.signal.unit).nominal != 1.0:
        yield "nominal", as_text(unit(variable.signal.unit).nominal)
    if variable.start is not None:
        yield "start", as_text(variable.start)


def _structure(known: list[FmiVariable]) -> Element:
    """Return ModelStructure: outputs depend on no input, and at the start on the parameters alone."""
    structure = Element("ModelStructure")
    outputs = [str(variable.vr + 1) for variable in known if variable.causality == "output"]
    parameters = " ".join(str(variable.vr + 1) for variable in known if variable.causality == "parameter")
    for name, dependencies in (("Outputs", ""), ("InitialUnknowns", parameters)):
        if outputs:
            node = SubElement(structure, name)
            for index in outputs:
                SubElement(node, "Unknown", index=index, dependencies=dependencies)
    return structure


def _check(model_name: str, known: list[FmiVariable]) -> None:
    names: set[str] = set()
    for variable in known:
        where = f"{model_name}: {variable.name}"
        if variable.name in names:
            raise ValueError(f"{where}: this name is used twice among parameters, inputs and outputs")
        names.add(variable.name)
        if not variable.signal.text:
            raise ValueError(f"{where}: give the field a unit and a meaning: Annotated[..., Signal(unit, text)]")
        if variable.start is None or variable.kind is bool:
            continue
        low, high = limits(variable)
        if not math.isfinite(variable.start) or (variable.kind is int and abs(variable.start) > LARGEST_INTEGER):
            raise ValueError(f"{where}: start {variable.start} cannot be written in FMI 2.0")
        if (low is not None and variable.start < low) or (high is not None and variable.start > high):
            raise ValueError(f"{where}: start {variable.start} is outside [{low}, {high}]")
