"""ParkingSystem.ssp: structure and parameters of the system as SSP 1.0, so that several tools accept it.

Every tool reads a different part. The parameter sets hang on the components (not on the system), with
bare variable names and one name for all sets: libcosim finds them there. OMSimulator takes the step
size from an annotation of the system, libcosim from one of the default experiment.
"""

from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from fmus.contents.archive import write_archive
from fmus.contents.xml_file import as_text, xml_bytes
from fmus.systems.system import NAME, Part, System

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


def write_ssp(system: System, path: Path) -> Path:
    """Write the .ssp file; the same system gives the same bytes."""
    return write_archive(path, ssp_files(system))


def ssp_files(system: System) -> dict[str, bytes]:
    """Return path in the archive -> content."""
    files = {STRUCTURE: _xml(_structure(system))}
    for part in system.parts:
        files[_fmu_path(part)] = part.fmu.read_bytes()
        files[_set_path(part)] = _xml(_parameter_set(part))
    return files


def _fmu_path(part: Part) -> str:
    return f"resources/{part.model.name}.fmu"


def _set_path(part: Part) -> str:
    return f"resources/{part.name}.ssv"


def _tag(short: str) -> str:
    space, name = short.split(":")
    return f"{{{SPACES[space]}}}{name}"


def _add(parent: Element, short: str, **attributes: str) -> Element:
    return SubElement(parent, _tag(short), attributes)


def _structure(system: System) -> Element:
    root = Element(_tag("ssd:SystemStructureDescription"), name=NAME, version="1.0")
    node = _add(root, "ssd:System", name=NAME)
    elements = _add(node, "ssd:Elements")
    for part in system.parts:
        _component(elements, part)
    connections = _add(node, "ssd:Connections")
    for sender, receiver, name in system.connections():
        _add(
            connections,
            "ssd:Connection",
            startElement=sender.name,
            startConnector=name,
            endElement=receiver.name,
            endConnector=name,
        )
    _master_of_omsimulator(node, system.step)
    experiment = _add(root, "ssd:DefaultExperiment", startTime="0.0", stopTime=as_text(system.stop))
    algorithm = _add(_annotation(experiment, "com.opensimulationplatform"), "osp:Algorithm")
    _add(algorithm, "osp:FixedStepAlgorithm", baseStepSize=as_text(system.step))
    return root


def _component(elements: Element, part: Part) -> None:
    node = _add(elements, "ssd:Component", name=part.name, source=_fmu_path(part), type=FMU_TYPE)
    connectors = _add(node, "ssd:Connectors")
    for kind in ("input", "output"):
        for variable in part.of(kind):
            _add(_add(connectors, "ssd:Connector", name=variable.name, kind=kind), f"ssc:{variable.fmi_type}")
    bindings = _add(node, "ssd:ParameterBindings")
    _add(bindings, "ssd:ParameterBinding", source=_set_path(part))


def _annotation(parent: Element, kind: str) -> Element:
    return _add(_add(parent, "ssd:Annotations"), "ssc:Annotation", type=kind)


def _master_of_omsimulator(node: Element, step: float) -> None:
    inner = _add(_add(_annotation(node, "org.openmodelica"), "oms:Annotations"), "oms:SimulationInformation")
    tolerance = "0.0001"
    _add(
        inner,
        "oms:FixedStepMaster",
        description="oms-ma",
        stepSize=as_text(step),
        absoluteTolerance=tolerance,
        relativeTolerance=tolerance,
    )


def _parameter_set(part: Part) -> Element:
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
