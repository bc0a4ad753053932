"""From a model package's types to FMI 3.0's modelDescription.xml."""

from collections.abc import Iterable, Iterator, Mapping
from enum import IntEnum
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from fmus.contents.arrays import FmiArray, fmi_arrays
from fmus.contents.description import (
    AUTHOR,
    GENERATED,
    LOG_CATEGORIES,
    as_text,
    describe,
    limits,
    project_version,
    unit_definitions,
)
from fmus.contents.units import unit
from modelkit.model import Model

States = Mapping[type[IntEnum], str]
"""Enumeration -> name of its type in the FMU."""


def model_description3(model: Model, *, token: str, generation_tool: str, flags: Mapping[str, bool]) -> bytes:
    """Return modelDescription.xml. ``flags`` are the capability attributes of the CoSimulation element."""
    known = fmi_arrays(model)
    types = type_names(known)
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
    root.extend(_type_definitions(types))
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
    root.append(_structure(known))
    ElementTree.indent(root)
    content: bytes = ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True)
    return content + b"\n"


def type_names(known: Iterable[FmiArray]) -> States:
    """Return the name of each enumeration's type: its own, or with its module's where two are called the same."""
    found = list(dict.fromkeys(item.states for item in known if item.states is not None))
    names = [states.__name__ for states in found]
    return {
        states: states.__name__
        if names.count(states.__name__) == 1
        else f"{states.__module__.rpartition('.')[2]}.{states.__name__}"
        for states in found
    }


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


def _structure(known: list[FmiArray]) -> Element:
    """Return ModelStructure: outputs depend on no input, and at the start on the parameters alone."""
    structure = Element("ModelStructure")
    outputs = [item for item in known if item.first.causality == "output"]
    parameters = " ".join(str(item.vr) for item in known if item.first.causality == "parameter")
    for item in outputs:
        SubElement(structure, "Output", valueReference=str(item.vr), dependencies="")
    for item in outputs:
        SubElement(structure, "InitialUnknown", valueReference=str(item.vr), dependencies=parameters)
    return structure
