"""The system of a scenario as SSP 1.0: structure, parameters, the FMUs, so that several tools accept it.

Every tool reads a different part. The parameter sets hang on the components (not on the system), with bare variable
names and one name for all sets: libcosim finds them there. OMSimulator takes the step size from an annotation of the
system, libcosim from one of the default experiment. Tools that read no parameter sets, or only those given to them,
drive the same scenario: the FMUs inside start with its parameters.

Outputs of the system itself are for tools that show no others. libcosim and Ecos refuse a file that has some: they
read every connection as one between two components.
"""

from collections.abc import Set
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from fmus.contents.archive import write_archive
from fmus.contents.description import AUTHOR, GENERATED, project_version, unit_definitions
from fmus.contents.variables import FmiVariable, describe
from fmus.contents.xml_file import as_text, xml_bytes
from fmus.systems.system import FmuPart, FmuSystem

SSP = "http://ssp-standard.org/SSP1/"
SPACES = {
    "ssd": SSP + "SystemStructureDescription",
    "ssc": SSP + "SystemStructureCommon",
    "ssv": SSP + "SystemStructureParameterValues",
    "oms": "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd",
    "osp": "http://opensimulationplatform.com/SSP/OSPAnnotations",
}
STRUCTURE = "SystemStructure.ssd"
FMU_TYPE = "application/x-fmu-sharedlibrary"
SET_NAME = "scenario"
PORTS = ("input", "output", "parameter")


def write_ssp(system: FmuSystem, path: Path, with_outputs: bool = False) -> Path:
    """Write the .ssp file, on demand ``with_outputs`` of the system itself; the same system gives the same bytes."""
    return write_archive(path, ssp_files(system, with_outputs))


def ssp_files(system: FmuSystem, with_outputs: bool = False) -> dict[str, bytes]:
    """Return path in the archive -> content."""
    files = {STRUCTURE: _xml(_structure(system, with_outputs))}
    for part in system.parts:
        files[_fmu_path(part)] = part.fmu.read_bytes()
        files[_set_path(part)] = _xml(_parameter_set(part))
    return files


def _fmu_path(part: FmuPart) -> str:
    return f"resources/{part.model.name}.fmu"


def _set_path(part: FmuPart) -> str:
    return f"resources/{part.name}.ssv"


def _tag(short: str) -> str:
    space, name = short.split(":")
    return f"{{{SPACES[space]}}}{name}"


def _add(parent: Element, short: str, **attributes: str) -> Element:
    return SubElement(parent, _tag(short), attributes)


def _structure(system: FmuSystem, with_outputs: bool) -> Element:
    made = {"author": AUTHOR, "license": "MIT", "generationTool": f"apa-cosim {project_version()}"}
    made |= {"description": system.title, "generationDateAndTime": GENERATED}
    names = {"name": system.identifier, "version": "1.0"}
    root = Element(_tag("ssd:SystemStructureDescription"), names | made)
    node = _add(root, "ssd:System", name=system.identifier, description=system.title)
    reported = list(system.outputs()) if with_outputs else []
    if reported:
        ports = _add(node, "ssd:Connectors")
        for _, variable, name in reported:
            _connector(ports, variable, "output", name)
    elements = _add(node, "ssd:Elements")
    connected = {(receiver.name, name) for _, receiver, name in system.connections()}
    for part in system.parts:
        _component(elements, part, connected)
    connections = _add(node, "ssd:Connections")
    for sender, receiver, name in system.connections():
        ends = {"endElement": receiver.name, "endConnector": name}
        _add(connections, "ssd:Connection", startElement=sender.name, startConnector=name, **ends)
    for part, variable, name in reported:
        start = {"startElement": part.name, "startConnector": variable.name}
        _add(connections, "ssd:Connection", **start, endConnector=name)
    _master_of_omsimulator(node, system.step)
    _units(root, system)
    experiment = _add(root, "ssd:DefaultExperiment", startTime="0.0", stopTime=as_text(system.stop))
    algorithm = _add(_annotation(experiment, "com.opensimulationplatform"), "osp:Algorithm")
    _add(algorithm, "osp:FixedStepAlgorithm", baseStepSize=as_text(system.step))
    return root


def _component(elements: Element, part: FmuPart, connected: Set[tuple[str, str]]) -> None:
    """Add a part. An input that nothing is connected to has no connector: it keeps its start value in every tool."""
    node = _add(elements, "ssd:Component", name=part.name, source=_fmu_path(part), type=FMU_TYPE)
    ports = _add(node, "ssd:Connectors")
    for kind in PORTS:
        for variable in part.of(kind):
            if kind == "input" and (part.name, variable.name) not in connected:
                continue
            _connector(ports, variable, kind, variable.name)
    bindings = _add(node, "ssd:ParameterBindings")
    _add(bindings, "ssd:ParameterBinding", source=_set_path(part))


def _connector(ports: Element, variable: FmiVariable, kind: str, name: str) -> None:
    unit = {"unit": variable.signal.unit} if variable.kind is float else {}
    node = _add(ports, "ssd:Connector", name=name, kind=kind, description=describe(variable))
    _add(node, f"ssc:{variable.fmi_type}", **unit)


def _units(root: Element, system: FmuSystem) -> None:
    """Add the units of all connectors, as FMI 2.0 defines them."""
    known = [variable for part in system.parts for kind in PORTS for variable in part.of(kind)]
    units = _add(root, "ssd:Units")
    for definition in unit_definitions(known):
        unit = _add(units, "ssc:Unit", name=definition.attrib["name"])
        _add(unit, "ssc:BaseUnit", **definition[0].attrib)


def _annotation(parent: Element, kind: str) -> Element:
    return _add(_add(parent, "ssd:Annotations"), "ssc:Annotation", type=kind)


def _master_of_omsimulator(node: Element, step: float) -> None:
    inner = _add(_add(_annotation(node, "org.openmodelica"), "oms:Annotations"), "oms:SimulationInformation")
    tolerances = {"absoluteTolerance": "0.0001", "relativeTolerance": "0.0001"}
    _add(inner, "oms:FixedStepMaster", description="oms-ma", stepSize=as_text(step), **tolerances)


def _parameter_set(part: FmuPart) -> Element:
    root = Element(_tag("ssv:ParameterSet"), name=SET_NAME, version="1.0")
    parameters = _add(root, "ssv:Parameters")
    for variable, value in part.settings():
        node = _add(parameters, "ssv:Parameter", name=variable.name)
        _add(node, f"ssv:{variable.fmi_type}", value=as_text(value))
    return root


def _xml(root: Element) -> bytes:
    for prefix, address in SPACES.items():
        ElementTree.register_namespace(prefix, address)
    return xml_bytes(root)
