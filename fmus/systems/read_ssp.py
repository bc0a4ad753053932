"""A system made elsewhere, read from its .ssp: components, connections with their transformations, parameters.

Systems within systems become one: their components get the names of both. SSP 1.0 and 2.0; what cannot be had here, a
component that is no FMU or lies on a server, a signal dictionary, is refused with its name.
"""

import re
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

STRUCTURE = "SystemStructure.ssd"
MOST_XML, MOST_FMU = 1 << 26, 1 << 30
"""Largest description and largest FMU that are read [bytes]."""
Node = tuple[str, str]
"""An element's path, empty for the whole system, and a connector of it."""


class SspError(ValueError):
    """What is wrong with an .ssp, or cannot be had here."""


class SspConnection(NamedTuple):
    """What feeds one connector of a component."""

    source: Node
    target: Node
    factor: float
    offset: float
    values: dict[str, str]
    """Value -> value, if it is a mapping."""
    converts: bool
    """Whether the number is brought from the unit of one side into that of the other."""


class SspSystem(NamedTuple):
    """A system of components."""

    name: str
    components: dict[str, str]
    """Name of a component -> its FMU in the archive."""
    connections: list[SspConnection]
    parameters: dict[str, dict[str, str]]
    """Component -> parameter -> value, with its unit behind it if the file says one."""
    step: float | None
    """Communication step [s]."""
    stop: float | None
    """Stop time [s]."""


class _Edge(NamedTuple):
    source: Node
    factor: float
    offset: float
    values: dict[str, str]
    converts: bool


def read_ssp(path: Path) -> SspSystem:
    """Return the system in the file at ``path``. Raises ``SspError``."""
    try:
        with zipfile.ZipFile(path) as archive:
            return _Reader(archive).system()
    except (zipfile.BadZipFile, OSError, NotImplementedError) as error:
        raise SspError(f"is no .ssp: {error}") from None
    except ElementTree.ParseError as error:
        raise SspError(f"cannot be read: {error}") from None


def fmu_in(path: Path, source: str) -> bytes:
    """Return the FMU called ``source`` in an .ssp. Raises ``SspError``."""
    with zipfile.ZipFile(path) as archive:
        return _member(archive, source, MOST_FMU)


class _Reader:
    def __init__(self, archive: zipfile.ZipFile) -> None:
        self._archive = archive
        self._components: dict[str, str] = {}
        self._feeds: dict[Node, _Edge] = {}
        self._given: dict[Node, str] = {}
        """Connector, or parameter of a component -> value."""

    def system(self) -> SspSystem:
        root = ElementTree.fromstring(_member(self._archive, STRUCTURE, MOST_XML))
        top = _child(root, "System")
        if top is None:
            raise SspError("there is no system in it")
        self._read(top, "")
        experiment = _child(root, "DefaultExperiment")
        stop = None if experiment is None else experiment.get("stopTime")
        steps = [item.get("baseStepSize") or item.get("stepSize") for item in root.iter() if _kind(item) in STEPS]
        return SspSystem(
            top.get("name") or root.get("name") or "system",
            {_flat(path): source for path, source in self._components.items()},
            list(self._connections()),
            self._parameters(),
            next((float(step) for step in steps if step), None),
            float(stop) if stop else None,
        )

    def _read(self, system: Element, path: str) -> None:
        for element in _children(system, "Elements"):
            inner = f"{path}/{element.get('name', '')}".strip("/")
            if _kind(element) == "System":
                self._read(element, inner)
            elif _kind(element) == "Component":
                self._component(element, inner)
            else:
                raise SspError(f"{inner}: a {_kind(element)} cannot be had here")
        for item in _children(system, "Connections"):
            start, end = (
                (f"{path}/{item.get(f'{which}Element', '')}".strip("/"), item.get(f"{which}Connector", ""))
                for which in ("start", "end")
            )
            self._feeds[end] = _edge(start, item)
        self._bindings(system, path, True)

    def _component(self, element: Element, path: str) -> None:
        source, kind = element.get("source", ""), element.get("type", "")
        if not source.endswith(".fmu") or "://" in source or "xml" in kind:
            raise SspError(f"{path}: {source or 'it'} is no FMU in this file")
        self._components[path] = source
        self._bindings(element, path, False)

    def _bindings(self, element: Element, path: str, is_system: bool) -> None:
        for binding in _children(element, "ParameterBindings"):
            values = self._values(binding)
            mapping = self._mapping(binding)
            prefix = binding.get("prefix", "")
            for name, value in values.items():
                for target in mapping.get(prefix + name, [] if mapping else [prefix + name]):
                    owner, dot, inner = target.partition(".")
                    is_inner = is_system and dot and self._has(f"{path}/{owner}".strip("/"))
                    node = (f"{path}/{owner}".strip("/"), inner) if is_inner else (path, target)
                    self._given[node] = value

    def _has(self, path: str) -> bool:
        return any(known == path or known.startswith(f"{path}/") for known in self._components)

    def _values(self, binding: Element) -> dict[str, str]:
        inline = _child(binding, "ParameterValues")
        source = binding.get("source")
        root = inline if inline is not None else self._file(source) if source else None
        found = {}
        for parameter in root.iter() if root is not None else ():
            if _kind(parameter) == "Parameter" and len(parameter):
                value = parameter[0]
                unit = value.get("unit")
                text = str(value.get("value") if value.get("value") is not None else value.get("name"))
                found[str(parameter.get("name"))] = f"{text} {unit}" if unit and unit != "1" else text
        return found

    def _mapping(self, binding: Element) -> dict[str, list[str]]:
        inline = _child(binding, "ParameterMapping")
        source = None if inline is None else inline.get("source")
        root = self._file(source) if source else inline
        found: dict[str, list[str]] = {}
        for entry in root.iter() if root is not None else ():
            if _kind(entry) == "MappingEntry":
                if len(entry):
                    raise SspError(f"the mapping of parameter {entry.get('source')} has a transformation: not had here")
                found.setdefault(str(entry.get("source")), []).append(str(entry.get("target")))
        return found

    def _file(self, name: str) -> Element:
        return ElementTree.fromstring(_member(self._archive, name, MOST_XML))

    def _connections(self) -> Iterator[SspConnection]:
        """Yield what feeds each connector of a component, followed back through the borders of systems."""
        for target in self._feeds:
            if target[0] not in self._components:
                continue
            found = self._origin(target)
            if found is not None and found.source[0] in self._components:
                source, end = ((_flat(path), name) for path, name in (found.source, target))
                yield SspConnection(source, end, *found[1:])

    def _origin(self, target: Node) -> _Edge | None:
        edge = self._feeds.get(target)
        seen = {target}
        while edge is not None and edge.source not in seen and edge.source in self._feeds:
            seen.add(edge.source)
            before = self._feeds[edge.source]
            if before.values and edge.values:
                raise SspError(f"{'.'.join(target)}: two mappings one after the other cannot be had here")
            offset = edge.factor * before.offset + edge.offset
            values, converts = before.values or edge.values, before.converts and edge.converts
            edge = _Edge(before.source, before.factor * edge.factor, offset, values, converts)
        return edge

    def _parameters(self) -> dict[str, dict[str, str]]:
        """Return the parameters of components: those given to them, and those of connectors that lead there."""
        found: dict[str, dict[str, str]] = {}
        for target in self._feeds:
            edge = self._origin(target)
            if target[0] in self._components and edge is not None and edge.source in self._given:
                found.setdefault(_flat(target[0]), {})[target[1]] = self._given[edge.source]
        for (path, name), value in self._given.items():
            if path in self._components:
                found.setdefault(_flat(path), {})[name] = value
        return found


STEPS = ("FixedStepAlgorithm", "FixedStepMaster")
"""Annotations that say a communication step: of the OSP and of OMSimulator."""


def _edge(start: Node, connection: Element) -> _Edge:
    factor, offset, values = 1.0, 0.0, {}
    for item in connection:
        kind = _kind(item)
        if kind == "LinearTransformation":
            factor, offset = float(item.get("factor", 1.0)), float(item.get("offset", 0.0))
        elif kind.endswith("MappingTransformation"):
            words = {"true": "1", "false": "0"}
            pairs = [(entry.get("source", ""), entry.get("target", "")) for entry in item]
            values = {words.get(one, one): words.get(other, other) for one, other in pairs}
    return _Edge(start, factor, offset, values, connection.get("suppressUnitConversion", "false") not in ("true", "1"))


def _member(archive: zipfile.ZipFile, name: str, most: int) -> bytes:
    try:
        entry = archive.getinfo(name)
    except KeyError:
        raise SspError(f"there is no {name} in it") from None
    if entry.file_size > most:
        raise SspError(f"{name} is too large: {entry.file_size} bytes")
    return archive.read(entry)


def _flat(path: str) -> str:
    """Return the path of a component as a name."""
    return re.sub(r"\W", "_", path)


def _kind(element: Element) -> str:
    return element.tag.rpartition("}")[2]


def _child(element: Element, kind: str) -> Element | None:
    return next((item for item in element if _kind(item) == kind), None)


def _children(element: Element, kind: str) -> list[Element]:
    found = _child(element, kind)
    return [] if found is None else list(found)


def as_written(system: SspSystem) -> Mapping[str, Any]:
    """Return connections as a scenario writes them."""
    found: dict[str, Any] = {}
    for item in system.connections:
        feed: dict[str, Any] = {"from": ".".join(item.source)}
        if (item.factor, item.offset) != (1.0, 0.0):
            feed |= {"factor": item.factor, "offset": item.offset}
        if item.values:
            feed["map"] = item.values
        if not item.converts:
            feed["units"] = False
        found[".".join(item.target)] = feed
    return found
