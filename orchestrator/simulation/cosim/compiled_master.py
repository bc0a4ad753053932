"""The Python master's exchange as compiled calls: FMUs driven through their C functions, without the GIL.

``fmus/native/c/master.c`` does a block of exchanges at a time and writes all signals of each into rows
allocated once. Afterwards the observers and endings see the rows of the block at once, or one by one in the
instances' arrays as if they had been there.
An ending in mid-block means that the FMUs have run on for the rest of it, which is not used.

It covers FMUs of any kind in this process. Faults change inputs between exchange and step, so a run with
manipulators takes the Python loop; so does one with conversions, with a model in process or an FMU in a
process of its own, and one on a machine where the compiled loop cannot be built.
"""

import ctypes
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np

from fmus.native.structures import Long, Pointer, structure
from orchestrator.simulation.cosim.algorithm import (
    BlockObserver,
    BlockStopCondition,
    CoSimulation,
    Observer,
    StopCondition,
    Termination,
    last_exchange,
)
from orchestrator.simulation.cosim.connections import Connection
from orchestrator.simulation.cosim.fmu_instance import Array, Indices, all_values, places_of
from orchestrator.simulation.cosim.local_instance import LocalInstance, Transfer
from orchestrator.simulation.cosim.signal_blocks import Times

EXCHANGES_PER_CALL = 500
"""Exchanges per compiled call."""
FETCH, SEND, STEP = 1, 2, 3
ObserverOfBlock = Callable[[Times, Array], None]
EndingOfBlock = Callable[[Times, Array], tuple[int, str] | None]

TransferC = structure(
    "TransferC", call=Pointer, references=Pointer, integers=Pointer, begin=Long, count=Long, changed=Long
)
InstanceC = structure(
    "InstanceC",
    component=Pointer,
    do_step=Pointer,
    begin=Long,
    count=Long,
    gets=Pointer,
    sets=Pointer,
    get_count=Long,
    set_count=Long,
    integers=Pointer,
    integers_begin=Long,
    integers_count=Long,
    held=Pointer,
    held_count=Long,
    every=Long,
    step=ctypes.c_double,
    due=Long,
)
LinkC = structure("LinkC", target=Pointer, set=Pointer, source_places=Pointer, target_places=Pointer, count=Long)
RunC = structure(
    "RunC",
    instances=Pointer,
    links=Pointer,
    before=Pointer,
    instance_count=Long,
    link_count=Long,
    width=Long,
    kept=Long,
    step_ns=Long,
    stop_ns=Long,
    last=Long,
    failed=Long,
    failure=Long,
    status=Long,
)


class CompiledMaster(CoSimulation):
    """A master whose loop is compiled wherever it can be."""

    _plan: "_Plan | None" = None

    def initialize(self) -> None:
        """Enter initialization, exchange once, leave it, and lay out the loop's memory: time is zero."""
        super().initialize()
        fmus = [instance for instance in self.instances if isinstance(instance, LocalInstance)]
        self._plan = None
        plain = all(link.convert is None for link in self.connections) and all(
            len(instance.inputs.names) == instance.inputs.own for instance in self.instances
        )
        if not self.manipulators and plain and len(fmus) == len(self.instances):
            with suppress(RuntimeError):
                self._plan = _Plan(self, fmus)

    def run(self) -> Termination:
        """Exchange and step until an ending, the stop time or an interrupt. Raises ``RunError``."""
        if self._plan is None:
            return super().run()
        return self._run_blocks(self._plan)

    def _run_blocks(self, plan: "_Plan") -> Termination:
        first = 0
        endings = [self._ending_of_block(ending) for ending in self.endings]
        observers = [self._observer_of_block(observer) for observer in self.observers]
        is_seen = bool(observers or endings)
        kept = plan.keep_rows(EXCHANGES_PER_CALL if is_seen else 2)
        while True:
            count = plan.advance(first)
            unseen = 0 if is_seen else max(count - 1, 0)
            begin = (first + unseen) % kept
            rows = plan.rows_of_ports(begin, begin + count - unseen)
            times = np.minimum(np.arange(first + unseen, first + count, dtype=np.int64) * self.step_ns, self.stop_ns)
            if len(times):
                seen, reason = self._end_in_block(endings, times, rows, first + count - 1 == plan.last)
                for observe_rows in observers:
                    observe_rows(times[:seen], rows[:seen])
                self.values[:] = rows[seen - 1]
                if reason:
                    return Termination(reason, int(times[seen - 1]))
            first += count
            plan.check(first)

    def _end_in_block(self, endings: list[EndingOfBlock], times: Times, rows: Array, has_last: bool) -> tuple[int, str]:
        """Return how many exchanges of a block take place, and why the run is over after them; empty if it goes on."""
        if self.interrupt.requested:
            return 1, "interrupted"
        found = len(times), "stop_time" if has_last else ""
        for first_reached in endings:
            reached = first_reached(times, rows)
            if reached is not None and (reached[0] + 1 < found[0] or found[1] in ("", "stop_time")):
                found = reached[0] + 1, reached[1]
        return found

    def _ending_of_block(self, ending: StopCondition) -> EndingOfBlock:
        """Return where an ending ends a block and the reason, of one that looks at single exchanges too."""

        def first_reached(times: Times, rows: Array) -> tuple[int, str] | None:
            for row, t_ns in enumerate(times.tolist()):
                self.values[:] = rows[row]
                reason = ending.stop_reason(t_ns)
                if reason:
                    return row, reason
            return None

        return ending.first_reached if isinstance(ending, BlockStopCondition) else first_reached

    def _observer_of_block(self, observer: Observer) -> ObserverOfBlock:
        """Return how an observer is shown a block: exchange by exchange if it cannot look at all at once."""

        def observe_rows(times: Times, rows: Array) -> None:
            for row, t_ns in enumerate(times.tolist()):
                self.values[:] = rows[row]
                observer.on_communication_point(t_ns)

        return observer.observe_rows if isinstance(observer, BlockObserver) else observe_rows


class _Plan:
    """The C structures of one run, and all memory they point to.

    A row of the compiled loop has the values of each instance's inputs, then of its outputs, in the order of the
    transfers, so that those of one type lie together and an FMU reads and writes them in place.
    """

    def __init__(self, master: CoSimulation, fmus: list[LocalInstance]) -> None:
        from fmus.native.library_cache import master_library

        self._call = ctypes.CDLL(str(master_library())).master_run
        self._call.restype = ctypes.c_int64
        self._call.argtypes = [Pointer, Long, Long, Pointer]
        self._fmus = fmus
        self._kept: list[Any] = []
        self._step_ns = master.step_ns
        self.last = last_exchange(master.step_ns, master.stop_ns)
        self._begins = [part.start for part in places_of(fmus)]
        groups = [group for instance in fmus for group in (instance.sets, instance.gets)]
        order = np.concatenate([begin + _order(group) for begin, group in zip(self._begins, groups, strict=True)])
        self._columns = np.argsort(order)
        """Place of a value in all ports -> its place in a row."""
        before = all_values(fmus)[order]
        self.rows = np.full((EXCHANGES_PER_CALL, len(before)), np.nan)
        self._transfers = [_Transfers(group, begin) for group, begin in zip(groups, self._begins, strict=True)]
        self._instances = (InstanceC * len(fmus))(*[self._instance(number, master) for number in range(len(fmus))])
        parts = [(link, number) for link in master.connections for number in range(len(fmus[link.target].sets))]
        links = (LinkC * len(parts))(*[self._link(link, number) for link, number in parts])
        self._kept += [before, links]
        pointers = (ctypes.addressof(self._instances), ctypes.addressof(links), before.ctypes.data)
        self._run = RunC(*pointers, len(fmus), len(links), len(before), 2, master.step_ns, master.stop_ns, self.last)
        self._addresses = ctypes.addressof(self._run), self.rows.ctypes.data

    def rows_of_ports(self, begin: int, end: int) -> Any:
        """Return the rows with their values in the order of the master's."""
        return self.rows[begin:end].take(self._columns, axis=1)

    def keep_rows(self, count: int) -> int:
        """Keep the rows of the last ``count`` exchanges, two or more; return that."""
        self._run.kept = count
        return count

    def advance(self, first: int) -> int:
        """Do a block of exchanges; return how many are complete."""
        run, rows = self._addresses
        return int(self._call(run, first, EXCHANGES_PER_CALL, rows))

    def check(self, number: int) -> None:
        """Raise the ``RunError`` of the instance that refused in the block just done; ``number`` rows are complete."""
        instance, status = self._fmus[self._run.failed], self._run.status
        if self._run.failure == FETCH:
            raise instance.no_outputs(status)
        if self._run.failure == SEND:
            raise instance.no_inputs(status)
        if self._run.failure == STEP:
            raise instance.no_step((number - 1) * self._step_ns, status)

    def _instance(self, number: int, master: CoSimulation) -> Any:
        instance, every, begin = self._fmus[number], master.decimation[number], self._begins[2 * number]
        sets, gets = self._transfers[2 * number : 2 * number + 2]
        written = [place for link in master.connections if link.target == number for place in link.target_places]
        held = np.delete(np.arange(len(instance.inputs.values), dtype=np.intp), written)
        return InstanceC(
            component=instance.component,
            do_step=ctypes.cast(instance.do_step, Pointer),
            begin=begin,
            count=len(instance.inputs.values) + len(instance.outputs.values),
            gets=ctypes.addressof(gets.array),
            sets=ctypes.addressof(sets.array),
            get_count=len(gets.array),
            set_count=len(sets.array),
            integers=ctypes.addressof(gets.integers),
            integers_begin=gets.end - gets.integer_count,
            integers_count=gets.integer_count,
            held=self._places(self._columns[begin + held]),
            held_count=len(held),
            every=every,
            step=every * self._step_ns / 1e9,
        )

    def _link(self, link: Connection, number: int) -> Any:
        """Return the part of a connection that goes to one transfer of the target."""
        ours = np.isin(link.target_places, self._fmus[link.target].sets[number].places)
        source, target = self._begins[2 * link.source + 1], self._begins[2 * link.target]
        return LinkC(
            ctypes.addressof(self._instances) + link.target * ctypes.sizeof(InstanceC),
            ctypes.addressof(self._transfers[2 * link.target].array) + number * ctypes.sizeof(TransferC),
            self._places(self._columns[source + link.source_places[ours]]),
            self._places(self._columns[target + link.target_places[ours]]),
            int(ours.sum()),
        )

    def _places(self, places: Indices) -> int:
        kept = np.ascontiguousarray(places, dtype=np.int64)
        self._kept.append(kept)
        return int(kept.ctypes.data)


class _Transfers:
    """The transfers of one direction of an instance; real ones first, the integers of all others in one array."""

    def __init__(self, group: list[Transfer], begin: int) -> None:
        self.integer_count = sum(item.count for item in group if not _is_real(item))
        self.integers = (ctypes.c_int32 * max(self.integer_count, 1))()
        self.array = (TransferC * len(group))()
        self.end = begin
        """Place in a row behind the last value."""
        at = ctypes.addressof(self.integers)
        for number, item in enumerate(group):
            buffer = None if _is_real(item) else at
            at += 0 if _is_real(item) else 4 * item.count
            references = ctypes.addressof(item.references)
            function = ctypes.cast(item.function, Pointer)
            self.array[number] = TransferC(function, references, buffer, self.end, item.count)
            self.end += item.count


def _is_real(item: Transfer) -> bool:
    return bool(item.view.dtype == np.float64)


def _order(transfers: list[Transfer]) -> Indices:
    """Return the places of all values of ``transfers`` in the ports."""
    return np.concatenate([np.empty(0, dtype=np.intp), *(item.places for item in transfers)])
