"""From a model package's types to FMI 3.0's modelDescription.xml."""

from collections.abc import Iterator, Mapping
from enum import IntEnum
from xml.etree.ElementTree import Element, SubElement

from fmus.contents.arrays import FmiArray, visible_arrays
from fmus.contents.dependencies import initial_dependencies
from fmus.contents.description import (
    co_simulation,
    description_root,
    head_attributes,
    log_and_experiment,
    type_attributes,
    unit_definitions,
)
from fmus.contents.variables import mode_types
from fmus.contents.xml_file import as_text, xml_bytes
from modelkit.model import Model

ABILITIES = {
    "needsExecutionTool": False,
    "canBeInstantiatedOnlyOncePerProcess": False,
    "canGetAndSetFMUState": True,
    "canSerializeFMUState": True,
    "canHandleVariableCommunicationStepSize": True,
    "hasEventMode": False,
}
"""What every FMU of FMI 3.0 made here can do: attributes of CoSimulation."""
States = Mapping[type[IntEnum], str]
"""Enumeration -> name of its type in the FMU."""


def model_description3(model: Model, *, token: str, generation_tool: str, flags: Mapping[str, bool]) -> bytes:
    """Return modelDescription.xml. ``flags`` are the capability attributes of the CoSimulation element."""
    known = visible_arrays(model)
    types = mode_types(model)
    root = description_root(model, 3, generation_tool, instantiationToken=token)
    root.append(co_simulation(model, flags))
    root.append(unit_definitions(item.first for item in known))
    used = {item.states for item in known}
    root.extend(_type_definitions({mode: name for mode, name in types.items() if mode in used}))
    root.extend(log_and_experiment(model, 3))
    SubElement(root, "ModelVariables").extend(_variable(item, types) for item in known)
    root.append(_structure(known, initial_dependencies(model)))
    return xml_bytes(root)


def _type_definitions(types: States) -> Iterator[Element]:
    if types:
        definitions = Element("TypeDefinitions")
        for states, name in types.items():
            node = SubElement(definitions, "EnumerationType", name=name)
            for state in states:
                SubElement(node, "Item", name=state.name, value=str(state.value))
        yield definitions


def _variable(item: FmiArray, types: States) -> Element:
    without_states = item.first.signal._replace(states=None)
    said = item.first._replace(name=item.name, vr=item.vr, signal=without_states)
    node = Element(item.fmi_type, head_attributes(said))
    if item.states is not None:
        node.set("declaredType", types[item.states])
    node.attrib.update(type_attributes(item.first))
    if item.starts:
        node.set("start", " ".join(as_text(item.first.kind(value)) for value in item.starts))
    for size in item.shape:
        SubElement(node, "Dimension", start=str(size))
    return node


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
