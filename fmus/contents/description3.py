"""From a model package's types to FMI 3.0's modelDescription.xml."""

from collections.abc import Iterator, Mapping
from enum import IntEnum
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from fmus.contents.arrays import FmiArray, shown_arrays
from fmus.contents.dependencies import initial_dependencies
from fmus.contents.description import AUTHOR, GENERATED, LOG_CATEGORIES, as_text, project_version, unit_definitions
from fmus.contents.units import unit
from fmus.contents.variables import describe, limits, mode_types
from modelkit.model import Model

States = Mapping[type[IntEnum], str]
"""Enumeration -> name of its type in the FMU."""


def model_description3(model: Model, *, token: str, generation_tool: str, flags: Mapping[str, bool]) -> bytes:
    """Return modelDescription.xml. ``flags`` are the capability attributes of the CoSimulation element."""
    known = shown_arrays(model)
    types = mode_types(model)
    root = Element(
        "fmiModelDescription",
        fmiVersion="3.0",
        modelName=model.name,
        instantiationToken=token,
        description=model.description,
        author=AUTHOR,
        version=project_version(),
        copyright="Copyright (c) the apa-cosim authors",
        license="MIT",
        generationTool=generation_tool,
        generationDateAndTime=GENERATED,
        variableNamingConvention="structured",
    )
    SubElement(
        root, "CoSimulation", {"modelIdentifier": model.name} | {name: as_text(value) for name, value in flags.items()}
    )
    root.append(unit_definitions(item.first for item in known))
    used = {item.states for item in known}
    root.extend(_type_definitions({mode: name for mode, name in types.items() if mode in used}))
    categories = SubElement(root, "LogCategories")
    for name, text in LOG_CATEGORIES.items():
        SubElement(categories, "Category", name=name, description=text.replace("fmi2", "fmi3"))
    SubElement(
        root,
        "DefaultExperiment",
        startTime="0.0",
        stopTime=as_text(model.stop_time),
        stepSize=as_text(model.step_size),
    )
    SubElement(root, "ModelVariables").extend(_variable(item, types) for item in known)
    root.append(_structure(known, initial_dependencies(model)))
    ElementTree.indent(root)
    content: bytes = ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True)
    return content + b"\n"


def _type_definitions(types: States) -> Iterator[Element]:
    if types:
        definitions = Element("TypeDefinitions")
        for states, name in types.items():
            node = SubElement(definitions, "EnumerationType", name=name)
            for state in states:
                SubElement(node, "Item", name=state.name, value=str(state.value))
        yield definitions


def _variable(item: FmiArray, types: States) -> Element:
    attributes = {
        "name": item.name,
        "valueReference": str(item.vr),
        "description": describe(item.first._replace(signal=item.first.signal._replace(states=None))),
        "causality": item.first.causality,
        "variability": item.first.variability,
        "initial": item.first.initial,
    }
    node = Element(item.fmi_type, {name: value for name, value in attributes.items() if value is not None})
    node.attrib.update(_type_attributes(item, types))
    if item.starts:
        node.set("start", " ".join(as_text(item.first.kind(value)) for value in item.starts))
    for size in item.shape:
        SubElement(node, "Dimension", start=str(size))
    return node


def _type_attributes(item: FmiArray, types: States) -> Iterator[tuple[str, str]]:
    if item.states is not None:
        yield "declaredType", types[item.states]
    if item.first.kind is float:
        this = unit(item.first.signal.unit)
        yield "unit", this.name
        if this.display is not None:
            yield "displayUnit", this.display
    low, high = limits(item.first)
    if low is not None:
        yield "min", as_text(item.first.kind(low))
    if high is not None:
        yield "max", as_text(item.first.kind(high))
    if item.first.kind is float and unit(item.first.signal.unit).nominal != 1.0:
        yield "nominal", as_text(unit(item.first.signal.unit).nominal)


def _structure(known: list[FmiArray], initial: Mapping[str, list[str]]) -> Element:
    """Return ModelStructure: outputs depend on no input, and at the start on some parameters (``initial``)."""
    structure = Element("ModelStructure")
    outputs = [item for item in known if item.first.causality == "output"]
    for item in outputs:
        SubElement(structure, "Output", valueReference=str(item.vr), dependencies="")
    for item in outputs:
        causes = {name for element in item.elements for name in initial[element.name]}
        dependencies = " ".join(str(other.vr) for other in known if any(one.name in causes for one in other.elements))
        SubElement(structure, "InitialUnknown", valueReference=str(item.vr), dependencies=dependencies)
    return structure
