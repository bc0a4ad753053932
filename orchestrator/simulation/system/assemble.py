"""Instances, and what the scenario says of them, as what the algorithm runs: instances and connections."""

from typing import NamedTuple

import numpy as np

from fmus.contents.units import BASE
from modelkit.connections import CannotConnectError, Wire
from modelkit.connections import connections as by_name
from modelkit.variables import Variable, variables
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.scenario.wiring.system_text import ROLES, Feed, SystemText, UnitEntry
from orchestrator.inputs.text.errors import BadInput, suggestion
from orchestrator.simulation.cosim.connections import Connection, bundle_wires, part_of_instance
from orchestrator.simulation.cosim.fmu_instance import FmuInstance, Scale
from orchestrator.simulation.system.feeds import ConnectionBuilder, Connector, declare_units, join_connections, pins_of
from orchestrator.simulation.system.listener import Listener
from orchestrator.simulation.system.units import scale_of

JUDGED = {"vehicle": ("pose.x", "pose.y", "pose.heading", "speed"), "controller": ("phase", "manoeuvres")}
"""Outputs that a verdict is made of."""


class ElaboratedSystem(NamedTuple):
    """A system that can run."""

    instances: list[FmuInstance]
    """Those given, and one for each name that roles are seen under and no instance has."""
    connections: list[Connection]
    fed: frozenset[tuple[int, int]]
    """(instance, place) of each input that is connected or constant."""


def elaborate(scenario: Scenario, given: list[FmuInstance]) -> ElaboratedSystem:
    """Return the system of ``scenario``. Raises ``BadInput`` for what cannot be connected as it says."""
    text = scenario.system or SystemText()
    _declare(text, given, scenario.file)
    for instance in given:
        _check_units(instance, scenario.file)
    instances, feeds = _with_roles(text, given, scenario.file)
    feeder = ConnectionBuilder(instances, text.frames, scenario.file or None)
    found: list[Connection] = []
    fed: set[tuple[int, int]] = set()
    for key, feed in text.connections.items():
        where = f"system.connections.{key}"
        targets = pins_of(key, instances, True, scenario.file or None, where, feed.from_)
        _once(targets, fed, scenario.file, where)
        fed |= {(pin.instance, pin.place) for pin in targets}
        if feed.from_:
            found += feeder.connections(feed, targets, where)
        else:
            feeder.constant(feed, targets, where)
    for signal in text.modes:
        pins_of(signal, instances, False, scenario.file or None, f"system.modes.{signal}")
    wires = _matching(instances, fed) if text.by_name else []
    fed |= {(wire.target, wire.input) for wire in wires}
    plain = join_connections(found)
    roles = [link for key, (feed, targets) in feeds.items() for link in _role(feeder, feed, targets, instances, key)]
    connections = [*bundle_wires(wires), *plain, *join_connections(roles)]
    for number, instance in enumerate(instances):
        sent = [place for link in connections if link.source == number for place in link.source_places.tolist()]
        judged = [
            instance.outputs.index[name] for name in JUDGED.get(instance.name, ()) if name in instance.outputs.index
        ]
        instance.outputs.used = np.array(sorted({*sent, *judged}), dtype=np.intp)
    return ElaboratedSystem(instances, connections, frozenset(fed))


def _declare(text: SystemText, instances: list[FmuInstance], file: str) -> None:
    """Have the instances know the units that the system defines, and those that it says of their variables."""
    defined = {name: _scale(entry) for name, entry in text.units.items()}
    for instance in instances:
        for ports in (instance.inputs, instance.outputs) if defined else ():
            ports.scales = {**defined, **ports.scales}
        entry = text.components.get(instance.name)
        if entry is not None and entry.units:
            declare_units(instance, entry.units, file or None)


def _scale(entry: UnitEntry) -> Scale:
    return Scale(entry.factor, entry.offset, tuple(getattr(entry, base) for base in BASE))


def _check_units(instance: FmuInstance, file: str) -> None:
    """Raise ``BadInput`` for an output that the judge takes under its name as ours has it, in another unit."""
    ours = {item.name: item for item in variables(MODELS[instance.name].outputs)} if instance.name in MODELS else {}
    for item in instance.outputs.variables:
        known = ours.get(item.name)
        if known is None or item.kind is not float or item.name in instance.outputs.unsaid or item.signal.unit == "1":
            continue
        wanted, given = scale_of(known.signal.unit, {}), scale_of(item.signal.unit, instance.outputs.scales)
        if item.signal.unit != known.signal.unit and (given is None or given != wanted):
            role = next((short for short, names in ROLES.items() if f"{instance.name}.{item.name}" in names), item.name)
            roles = f"roles: {{{role}: plant.{item.name}}}"
            line = f"system: {{components: {{{instance.name}: none, plant: FILE.fmu}}, {roles}}}"
            text = f"{instance.name}.{item.name} is in {item.signal.unit}, but judged in {known.signal.unit}"
            raise BadInput(f"{text}; call the instance otherwise, a role is converted: '{line}'", file=file or None)


def _matching(instances: list[FmuInstance], fed: set[tuple[int, int]]) -> list[Wire]:
    try:
        return by_name([part_of_instance(instance) for instance in instances], fed)
    except CannotConnectError as error:
        advice = "; connect it in the scenario's system: connections, where units are converted"
        line = f": '{error.line}'" if error.line else ""
        raise BadInput(error.text + advice + line, key=error.signal) from None


def _once(targets: list[Connector], fed: set[tuple[int, int]], file: str, key: str) -> None:
    twice = [pin.name for pin in targets if (pin.instance, pin.place) in fed]
    if twice:
        raise BadInput(f"{', '.join(twice)} is fed twice", file=file, key=key)


def _with_roles(
    text: SystemText, given: list[FmuInstance], file: str
) -> tuple[list[FmuInstance], dict[str, tuple[Feed, list[Connector]]]]:
    """Return the instances with a place for each role, and role -> (what it is, its places)."""
    instances = list(given)
    found = {}
    for role, feed in text.roles.items():
        key = f"system.roles.{role}"
        targets = []
        for name in _signals_of(role, file, key):
            owner, _, signal = name.partition(".")
            if owner not in [instance.name for instance in instances]:
                instances.append(Listener(owner))
            number = [instance.name for instance in instances].index(owner)
            targets.append(_role_input(instances[number], number, signal, feed, file, key))
        found[key] = (feed, targets)
    return instances, found


def _role_input(instance: FmuInstance, number: int, signal: str, feed: Feed, file: str, key: str) -> Connector:
    if signal in instance.outputs.index:
        text = f"{instance.name} has an output {signal}, which plays this role already; call the instance otherwise"
        raise BadInput(text, file=file or None, key=key)
    ports = instance.inputs
    if signal not in ports.index:
        ports.add_told(_ours(instance.name, signal, feed))
    place = ports.index[signal]
    variable = ports.variables[place]
    return Connector(number, place, variable, ports, variable.signal.unit, 1.0, f"{instance.name}.{signal}")


def _ours(owner: str, signal: str, feed: Feed) -> Variable:
    """Return the variable as our models have it; its states are those of the feed, if that names any."""
    from orchestrator.simulation.cosim.model_description import states_called

    variable = next(item for item in variables(MODELS[owner].outputs) if item.name == signal)
    if feed.states is not None:
        names = {name.upper(): value for name, value in feed.states.items()}
        states = states_called("".join(part.title() for part in signal.split("_")), names)
        variable = variable._replace(signal=variable.signal._replace(states=states))
    return variable


def _signals_of(role: str, file: str, key: str) -> tuple[str, ...]:
    if role in ROLES:
        return ROLES[role]
    known = [f"{owner}.{item.name}" for owner, model in MODELS.items() for item in variables(model.outputs)]
    if role in known:
        return (role,)
    names = [*ROLES, *known]
    hint = suggestion(role, names) or f"; expected {', '.join(ROLES)} or an output of ours (apa list signals)"
    raise BadInput(f"no such role{hint}", file=file or None, key=key)


def _role(
    feeder: ConnectionBuilder, feed: Feed, targets: list[Connector], instances: list[FmuInstance], key: str
) -> list[Connection]:
    """Return what brings a signal to its role; a mode whose FMU names its states keeps their names."""
    if not feed.from_:
        raise BadInput("a role is a signal, not a constant", key=key)
    found = feeder.connections(feed, targets, key)
    source = instances[found[0].source].outputs.variables[int(found[0].source_places[0])]
    if source.signal.states is not None and feed.map is None and feed.states is None and len(targets) == 1:
        signal = targets[0].variable.signal._replace(states=source.signal.states)
        targets[0].ports.variables[targets[0].place] = targets[0].variable._replace(signal=signal)
    return found
