"""From a model package's types to FMI 2.0's modelDescription.xml, the same for every kind of FMU."""

from collections.abc import Iterable, Iterator
from enum import IntEnum
from importlib.metadata import PackageNotFoundError, version
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from fmus.contents.dependencies import initial_dependencies
from fmus.contents.units import unit
from fmus.contents.variables import FmiVariable, describe, limits, mode_types, shown_variables, states_text
from modelkit.model import Model

GENERATED = "2000-01-01T00:00:00Z"
"""Date written into every FMU: the content decides the bytes, not the day."""
AUTHOR = "The apa-cosim authors"
LOG_CATEGORIES = {
    "logStatusWarning": "Messages with fmi2Warning",
    "logStatusDiscard": "Messages with fmi2Discard",
    "logStatusError": "Messages with fmi2Error: wrong calls, exceptions with their traceback",
    "logStatusFatal": "Messages with fmi2Fatal",
    "logAll": "All messages",
}


def model_description(
    model: Model, *, guid: str, generation_tool: str, flags: dict[str, bool], sources: tuple[str, ...] = ()
) -> bytes:
    """Return modelDescription.xml. ``flags`` are the capability attributes of the CoSimulation element.

    ``sources`` are the files in the folder ``sources`` that a compiler is given.
    """
    known = shown_variables(model)
    types = mode_types(model)
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
    used = {variable.signal.states for variable in known}
    if used != {None}:
        root.append(_type_definitions({mode: name for mode, name in types.items() if mode in used}))
    categories = SubElement(root, "LogCategories")
    for name, text in LOG_CATEGORIES.items():
        SubElement(categories, "Category", name=name, description=text)
    SubElement(
        root, "DefaultExperiment", startTime="0.0", stopTime=as_text(model.stop_time), stepSize=as_text(model.step_size)
    )
    scalars = SubElement(root, "ModelVariables")
    scalars.extend(_scalar(variable, types) for variable in known)
    root.append(_structure(known, initial_dependencies(model)))
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


def _type_definitions(types: dict[type[IntEnum], str]) -> Element:
    """Return the modes as Integer types: FMI 2.0's Enumeration is not read by every importer."""
    definitions = Element("TypeDefinitions")
    for mode, name in types.items():
        node = SubElement(definitions, "SimpleType", name=name, description=states_text(mode))
        SubElement(node, "Integer", quantity=name, min=str(int(min(mode))), max=str(int(max(mode))))
    return definitions


def _scalar(variable: FmiVariable, types: dict[type[IntEnum], str]) -> Element:
    attributes = {
        "name": variable.name,
        "valueReference": str(variable.vr),
        "description": describe(variable),
        "causality": variable.causality,
        "variability": variable.variability,
        "initial": variable.initial,
    }
    node = Element("ScalarVariable", {name: value for name, value in attributes.items() if value is not None})
    mode = variable.signal.states
    declared = {} if mode is None else {"declaredType": types[mode]}
    SubElement(node, variable.fmi_type, declared | dict(_type_attributes(variable)))
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


def _structure(known: list[FmiVariable], initial: dict[str, list[str]]) -> Element:
    """Return ModelStructure: outputs depend on no input, and at the start on some parameters (``initial``)."""
    structure = Element("ModelStructure")
    index = {variable.name: str(place) for place, variable in enumerate(known, start=1)}
    outputs = [variable.name for variable in known if variable.causality == "output"]
    if outputs:
        nodes = SubElement(structure, "Outputs"), SubElement(structure, "InitialUnknowns")
        for name in outputs:
            SubElement(nodes[0], "Unknown", index=index[name], dependencies="")
            SubElement(
                nodes[1], "Unknown", index=index[name], dependencies=" ".join(index[item] for item in initial[name])
            )
    return structure
