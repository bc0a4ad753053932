"""Fault injection: what a receiver sees is changed between two exchanges, while the sender goes on.

The log shows both sides: the output as it is, the input as it was seen.
"""

from collections import deque

import numpy as np

from modelkit.random import normal, seed_state, uniform
from orchestrator.inputs.scenario.fault import Fault
from orchestrator.inputs.text.errors import BadInput, suggestion
from orchestrator.inputs.text.quantities import number, scalar
from orchestrator.simulation.cosim.algorithm import CoSimulation, Manipulator
from orchestrator.simulation.cosim.fmu_instance import Array, FmuInstance, Indices


class _Window:
    """A fault's place and time."""

    def __init__(self, fault: Fault, instance: int, values: Array, places: Indices) -> None:
        self.instance = instance
        self._values = values
        self._places = places
        self._start_ns = round(fault.start * 1e9)
        self._stop_ns = round(fault.stop * 1e9) if fault.stop <= 1e9 else 1 << 62

    def _active(self, t_ns: int) -> bool:
        return self._start_ns <= t_ns < self._stop_ns


class Override(_Window):
    """The receiver sees ``value``."""

    def __init__(self, fault: Fault, instance: int, values: Array, places: Indices, value: float) -> None:
        super().__init__(fault, instance, values, places)
        self._value = value

    def apply(self, t_ns: int) -> None:
        """Write the value."""
        if self._active(t_ns):
            self._values[self._places] = self._value


class Freeze(_Window):
    """The receiver sees for ever what it saw when the fault began."""

    _held: Array | None = None

    def apply(self, t_ns: int) -> None:
        """Write the held value."""
        if not self._active(t_ns):
            self._held = None
        elif self._held is None:
            self._held = self._values[self._places].copy()
        else:
            self._values[self._places] = self._held


class Drop(_Window):
    """Each exchange is lost with a probability; the receiver keeps what it received last."""

    def __init__(self, fault: Fault, instance: int, values: Array, places: Indices, seed: int) -> None:
        super().__init__(fault, instance, values, places)
        self._probability = fault.probability
        self._random = seed_state(seed)
        self._last: Array = values[places].copy()

    def apply(self, t_ns: int) -> None:
        """Put the last received value back, or note the new one."""
        if self._active(t_ns):
            self._random, chance = uniform(self._random)
            if chance < self._probability:
                self._values[self._places] = self._last
                return
        self._last = self._values[self._places].copy()


class Delay(_Window):
    """The receiver sees an old value; before there is one that old, the first one."""

    def __init__(self, fault: Fault, instance: int, values: Array, places: Indices) -> None:
        super().__init__(fault, instance, values, places)
        self._delay_ns = round((fault.delay or 0.0) * 1e9)
        self._past: deque[tuple[int, Array]] = deque()

    def apply(self, t_ns: int) -> None:
        """Write the newest value that is at least ``delay`` old."""
        self._past.append((t_ns, self._values[self._places].copy()))
        while len(self._past) > 1 and self._past[1][0] <= t_ns - self._delay_ns:
            self._past.popleft()
        if self._active(t_ns):
            self._values[self._places] = self._past[0][1]


class Noise(_Window):
    """White Gaussian noise on every exchange, the same for the same seed."""

    def __init__(self, fault: Fault, instance: int, values: Array, places: Indices, sigma: float, seed: int) -> None:
        super().__init__(fault, instance, values, places)
        self._sigma = sigma
        self._random = seed_state(seed)

    def apply(self, t_ns: int) -> None:
        """Add one draw to each of the signals."""
        if not self._active(t_ns):
            return
        for place in self._places:
            self._random, draw = normal(self._random)
            self._values[place] += self._sigma * draw


def manipulators(faults: list[Fault], master: CoSimulation, seed: int, file: object = None) -> list[Manipulator]:
    """Return a manipulator for every receiver of every fault. Raises ``BadInput`` for an unknown signal."""
    made: list[Manipulator] = []
    for count, instance, places in receivers(faults, master, file):
        own_seed = seed * SEED_STRIDE + len(made)
        made.append(_make(faults[count], instance, places, master.instances, own_seed, file, f"faults[{count + 1}]"))
    return made


SEED_STRIDE = 1000
"""Seeds of the manipulators of a run: so many times its own, and their number."""


def receivers(faults: list[Fault], master: CoSimulation, file: object = None) -> list[tuple[int, int, list[int]]]:
    """Return (fault, instance, input places) of every receiver of every fault, by their numbers, in their order.

    Raises ``BadInput`` for an unknown signal, or a fault that lacks something.
    """
    found = []
    for count, fault in enumerate(faults):
        key = f"faults[{count + 1}]"
        fault.check(file, key)
        found += [
            (count, instance, places) for instance, places in _receivers(fault.signal, master, file, f"{key}.signal")
        ]
    return found


def _make(
    fault: Fault, instance: int, places: list[int], instances: list[FmuInstance], seed: int, file: object, key: str
) -> Manipulator:
    ports = instances[instance].inputs
    where: tuple[Fault, int, Array, Indices] = (fault, instance, ports.values, np.array(places, dtype=np.intp))
    first = ports.variables[places[0]]
    if fault.kind == "stuck_at_last":
        return Freeze(*where)
    if fault.kind == "delay":
        return Delay(*where)
    if fault.kind == "dropout":
        return Drop(*where, seed)
    if fault.kind == "noise":
        if any(ports.variables[place].kind is not float for place in places):
            raise BadInput(f"noise needs a real signal, {fault.signal} is not", file=file, key=key)
        sigma = number(fault.sigma, first.signal.unit, file=file, key=f"{key}.sigma")
        if sigma < 0.0:
            raise BadInput(f"{sigma:g} is not 0 or more", file=file, key=f"{key}.sigma")
        return Noise(*where, sigma, seed)
    if first.kind is float:
        return Override(*where, number(fault.value, first.signal.unit, file=file, key=f"{key}.value", any_value=True))
    return Override(*where, float(scalar(fault.value, first, file=file)))


def _receivers(signal: str, master: CoSimulation, file: object, key: str) -> list[tuple[int, list[int]]]:
    """Return (instance number, input places) of all that receive ``signal``; values set from outside are not."""
    instances = master.instances
    owner, _, name = signal.partition(".")
    names = [instance.name for instance in instances]
    if owner not in names:
        raise BadInput(f"{signal!r}: expected one of {', '.join(names)} before the dot", file=file, key=key)
    own = instances[names.index(owner)]
    inputs = own.inputs.names[: own.inputs.own]
    if _matching(inputs, name):
        return [(names.index(owner), _matching(inputs, name))]
    if not _matching(own.outputs.names, name):
        known = own.outputs.names + inputs
        raise BadInput(f"{owner} has no signal {name!r}{suggestion(name, known, f'{owner}.')}", file=file, key=key)
    sent = set(_matching(own.outputs.names, name))
    places: dict[int, set[int]] = {}
    for link in master.connections:
        for source, target in zip(link.source_places.tolist(), link.target_places.tolist(), strict=True):
            if instances[link.source] is own and source in sent and target < instances[link.target].inputs.own:
                places.setdefault(link.target, set()).add(target)
    if not places:
        raise BadInput(f"{signal} is not an input of any component", file=file, key=key)
    return [(number, sorted(places[number])) for number in sorted(places)]


def _matching(names: list[str], wanted: str) -> list[int]:
    return [
        place for place, name in enumerate(names) if name == wanted or name.startswith((wanted + ".", wanted + "["))
    ]
