"""Jacobi master on integer nanoseconds: fixed step, integer multi-rate, observers and manipulators.

At every exchange: read all outputs, write all inputs, then step all. One exchange takes place in
Initialization Mode. A slave with decimation n is stepped every n-th time by n communication steps;
its outputs are read, and its inputs written, only at those instants. No step goes beyond the stop time: the
last one ends there, and all outputs are read then.
"""

from collections.abc import Callable
from typing import NamedTuple, Protocol

from orchestrator.cosim.connections import Connection, connect
from orchestrator.cosim.slave import Array, Indices, Slave, all_values


class Observer(Protocol):
    """Sees every exchange, changes nothing: log, recording, progress bar."""

    def on_communication_point(self, t_ns: int) -> None:
        """Look at the slaves' arrays as they are at ``t_ns``."""

    def on_terminate(self, end: "End") -> None:
        """The run is over; called once, whatever the reason."""


class Manipulator(Protocol):
    """Changes inputs of one slave after an exchange: fault injection."""

    slave: int
    """Number of the slave whose inputs are changed."""

    def apply(self, t_ns: int) -> None:
        """Change the slave's input values in place."""


class Ending(Protocol):
    """Says when the run is over before its stop time."""

    def stop_reason(self, t_ns: int) -> str:
        """Return the reason to end now, or an empty string."""


class End(NamedTuple):
    """Why and when a run ended."""

    reason: str
    """``stop_time``, ``interrupted``, ``error: ...`` or what the ending said."""
    t_ns: int


class Interrupt:
    """A request to end after the exchange in hand; a signal handler sets it."""

    requested = False


Link = tuple[Array, Indices, Array, Indices, Callable[[Array], Array] | None]
"""Input array, places, output array, places, conversion of one connection."""


class _Instant(NamedTuple):
    """What happens at one phase of the multi-rate cycle."""

    due: list[Slave]
    links: list[Link]
    """Every connection into a slave that is due."""
    faults: list[Manipulator]
    steps: list[tuple[Slave, int]]


def last_exchange(step_ns: int, stop_ns: int) -> int:
    """Return the number of the exchange at the stop time; that at the start is number 0."""
    return -(-stop_ns // step_ns)


class Master:
    """Everything that takes part in one run."""

    def __init__(
        self,
        slaves: list[Slave],
        step_ns: int,
        stop_ns: int,
        decimation: dict[str, int] | None = None,
        connections: list[Connection] | None = None,
    ) -> None:
        self.slaves = slaves
        self.values = all_values(slaves)
        """All inputs and outputs in one array."""
        self.step_ns = step_ns
        self.stop_ns = stop_ns
        self.decimation = [(decimation or {}).get(slave.name, 1) for slave in slaves]
        self.connections = connect(slaves) if connections is None else connections
        """By equal names if nothing else is said."""
        self.manipulators: list[Manipulator] = []
        self.observers: list[Observer] = []
        self.endings: list[Ending] = []
        self.interrupt = Interrupt()

    def initialize(self) -> None:
        """Enter initialization, exchange once, leave it: time is zero."""
        for slave in self.slaves:
            slave.initialize(self.stop_ns)
        for slave in self.slaves:
            slave.fetch_outputs()
        for link in self.connections:
            target, target_places, source, source_places, convert = self._link(link)
            given = source[source_places]
            target[target_places] = given if convert is None else convert(given)
        for slave in self.slaves:
            slave.send_inputs()
        for slave in self.slaves:
            slave.start()

    def run(self) -> End:
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
            for slave in due:
                slave.fetch_outputs()
            for target, target_places, source, source_places, convert in links:
                given = source[source_places]
                target[target_places] = given if convert is None else convert(given)
            for fault in faults:
                fault.apply(t_ns)
            for observer in self.observers:
                observer.on_communication_point(t_ns)
            reason = self._over(t_ns, count == last)
            if reason:
                return End(reason, t_ns)
            for slave in due:
                slave.send_inputs()
            for slave, dt_ns in steps:
                slave.step(t_ns, min(dt_ns, self.stop_ns - t_ns))
            count += 1

    def finish(self, end: End) -> None:
        """Tell the observers."""
        for observer in self.observers:
            observer.on_terminate(end)

    def free(self) -> None:
        """Free the slaves."""
        for slave in self.slaves:
            slave.close()

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
        faults = [fault for fault in self.manipulators if fault.slave in due]
        steps = [(self.slaves[number], self.decimation[number] * self.step_ns) for number in due]
        return _Instant([self.slaves[number] for number in due], links, faults, steps)

    def _link(self, link: Connection) -> Link:
        inputs, outputs = self.slaves[link.target].inputs.values, self.slaves[link.source].outputs.values
        return inputs, link.target_places, outputs, link.source_places, link.convert
