"""Jacobi master on integer nanoseconds: fixed step, integer multi-rate, observers and manipulators.

At every exchange: read all outputs, write all inputs, then step all. One exchange takes place in
Initialization Mode. An instance with decimation n is stepped every n-th time by n communication steps;
its outputs are read, and its inputs written, only at those instants. No step goes beyond the stop time: the
last one ends there, and all outputs are read then.
"""

from collections.abc import Callable
from typing import NamedTuple, Protocol, runtime_checkable

from orchestrator.simulation.cosim.connections import Connection, connect
from orchestrator.simulation.cosim.fmu_instance import Array, FmuInstance, Indices, all_values
from orchestrator.simulation.cosim.signal_blocks import Times


class Observer(Protocol):
    """Sees every exchange, changes nothing: log, recording, progress bar."""

    def on_communication_point(self, t_ns: int) -> None:
        """Look at the instances' arrays as they are at ``t_ns``."""

    def on_terminate(self, end: "Termination") -> None:
        """The run is over; called once, whatever the reason."""


@runtime_checkable
class BlockObserver(Protocol):
    """An observer that can also look at many exchanges at once."""

    def observe_rows(self, t_ns: Times, rows: Array) -> None:
        """Look at exchanges that followed one another: their times [ns], and all values (n, values) of each."""


class Manipulator(Protocol):
    """Changes inputs of one instance after an exchange: fault injection."""

    instance: int
    """Number of the instance whose inputs are changed."""

    def apply(self, t_ns: int) -> None:
        """Change the instance's input values in place."""


class StopCondition(Protocol):
    """Ends the run before its stop time."""

    def stop_reason(self, t_ns: int) -> str:
        """Return the reason to end now, or an empty string."""


@runtime_checkable
class BlockStopCondition(Protocol):
    """A stop condition that can also look at many exchanges at once."""

    def first_reached(self, t_ns: Times, rows: Array) -> tuple[int, str] | None:
        """Return the first of exchanges that followed one another at which the run is over, and the reason."""


class Termination(NamedTuple):
    """Why and when a run ended."""

    reason: str
    """``stop_time``, ``interrupted``, ``error: ...`` or the reason of the stop condition."""
    t_ns: int


class Interrupt:
    """A request to end after the exchange in hand; a signal handler sets it."""

    requested = False


Link = tuple[Array, Indices, Array, Indices, Callable[[Array], Array] | None]
"""Input array, places, output array, places, conversion of one connection."""


class _Instant(NamedTuple):
    """What happens at one phase of the multi-rate cycle."""

    due: list[FmuInstance]
    links: list[Link]
    """Every connection into an instance that is due."""
    faults: list[Manipulator]
    steps: list[tuple[FmuInstance, int]]


def last_exchange(step_ns: int, stop_ns: int) -> int:
    """Return the number of the exchange at the stop time; that at the start is number 0."""
    return -(-stop_ns // step_ns)


class CoSimulation:
    """Everything that takes part in one run."""

    def __init__(
        self,
        instances: list[FmuInstance],
        step_ns: int,
        stop_ns: int,
        decimation: dict[str, int] | None = None,
        connections: list[Connection] | None = None,
    ) -> None:
        self.instances = instances
        self.values = all_values(instances)
        """All inputs and outputs in one array."""
        self.step_ns = step_ns
        self.stop_ns = stop_ns
        self.decimation = [(decimation or {}).get(instance.name, 1) for instance in instances]
        self.connections = connect(instances) if connections is None else connections
        """By default by equal names."""
        self.manipulators: list[Manipulator] = []
        self.observers: list[Observer] = []
        self.endings: list[StopCondition] = []
        self.interrupt = Interrupt()

    def initialize(self) -> None:
        """Enter initialization, exchange once, leave it: time is zero."""
        for instance in self.instances:
            instance.initialize(self.stop_ns)
        for instance in self.instances:
            instance.fetch_outputs()
        for link in self.connections:
            target, target_places, source, source_places, convert = self._link(link)
            given = source[source_places]
            target[target_places] = given if convert is None else convert(given)
        for instance in self.instances:
            instance.send_inputs()
        for instance in self.instances:
            instance.start()

    def run(self) -> Termination:
        """Exchange and step until an ending, the stop time or an interrupt. Raises ``RunError``."""
        instants: dict[tuple[bool, ...], _Instant] = {}
        last = last_exchange(self.step_ns, self.stop_ns)
        count = 0
        while True:
            t_ns = min(count * self.step_ns, self.stop_ns)
            pattern = tuple([count % every == 0 or count == last for every in self.decimation])
            if pattern not in instants:
                instants[pattern] = self._instant(pattern)
            due, links, faults, steps = instants[pattern]
            for instance in due:
                instance.fetch_outputs()
            for target, target_places, source, source_places, convert in links:
                given = source[source_places]
                target[target_places] = given if convert is None else convert(given)
            for fault in faults:
                fault.apply(t_ns)
            for observer in self.observers:
                observer.on_communication_point(t_ns)
            reason = self._over(t_ns, count == last)
            if reason:
                return Termination(reason, t_ns)
            for instance in due:
                instance.send_inputs()
            for instance, dt_ns in steps:
                instance.step(t_ns, min(dt_ns, self.stop_ns - t_ns))
            count += 1

    def finish(self, end: Termination) -> None:
        """Report the termination to the observers."""
        for observer in self.observers:
            observer.on_terminate(end)

    def free(self) -> None:
        """Free the instances."""
        for instance in self.instances:
            instance.close()

    def _over(self, t_ns: int, last: bool) -> str:
        if self.interrupt.requested:
            return "interrupted"
        for ending in self.endings:
            reason = ending.stop_reason(t_ns)
            if reason:
                return reason
        return "stop_time" if last else ""

    def _instant(self, pattern: tuple[bool, ...]) -> "_Instant":
        due = [number for number, is_due in enumerate(pattern) if is_due]
        links = [self._link(link) for link in self.connections if link.target in due]
        faults = [fault for fault in self.manipulators if fault.instance in due]
        steps = [(self.instances[number], self.decimation[number] * self.step_ns) for number in due]
        return _Instant([self.instances[number] for number in due], links, faults, steps)

    def _link(self, link: Connection) -> Link:
        inputs, outputs = self.instances[link.target].inputs.values, self.instances[link.source].outputs.values
        return inputs, link.target_places, outputs, link.source_places, link.convert
