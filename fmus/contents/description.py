"""From a model package's types to FMI 2.0's modelDescription.xml, the same for every kind of FMU."""

from collections.abc import Iterable, Iterator, Mapping
from enum import IntEnum
from importlib.metadata import PackageNotFoundError, version
from xml.etree.ElementTree import Element, SubElement

from fmus.contents.dependencies import initial_dependencies
from fmus.contents.units import unit
from fmus.contents.variables import FmiVariable, describe, limits, mode_types, states_text, visible_variables
from fmus.contents.xml_file import as_text, xml_bytes
from modelkit.model import Model

GENERATED = "2000-01-01T00:00:00Z"
"""Date written into every FMU: the content decides the bytes, not the day."""
AUTHOR = "The apa-cosim authors"
LOG_CATEGORIES = {
    "logStatusWarning": "Messages with fmi{fmi}Warning",
    "logStatusDiscard": "Messages with fmi{fmi}Discard",
    "logStatusError": "Messages with fmi{fmi}Error: wrong calls, exceptions with their traceback",
    "logStatusFatal": "Messages with fmi{fmi}Fatal",
    "logAll": "All messages",
}
ABILITIES = {
    "needsExecutionTool": False,
    "canHandleVariableCommunicationStepSize": True,
    "canInterpolateInputs": False,
    "canBeInstantiatedOnlyOncePerProcess": False,
    "canNotUseMemoryManagementFunctions": True,
    "canGetAndSetFMUstate": True,
    "canSerializeFMUstate": True,
}
"""What every FMU of FMI 2.0 made here can do: attributes of CoSimulation."""


def model_description(
    model: Model, *, guid: str, generation_tool: str, flags: Mapping[str, bool], sources: tuple[str, ...] = ()
) -> bytes:
    """Return modelDescription.xml. ``flags`` are the capability attributes of the CoSimulation element.

    ``sources`` are the files in the folder ``sources`` that a compiler is given.
    """
    known = visible_variables(model)
    types = mode_types(model)
    root = description_root(model, 2, generation_tool, guid=guid)
    root.append(_interface(model, flags, sources))
    root.append(unit_definitions(known))
    used = {variable.signal.states for variable in known}
    if used != {None}:
        root.append(_type_definitions({mode: name for mode, name in types.items() if mode in used}))
    root.extend(log_and_experiment(model, 2))
    scalars = SubElement(root, "ModelVariables")
    scalars.extend(_scalar(variable, types) for variable in known)
    root.append(_structure(known, initial_dependencies(model)))
    return xml_bytes(root)


def description_root(model: Model, fmi: int, generation_tool: str, **token: str) -> Element:
    """Return the outermost element of a modelDescription.xml; ``token`` is what the binary answers to."""
    attributes = {
        "fmiVersion": f"{fmi}.0",
        "modelName": model.name,
        **token,
        "description": model.description,
        "author": AUTHOR,
        "version": project_version(),
        "copyright": "Copyright (c) the apa-cosim authors",
        "license": "MIT",
        "generationTool": generation_tool,
        "generationDateAndTime": GENERATED,
        "variableNamingConvention": "structured",
    }
    return Element("fmiModelDescription", attributes)


def co_simulation(model: Model, flags: Mapping[str, bool]) -> Element:
    """Return the element CoSimulation."""
    return Element("CoSimulation", {"modelIdentifier": model.name} | {key: as_text(flags[key]) for key in flags})


def log_and_experiment(model: Model, fmi: int) -> tuple[Element, Element]:
    """Return LogCategories and DefaultExperiment."""
    categories = Element("LogCategories")
    for name, text in LOG_CATEGORIES.items():
        SubElement(categories, "Category", name=name, description=text.format(fmi=fmi))
    times = {"startTime": 0.0, "stopTime": model.stop_time, "stepSize": model.step_size}
    return categories, Element("DefaultExperiment", {key: as_text(value) for key, value in times.items()})


def _interface(model: Model, flags: Mapping[str, bool], sources: tuple[str, ...]) -> Element:
    interface = co_simulation(model, flags)
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
    node = Element("ScalarVariable", head_attributes(variable))
    mode = variable.signal.states
    attributes = {} if mode is None else {"declaredType": types[mode]}
    attributes |= dict(type_attributes(variable))
    if variable.start is not None:
        attributes["start"] = as_text(variable.start)
    SubElement(node, variable.fmi_type, attributes)
    return node


def head_attributes(variable: FmiVariable) -> dict[str, str]:
    """Return what is said of a variable whatever its type is."""
    attributes = {
        "name": variable.name,
        "valueReference": str(variable.vr),
        "description": describe(variable),
        "causality": variable.causality,
        "variability": variable.variability,
        "initial": variable.initial,
    }
    return {name: value for name, value in attributes.items() if value is not None}


def type_attributes(variable: FmiVariable) -> Iterator[tuple[str, str]]:
    """Yield unit and limits of a variable, the same in FMI 2.0 and 3.0."""
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
