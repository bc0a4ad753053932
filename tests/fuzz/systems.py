"""Systems in .ssp files: what they say is what is connected and set; damaged ones are refused in one line.

The FMUs have no code: what is compared is what a system becomes before it runs. Truth is worked out here from what was
written: each quantity in SI, whatever the units of its ends.
"""

import math
import random
import shutil
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple
from xml.sax.saxutils import quoteattr

import fmus.cache_paths
from orchestrator.inputs.text.errors import BadInput
from orchestrator.session.foreign import load_bound_scenario
from orchestrator.session.session import NOBODY, Messages, make_instances
from orchestrator.simulation.system.assemble import elaborate
from orchestrator.simulation.system.diagnostics import remarks

DEGREE = math.pi / 180.0
ANGLES = {"rad": 1.0, "deg": DEGREE, "gon": math.pi / 200.0, "mrad": 0.001}
NAMES = ("Steer", "Wheel Angle", "left, front", "a.b", "x[3]", "y[2,1]", "Angle (deg)", "Winkel ß", "-sign", "t [s]")
SPACES = (
    'xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"'
    ' xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"'
    ' xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"'
)
UNITS = "".join(
    f'<ssc:Unit name="{name}"><ssc:BaseUnit rad="1" factor="{size!r}"/></ssc:Unit>' for name, size in ANGLES.items()
)
DEFINED = "".join(f'<Unit name="{name}"><BaseUnit rad="1" factor="{size!r}"/></Unit>' for name, size in ANGLES.items())


class Pin(NamedTuple):
    """A variable, the unit its FMU declares, and that of its connector; empty: none."""

    name: str
    causality: str
    declared: str
    connector: str

    @property
    def unit(self) -> str:
        """What its number is in; empty: nobody says."""
        return self.declared or self.connector


class Link(NamedTuple):
    """A connection, and what it does."""

    source: Pin
    target: Pin
    factor: float
    offset: float
    converts: bool

    def value(self, number: float) -> float:
        """Return what the target gets of a number of the source."""
        scaled = self.factor * number + self.offset
        if not self.converts or not self.source.unit or not self.target.unit:
            return scaled
        return scaled * ANGLES[self.source.unit] / ANGLES[self.target.unit]


class Setting(NamedTuple):
    """A value of the parameter set."""

    pin: Pin
    value: float
    unit: str

    def number(self) -> float:
        """Return what the parameter becomes: in its FMU's unit, else its connector's."""
        given, taken = self.unit or self.pin.connector, self.pin.unit
        return self.value * ANGLES[given] / ANGLES[taken] if given and taken else self.value


class System(NamedTuple):
    """What is written."""

    brain: list[Pin]
    plant: list[Pin]
    links: list[Link]
    settings: list[Setting]
    is_nested: bool


def drawn(draw: random.Random) -> System:
    """Return a random system."""

    def unit(share: float) -> str:
        return draw.choice(list(ANGLES)) if draw.random() < share else ""

    def pins(causality: str, count: int, names: list[str]) -> list[Pin]:
        return [Pin(names.pop(), causality, unit(0.5), unit(0.5)) for _ in range(count)]

    brain_names, plant_names = (draw.sample(NAMES, len(NAMES)) for _ in range(2))
    brain = pins("output", 3, brain_names)
    inputs, parameters = pins("input", 3, plant_names), pins("parameter", 3, plant_names)
    links = [
        Link(
            draw.choice(brain),
            target,
            *draw.choice(((1.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (2.5, 0.5))),
            draw.random() < 0.8,
        )
        for target in inputs[: draw.randrange(1, 3)]
    ]
    settings = [
        Setting(pin, draw.choice((0.0, 1.0, -180.0, 57.3)), unit(0.4)) for pin in parameters[: draw.randrange(4)]
    ]
    return System(brain, [*inputs, *parameters], links, settings, draw.random() < 0.4)


def _fmu(path: Path, pins: list[Pin]) -> None:
    parts = [
        f'<ScalarVariable name={quoteattr(pin.name)} valueReference="{number}" causality="{pin.causality}">'
        f"<Real{f' unit={quoteattr(pin.declared)}' if pin.declared else ''}/></ScalarVariable>"
        for number, pin in enumerate(pins)
    ]
    head = '<?xml version="1.0" encoding="UTF-8"?><fmiModelDescription fmiVersion="2.0" modelName="M" guid="g">'
    text = f'{head}<CoSimulation modelIdentifier="m"/><UnitDefinitions>{DEFINED}</UnitDefinitions>'
    with zipfile.ZipFile(path, "w") as archive:
        text += f"<ModelVariables>{''.join(parts)}</ModelVariables><ModelStructure/></fmiModelDescription>"
        archive.writestr("modelDescription.xml", text)


def _connectors(pins: list[Pin]) -> str:
    return "".join(
        f'<ssd:Connector name={quoteattr(pin.name)} kind="{pin.causality}">'
        f"<ssc:Real{f' unit={quoteattr(pin.connector)}' if pin.connector else ''}/></ssd:Connector>"
        for pin in pins
    )


def _connection(link: Link, ends: tuple[str, str], draw: random.Random) -> str:
    start, end = [
        f"Element={quoteattr(owner)} {{0}}Connector={quoteattr(pin.name)}"
        for owner, pin in zip(ends, link[:2], strict=True)
    ]
    if draw.random() < 0.5:
        start, end = end, start
    words = f"start{start.format('start')} end{end.format('end')}"
    inside = (
        ""
        if (link.factor, link.offset) == (1.0, 0.0)
        else f'<ssc:LinearTransformation factor="{link.factor}" offset="{link.offset}"/>'
    )
    return (
        f'<ssd:Connection {words} suppressUnitConversion="{str(not link.converts).lower()}">{inside}</ssd:Connection>'
    )


def structure(system: System, draw: random.Random) -> str:
    """Return the description of a system; if it is nested, its plant stands in a system of its own."""
    plant = _component("plant", system.plant, _bindings(system.settings))
    if system.is_nested:
        names = [quoteattr(link.target.name) for link in system.links]
        inner = [
            f'<ssd:Connection startConnector={name} endElement="plant" endConnector={name}/>'  # both of one name
            for name in names
        ]
        borders = _connectors([link.target._replace(connector="") for link in system.links])
        connectors = f"<ssd:Connectors>{borders}</ssd:Connectors>"
        plant = f'<ssd:System name="yard">{connectors}{_inside([plant], inner)}</ssd:System>'
    ends = ("brain", "yard" if system.is_nested else "plant")
    links = [_connection(link, ends, draw) for link in system.links]
    inside = _inside([_component("brain", system.brain, ""), plant], links)
    return (
        f'<?xml version="1.0" encoding="UTF-8"?><ssd:SystemStructureDescription {SPACES} name="S" version="1.0">'
        f'<ssd:System name="S">{inside}</ssd:System><ssd:Units>{UNITS}</ssd:Units></ssd:SystemStructureDescription>'
    )


def _component(name: str, pins: list[Pin], bindings: str) -> str:
    connectors = f"<ssd:Connectors>{_connectors(pins)}</ssd:Connectors>"
    return f'<ssd:Component name="{name}" source="{name}.fmu">{connectors}{bindings}</ssd:Component>'


def _inside(elements: list[str], connections: list[str]) -> str:
    return f"<ssd:Elements>{''.join(elements)}</ssd:Elements><ssd:Connections>{''.join(connections)}</ssd:Connections>"


def _bindings(settings: list[Setting]) -> str:
    values = "".join(
        f'<ssv:Parameter name={quoteattr(item.pin.name)}><ssv:Real value="{item.value!r}"'
        f"{f' unit={quoteattr(item.unit)}' if item.unit else ''}/></ssv:Parameter>"
        for item in settings
    )
    inner = f'<ssv:ParameterSet name="p" version="1.0"><ssv:Parameters>{values}</ssv:Parameters></ssv:ParameterSet>'
    for word in ("ParameterValues", "ParameterBinding", "ParameterBindings"):
        inner = f"<ssd:{word}>{inner}</ssd:{word}>"
    return inner


def fuzz(folder: Path, log: Path, draw: random.Random) -> Iterator[tuple[list[str], str]]:
    """Read one system after the other without end; yield what it is and what was wrong, empty if nothing."""
    before, fmus.cache_paths.DIST = fmus.cache_paths.DIST, folder / "dist"
    try:
        while True:
            shutil.rmtree(folder / "dist", ignore_errors=True)
            system = drawn(draw)
            text = structure(system, draw)
            is_damaged = draw.random() < 0.5
            _write(folder, system, _scrambled(text, draw) if is_damaged else text)
            yield ["ssp", "damaged" if is_damaged else str(system)], _mistake(folder / "odd.ssp", system, is_damaged)
    finally:
        fmus.cache_paths.DIST = before


def _write(folder: Path, system: System, text: str) -> None:
    _fmu(folder / "brain.fmu", system.brain)
    _fmu(folder / "plant.fmu", system.plant)
    with zipfile.ZipFile(folder / "odd.ssp", "w") as archive:
        archive.writestr("SystemStructure.ssd", text.encode(errors="replace"))
        archive.write(folder / "brain.fmu", "brain.fmu")
        archive.write(folder / "plant.fmu", "plant.fmu")


def _mistake(path: Path, system: System, is_damaged: bool) -> str:
    try:
        scenario, _, foreign = load_bound_scenario(str(path), [], NOBODY)
        instances = make_instances(scenario, None, Messages(), foreign)
        found = elaborate(scenario, instances)
        remarks(found, None)
    except BadInput as error:
        said = str(error)
        return "" if is_damaged and "\n" not in said else f"refused: {said}"
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    if is_damaged:
        return ""
    owner = "yard_plant" if system.is_nested else "plant"
    brain = next(item for item in found.instances if item.name == "brain")
    plant = next(item for item in found.instances if item.name == owner)
    for place, pin in enumerate(system.brain):
        brain.outputs.values[brain.outputs.index[pin.name]] = 10.0 + place
    for link in found.connections:
        given = found.instances[link.source].outputs.values[link.source_places]
        plant.inputs.values[link.target_places] = given if link.convert is None else link.convert(given)
    for wanted in system.links:
        got = plant.inputs.values[plant.inputs.index[wanted.target.name]]
        right = wanted.value(10.0 + system.brain.index(wanted.source))
        if not math.isclose(got, right, rel_tol=1e-12, abs_tol=1e-12):
            return f"{wanted}: {got!r}, expected {right!r}"
    given_values = scenario.parameters_for(owner)
    for item in system.settings:
        if not math.isclose(given_values.get(item.pin.name, math.nan), item.number(), rel_tol=1e-12, abs_tol=1e-12):
            return f"{item}: {given_values.get(item.pin.name)!r}, expected {item.number()!r}"
    return ""


def _scrambled(text: str, draw: random.Random) -> str:
    """Return a description with a few letters, words or elements changed."""
    words = (
        "brain",
        "plant",
        "input",
        "output",
        "parameter",
        "rad",
        "deg",
        "start",
        "end",
        "Real",
        "1.0",
        "true",
        "false",
    )
    for _ in range(draw.choice((1, 1, 2, 4))):
        change, at = draw.randrange(4), draw.randrange(len(text))
        if change == 0:
            text = text[:at] + draw.choice("<>\"'&;/ é\0\x07x1") + text[at + 1 :]
        elif change == 1:
            text = text.replace(draw.choice(words), draw.choice((*words, "", "1e999", "nan", "kg", "..", "/")), 1)
        elif change == 2:
            end = text.find(">", at) + 1
            begin = text.rfind("<", 0, at + 1)
            text = text[:begin] + text[max(begin, end) :]
        else:
            begin, end = text.rfind("<", 0, at + 1), text.find(">", at) + 1
            text = text[:end] + text[max(begin, 0) : end] + text[end:]
    return text
