"""A system made elsewhere, read from its .ssp: components, connections with their transformations, parameters.

Systems within systems become one: their components get the names of both. SSP 1.0 and 2.0; what is not supported, a
component that is no FMU or lies on a server, a signal dictionary, is refused with its name. The connectors say
which end of a connection is its source, as SSP gives start and end no direction. A connector's unit holds where the
FMU declares none.
"""

import re
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import unquote
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from fmus.systems.fmu_facts import FmuVariable, UnitScale, scale_in, variables_in

STRUCTURE = "SystemStructure.ssd"
MOST_XML, MOST_FMU = 1 << 26, 1 << 30
"""Largest description and largest FMU that are read [bytes]."""
Node = tuple[str, str]
"""An element's path, empty for the whole system, and a connector of it."""
SOURCES, SINKS = ("output", "calculatedParameter"), ("input", "parameter", "structuralParameter")
"""Kinds of connector that give, and that take, seen from outside their element."""
INDEX = re.compile(r"\[[\d, ]+\]$")


class SspError(ValueError):
    """What is wrong with an .ssp, or not supported here."""


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
    """Component -> parameter -> value, with its unit behind it where only the file says one."""
    inputs: dict[str, dict[str, str]]
    """Component -> input that nothing is connected to -> value."""
    units: dict[str, dict[str, str]]
    """Component -> variable whose unit its FMU does not declare -> unit of its connector."""
    scales: dict[str, UnitScale]
    """Unit that the file defines -> what it is in SI base units."""
    ignored: list[str]
    """Values that no variable takes, which SSP has ignored."""
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
        self._names: dict[str, str] = {}
        """Path of a component -> name of its slave."""
        self._kinds: dict[Node, str] = {}
        self._units: dict[Node, str] = {}
        self._feeds: dict[Node, _Edge] = {}
        self._given: dict[Node, tuple[str, str]] = {}
        """Connector, or parameter of a component -> (value, its unit)."""
        self._facts: dict[str, dict[str, FmuVariable]] = {}
        """FMU -> its variables."""
        self._ignored: list[str] = []

    def system(self) -> SspSystem:
        root = _parse(_member(self._archive, STRUCTURE, MOST_XML))
        top = _child(root, "System")
        if top is None:
            raise SspError("there is no system in it")
        scales = {str(item.get("name")): scale_in(item) for item in _children(root, "Units") if _kind(item) == "Unit"}
        self._scales = {name: scale for name, scale in scales.items() if scale is not None}
        self._read(top, "")
        experiment = _child(root, "DefaultExperiment")
        stop = None if experiment is None else experiment.get("stopTime")
        start = None if experiment is None else experiment.get("startTime")
        if start and float(start) != 0.0:
            raise SspError(f"startTime {start} s is not supported: runs begin at 0 s")
        steps = [item.get("baseStepSize") or item.get("stepSize") for item in root.iter() if _kind(item) in STEPS]
        connections = list(self._connections())
        units = self._connector_units()
        parameters, inputs = self._values_of_components(units)
        return SspSystem(
            top.get("name") or root.get("name") or "system",
            {self._names[path]: source for path, source in self._components.items()},
            connections,
            parameters,
            inputs,
            units,
            self._scales,
            self._ignored,
            next((float(step) for step in steps if step), None),
            float(stop) if stop else None,
        )

    def _read(self, system: Element, path: str) -> None:
        self._connectors(system, path)
        elements = {}
        for element in _children(system, "Elements"):
            name = element.get("name", "")
            inner = f"{path}/{name}".strip("/")
            if name in elements:
                raise SspError(f"{inner}: two elements have this name")
            elements[name] = _kind(element)
            if _kind(element) == "System":
                self._read(element, inner)
            elif _kind(element) == "Component":
                self._component(element, inner)
            else:
                raise SspError(f"{inner}: {_kind(element)} is not supported")
        for item in _children(system, "Connections"):
            if _kind(item) == "Connection":
                self._connection(item, path, elements)
        self._bindings(system, path, True)

    def _connectors(self, element: Element, path: str) -> None:
        for item in _children(element, "Connectors"):
            node = (path, item.get("name", ""))
            self._kinds[node] = item.get("kind", "")
            unit = next((_unit(inner) for inner in item if inner.get("unit") is not None), "")
            if unit:
                self._units[node] = unit

    def _connection(self, item: Element, path: str, elements: Mapping[str, str]) -> None:
        """Note what a connection feeds. Raises ``SspError`` if its ends do not exist, or do not fit."""
        ends = []
        for which in ("start", "end"):
            owner, name = item.get(f"{which}Element"), item.get(f"{which}Connector", "")
            if owner and owner not in elements:
                raise SspError(f"{owner}.{name} is connected, but there is no element {owner}")
            node = (f"{path}/{owner or ''}".strip("/"), name)
            if elements.get(owner or "", "System") == "System" and node not in self._kinds:
                raise SspError(f"{'.'.join(node).strip('.')} is connected, but there is no such connector")
            ends.append((node, self._direction(node, owner is not None and owner != "")))
        (start, gives), (end, takes) = ends
        if gives and gives == takes:
            both = "give" if gives > 0 else "take"
            raise SspError(f"{'.'.join(start)} and {'.'.join(end)} are connected, but both {both} a signal")
        if gives < 0 or takes > 0:
            start, end = end, start
        if end in self._feeds:
            raise SspError(f"{'.'.join(end).strip('.')} is fed twice")
        self._feeds[end] = _edge(start, item)

    def _direction(self, node: Node, is_element: bool) -> int:
        """Return 1 if a connector gives a signal to a connection, -1 if it takes one, 0 if nobody says."""
        kind = self._kinds.get(node, "")
        if not kind and node[0] in self._components:
            known = self._variable(*node)
            kind = known.causality if known is not None else ""
        way = 1 if kind in SOURCES else -1 if kind in SINKS else 0
        return way if is_element else -way

    def _variable(self, path: str, name: str) -> FmuVariable | None:
        """Return what the FMU of a component says of a variable, or of the array that an element is of."""
        source = self._components[path]
        if source not in self._facts:
            try:
                self._facts[source] = variables_in(_member(self._archive, source, MOST_FMU))
            except (ValueError, KeyError, zipfile.BadZipFile, NotImplementedError) as error:
                raise SspError(f"{source}: is not an FMU: {error}") from None
        facts = self._facts[source]
        return facts.get(name) or facts.get(INDEX.sub("", name))

    def _component(self, element: Element, path: str) -> None:
        source, kind = element.get("source", ""), element.get("type", "")
        if not source.endswith(".fmu") or "://" in source or "xml" in kind:
            raise SspError(f"{path}: {source or 'it'} is no FMU in this file")
        self._components[path] = source
        self._names[path] = _free_name(path, set(self._names.values()))
        self._connectors(element, path)
        self._bindings(element, path, False)

    def _bindings(self, element: Element, path: str, is_system: bool) -> None:
        for binding in _children(element, "ParameterBindings"):
            values = self._values(binding)
            mapping = self._mapping(binding)
            prefix = binding.get("prefix", "")
            if mapping:
                lost = [name for name in values if prefix + name not in mapping]
                self._ignored += [f"{path or 'system'}: parameter {name} is mapped to nothing" for name in lost]
            for name, value in values.items():
                for target in mapping.get(prefix + name, [] if mapping else [prefix + name]):
                    owner, dot, inner = target.partition(".")
                    is_inner = is_system and dot and self._has(f"{path}/{owner}".strip("/"))
                    node = (f"{path}/{owner}".strip("/"), inner) if is_inner else (path, target)
                    self._given[node] = value

    def _has(self, path: str) -> bool:
        return any(known == path or known.startswith(f"{path}/") for known in self._components)

    def _values(self, binding: Element) -> dict[str, tuple[str, str]]:
        inline = _child(binding, "ParameterValues")
        source = binding.get("source")
        root = inline if inline is not None else self._file(source) if source else None
        found = {}
        for parameter in root.iter() if root is not None else ():
            if _kind(parameter) == "Parameter" and len(parameter):
                value = parameter[0]
                text = str(value.get("value") if value.get("value") is not None else value.get("name"))
                found[str(parameter.get("name"))] = text, _unit(value)
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
        return _parse(_member(self._archive, name, MOST_XML))

    def _connections(self) -> Iterator[SspConnection]:
        """Yield what feeds each connector of a component, followed back through the borders of systems."""
        for target in self._feeds:
            if target[0] not in self._components:
                continue
            found = self._origin(target)
            if found is not None and found.source[0] in self._components:
                source, end = ((self._names[path], name) for path, name in (found.source, target))
                yield SspConnection(source, end, *found[1:])

    def _origin(self, target: Node) -> _Edge | None:
        edge = self._feeds.get(target)
        seen = {target}
        while edge is not None and edge.source not in seen and edge.source in self._feeds:
            seen.add(edge.source)
            before = self._feeds[edge.source]
            if before.values and edge.values:
                raise SspError(f"{'.'.join(target)}: two consecutive mappings are not supported")
            offset = edge.factor * before.offset + edge.offset
            values, converts = before.values or edge.values, before.converts and edge.converts
            edge = _Edge(before.source, before.factor * edge.factor, offset, values, converts)
        return edge

    def _connector_units(self) -> dict[str, dict[str, str]]:
        """Return the units that connectors say of variables of which their FMUs say none."""
        found: dict[str, dict[str, str]] = {}
        for target in self._feeds:
            self._inherit_unit(target)
        for (path, name), unit in self._units.items():
            known = self._variable(path, name) if path in self._components else None
            if known is None or not known.is_real:
                continue
            if known.unit in (None, "1"):
                found.setdefault(self._names[path], {})[name] = unit
                continue
            said, connector = known.scales.get(known.unit or ""), self._scales.get(unit)
            if said is not None and connector is not None and said.exponents != connector.exponents:
                raise SspError(f"connector {path}.{name} is in {unit}, but its FMU has it in {known.unit}")
        return found

    def _inherit_unit(self, target: Node) -> None:
        """Give a component's connector without a unit that of the border of a system that it is connected to."""
        edge, seen = self._feeds.get(target), {target}
        while target not in self._units and edge is not None and edge.source not in seen and edge.converts:
            plain = (edge.factor, edge.offset, edge.values) == (1.0, 0.0, {})
            if not plain or edge.source[0] in self._components:
                return
            if edge.source in self._units:
                self._units[target] = self._units[edge.source]
            seen.add(edge.source)
            edge = self._feeds.get(edge.source)

    def _values_of_components(
        self, units: dict[str, dict[str, str]]
    ) -> tuple[dict[str, dict[str, str]], dict[str, dict[str, str]]]:
        """Return the values of parameters, and of inputs that nothing feeds, also by connectors that lead there."""
        given = {}
        for target in self._feeds:
            edge = self._origin(target)
            if target[0] in self._components and edge is not None and edge.source in self._given:
                given[target] = self._given[edge.source]
        led = {edge.source for edge in map(self._origin, self._feeds) if edge is not None}
        for (path, name), value in self._given.items():
            if path in self._components:
                given[path, name] = value
            elif (path, name) not in led:
                self._ignored.append(f"{path or 'system'} has no parameter or connector {name} that a value can be for")
        parameters: dict[str, dict[str, str]] = {}
        inputs: dict[str, dict[str, str]] = {}
        for (path, name), value in given.items():
            known, owner = self._variable(path, name), self._names[path]
            if known is None or known.causality not in (*SINKS, "input"):
                what = f"{name}: its FMU has no such variable" if known is None else f"{name}: it is {known.causality}"
                self._ignored.append(f"{owner}.{what}")
            elif known.causality == "input":
                is_fed = any(edge.source[0] in self._components for edge in [self._origin((path, name))] if edge)
                inputs.setdefault(owner, {}).update({} if is_fed else self._elements((path, name), known, value, units))
            else:
                parameters.setdefault(owner, {}).update(self._elements((path, name), known, value, units))
        return parameters, inputs

    def _elements(
        self, node: Node, known: FmuVariable, value: tuple[str, str], units: dict[str, dict[str, str]]
    ) -> dict[str, str]:
        """Return name -> value in the FMU's unit; one for each element of an array."""
        (path, name), (text, unit) = node, value
        unit = unit or self._units.get(node, "")
        if known.is_real and known.unit is None and unit:
            units.setdefault(self._names[path], {}).setdefault(name, unit)
        taken = known.unit or units.get(self._names[path], {}).get(name, "")
        if not known.is_array or INDEX.search(name):
            return {name: self._in_unit(".".join(node), text, unit, taken, known)}
        parts = text.split()
        return {
            f"{name}[{place}]": self._in_unit(".".join(node), part, unit, taken, known)
            for place, part in enumerate(parts, start=1)
        }

    def _in_unit(self, name: str, text: str, unit: str, taken: str, known: FmuVariable) -> str:
        """Return a value in the unit ``taken``; with its own behind it where the file does not define that."""
        if not known.is_real or unit in ("", taken):
            return text
        source, target = self._scales.get(unit), known.scales.get(taken) or self._scales.get(taken)
        if source is None or target is None:
            return text if unit == "1" else f"{text} {unit}"
        if source.exponents != target.exponents:
            raise SspError(f"{name}: {text} is in {unit}, expected {taken}")
        if source[:2] == target[:2]:
            return text
        return repr((float(text) * source.factor + source.offset - target.offset) / target.factor)


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
    """Return a file of the archive by its name, or by its name as an address writes it."""
    known = archive.namelist()
    plain = next((item for item in (name, unquote(name), unquote(name).removeprefix("./")) if item in known), None)
    if plain is None:
        raise SspError(f"there is no {name} in it")
    entry = archive.getinfo(plain)
    if entry.file_size > most:
        raise SspError(f"{name} is too large: {entry.file_size} bytes")
    return archive.read(entry)


def _parse(data: bytes) -> Element:
    """Return the root of an XML file. Raises ``ParseError``, or ``SspError`` if its encoding is unknown."""
    try:
        return ElementTree.fromstring(data)
    except LookupError as error:
        raise SspError(f"cannot be read: {error}") from None


def _free_name(path: str, used: set[str]) -> str:
    """Return the path of a component as a name that none has yet."""
    plain = re.sub(r"\W", "_", path, flags=re.ASCII)
    name = plain = f"_{plain}" if plain[:1].isdigit() or not plain else plain
    number = 2
    while name in used:
        name, number = f"{plain}_{number}", number + 1
    return name


def _unit(element: Element) -> str:
    """Return the unit that an element has, ``1`` for a dash; empty if it says none."""
    unit = element.get("unit", "").strip()
    return "1" if unit == "-" else unit


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
