"""From what a system says feeds an input to the connection that does it. Names that do not exist are answered."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from modelkit.variables import Variable
from orchestrator.inputs.scenario.end_condition import state_word
from orchestrator.inputs.scenario.wiring.system_text import Feed, PoseFrame, Term, terms
from orchestrator.inputs.text.errors import BadInput, suggestion, suggestion_or_choices
from orchestrator.inputs.text.quantities import scalar, unit_symbol
from orchestrator.simulation.cosim.connections import Connection
from orchestrator.simulation.cosim.fmu_instance import FmuInstance, Ports
from orchestrator.simulation.system.conversions import Affine, PoseChange, ValueMap
from orchestrator.simulation.system.units import UnfitUnitsError, conversion

UNITS_OF_A_POSE = ("m", "m", "rad")


class Connector(NamedTuple):
    """One end of a connection: a variable of an instance, and what is written beside it."""

    instance: int
    place: int
    variable: Variable
    ports: Ports
    unit: str | None
    """What its number is in; None: nobody says."""
    sign: float
    name: str


class SignalNames:
    """The names of all inputs, or of all outputs, of instances: ``plant.Wheel Angle, left``."""

    def __init__(self, instances: Sequence[FmuInstance], is_input: bool) -> None:
        self._ports = {instance.name: instance.inputs if is_input else instance.outputs for instance in instances}

    def __contains__(self, full: object) -> bool:
        owner, _, name = str(full).partition(".")
        ports = self._ports.get(owner)
        return ports is not None and ports.index.get(name, ports.own) < ports.own


def pins_of(
    text: str, instances: Sequence[FmuInstance], is_input: bool, file: object, key: str, other: str = ""
) -> list[Connector]:
    """Return the signals that ``text`` means: by name, or all of a group. ``other`` is the other end, for messages.

    Raises ``BadInput`` with the closest.
    """
    found = terms(text, SignalNames(instances, is_input))
    return [end for term in found for end in _pins(term, instances, is_input, SignalPlace(file, key, other))]


class SignalPlace(NamedTuple):
    """Where a signal is written, and what stands at the other end of its connection."""

    file: object
    key: str
    other: str

    def wrong(self, text: str) -> BadInput:
        """Return the error that says what is wrong here."""
        return BadInput(text, file=self.file, key=self.key)


def _pins(term: Term, instances: Sequence[FmuInstance], is_input: bool, place: SignalPlace) -> list[Connector]:
    owner, _, name = term.name.partition(".")
    names = [instance.name for instance in instances]
    if owner not in names:
        hint = suggestion(owner, names) or f"; there are {', '.join(names)}"
        raise place.wrong(f"no instance is called {owner!r}{hint}")
    number = names.index(owner)
    ports = instances[number].inputs if is_input else instances[number].outputs
    own = ports.names[: ports.own]
    found = [name] if name in own else [item for item in own if item.startswith((f"{name}.", f"{name}["))]
    if not found:
        what = "input" if is_input else "output"
        close = suggestion(name, own, f"{owner}.") or f"; it has {', '.join(own[:12]) or 'none'}"
        raise place.wrong(f"{owner} has no {what} {name!r}{close}")
    sign = -1.0 if term.minus else 1.0
    return [
        Connector(number, ports.index[item], ports.variables[ports.index[item]], ports, unit, sign, f"{owner}.{item}")
        for item in found
        for unit in (_unit(term, item, ports, is_input, place),)
    ]


def _unit(term: Term, name: str, ports: Ports, is_input: bool, place: SignalPlace) -> str | None:
    """Return the unit of a signal: its FMU's; what is written where that says none, or 1."""
    written, said = term.unit, None if name in ports.unsaid else ports.variables[ports.index[name]].signal.unit
    if written is None or written == said or (said is not None and written == unit_symbol(said)):
        return said
    if said not in (None, "1"):
        raise place.wrong(
            f"{term.name} is in {said}, as its FMU says, not in {written}; {_line(term, is_input, place)}"
        )
    ports.unsaid -= {name}
    return written


def _line(term: Term, is_input: bool, place: SignalPlace) -> str:
    """Return the line to write where a unit stands beside a signal that has another."""
    minus = "-" if term.minus else ""
    if not place.other or "," in place.other:
        return f"write {minus}{term.name} alone, which is converted, and a unit beside a signal that has none"
    other = place.other if place.other.endswith("]") else f"{place.other} [{term.unit}]"
    ends = (term.name, other) if is_input else (other, minus + term.name)
    advice = f"write '{ends[0]}: {ends[1]}', or no unit if both FMUs declare theirs"
    return f"a unit belongs beside a signal whose FMU declares none: {advice}"


def declare_units(instance: FmuInstance, written: Mapping[str, str], file: object) -> None:
    """Have variables of which an FMU declares no unit in the units that are ``written``. Raises ``BadInput``."""
    for name, unit in written.items():
        key = f"system.components.{instance.name}.units.{name}"
        ports = next((item for item in (instance.inputs, instance.outputs) if name in item.index), None)
        names = [*instance.inputs.names, *instance.outputs.names, *instance.parameters.names]
        if ports is None and name not in instance.parameters.index:
            raise BadInput(f"{instance.name} has no such variable{suggestion(name, names)}", file=file, key=key)
        if ports is None:
            continue
        place, symbol = ports.index[name], unit if unit in ports.scales else unit_symbol(unit)
        variable = ports.variables[place]
        said = variable.signal.unit
        if name in ports.unsaid or said == "1":
            ports.variables[place] = variable._replace(signal=variable.signal._replace(unit=symbol))
            ports.unsaid -= {name}
        elif symbol not in (said, unit_symbol(said)):
            raise BadInput(f"{name} is in {said}, as its FMU says, not in {unit}", file=file, key=key)


class ConnectionBuilder:
    """Makes connections of one system."""

    def __init__(self, instances: Sequence[FmuInstance], frames: dict[str, PoseFrame], file: object) -> None:
        self._instances = instances
        self._frames = frames
        self._file = file

    def constant(self, feed: Feed, targets: list[Connector], key: str) -> None:
        """Give inputs a value that they keep."""
        for end in targets:
            named = end.variable._replace(name=key, signal=end.variable.signal._replace(unit=end.unit or "1"))
            self._instances[end.instance].inputs.values[end.place] = float(scalar(feed.value, named, file=self._file))

    def connections(self, feed: Feed, targets: list[Connector], key: str) -> list[Connection]:
        """Return what feeds ``targets``. Raises ``BadInput`` if number, unit or frame do not fit."""
        other = key.removeprefix("system.connections.") if key.startswith("system.connections.") else ""
        sources = pins_of(feed.from_, self._instances, False, self._file, key, other)
        if len(sources) != len(targets):
            raise self._wrong(f"{len(targets)} inputs, but {len(sources)} signals to feed them", key)
        if feed.into is not None or feed.out_of is not None:
            return [self._pose(feed, sources, targets, key)]
        if feed.map is not None:
            return [self._map_connection(feed, *pair, key) for pair in zip(sources, targets, strict=True)]
        return [self._scale_connection(feed, *pair, key) for pair in zip(sources, targets, strict=True)]

    def _scale_connection(self, feed: Feed, source: Connector, target: Connector, key: str) -> Connection:
        factor, offset = self._factor(source, target, key) if feed.units else (1.0, 0.0)
        gain = source.sign * target.sign * feed.factor
        whole = gain * factor, feed.offset * factor + offset
        same = whole == (1.0, 0.0) and source.variable.kind is target.variable.kind
        return _connection(source, target, None if same else Affine(whole[:1], whole[1:], [target.variable]))

    def _factor(self, source: Connector, target: Connector, key: str) -> tuple[float, float]:
        if source.unit is None or target.unit is None:
            return 1.0, 0.0
        try:
            return conversion(source.unit, target.unit, source.ports.scales, target.ports.scales)
        except UnfitUnitsError as error:
            ends = f"{source.name} is in {source.unit}, {target.name} in {target.unit}"
            raise self._wrong(f"{ends}: {error}", key) from None

    def _map_connection(self, feed: Feed, source: Connector, target: Connector, key: str) -> Connection:
        assert feed.map is not None
        named = target.variable._replace(name=f"{key}.map")
        values = {
            _state(given, source.variable, self._file, key): float(scalar(taken, named, file=self._file))
            for given, taken in feed.map.items()
        }
        other = target.variable.start if feed.otherwise is None else feed.otherwise
        otherwise = float(scalar(other, named, file=self._file))
        return _connection(source, target, ValueMap(values, otherwise))

    def _pose(self, feed: Feed, sources: list[Connector], targets: list[Connector], key: str) -> Connection:
        if (
            len(targets) != 3
            or len({end.instance for end in sources}) > 1
            or len({end.instance for end in targets}) > 1
        ):
            raise self._wrong("a pose is x, y and heading of one instance", key)
        frame = self._frames[feed.into or feed.out_of or ""]
        before = [self._factor(end, _in_si(end, unit), key) for end, unit in zip(sources, UNITS_OF_A_POSE, strict=True)]
        after = [self._factor(_in_si(end, unit), end, key) for end, unit in zip(targets, UNITS_OF_A_POSE, strict=True)]
        change = PoseChange(
            frame,
            feed.into is not None,
            Affine([pair[0] * end.sign for pair, end in zip(before, sources, strict=True)], _seconds(before), ()),
            Affine([pair[0] * end.sign for pair, end in zip(after, targets, strict=True)], _seconds(after), ()),
        )
        return Connection(sources[0].instance, _places(sources), targets[0].instance, _places(targets), change)

    def _wrong(self, text: str, key: str) -> BadInput:
        return BadInput(text, file=self._file, key=key)


def join_connections(found: list[Connection]) -> list[Connection]:
    """Return the connections, those of equal instances that need no conversion as one."""
    plain: dict[tuple[int, int], list[Connection]] = {}
    for item in found:
        if item.convert is None:
            plain.setdefault((item.source, item.target), []).append(item)
    together = [
        Connection(
            source,
            np.concatenate([item.source_places for item in items]),
            target,
            np.concatenate([item.target_places for item in items]),
        )
        for (source, target), items in plain.items()
    ]
    return [*together, *(item for item in found if item.convert is not None)]


def _connection(source: Connector, target: Connector, convert: Affine | ValueMap | None) -> Connection:
    return Connection(source.instance, _places([source]), target.instance, _places([target]), convert)


def _places(ends: list[Connector]) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    return np.array([end.place for end in ends], dtype=np.intp)


def _seconds(pairs: list[tuple[float, float]]) -> list[float]:
    return [offset for _, offset in pairs]


def _in_si(end: Connector, unit: str) -> Connector:
    """Return an end whose number is in ``unit``, as a pose has it between its two ends."""
    return end._replace(unit=unit, name="that number of a pose")


def _state(given: int | str, variable: Variable, file: object, key: str) -> float:
    states = variable.signal.states
    if isinstance(given, int) or given.strip().lstrip("-").isdigit():
        return float(given)
    names = {} if states is None else {state.name: int(state) for state in states}
    word = state_word(given)
    if word not in names:
        hint = suggestion_or_choices(word, list(names))
        raise BadInput(f"{given!r} is no state of {variable.name}{hint}", file=file, key=f"{key}.map")
    return float(names[word])
