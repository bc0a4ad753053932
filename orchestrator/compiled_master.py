"""The Python master's exchange as compiled calls: FMUs driven through their C functions, without the GIL.

``fmus/native/master.c`` does a block of exchanges at a time and writes all signals of each into rows
allocated once. Afterwards the rows are laid into the slaves' arrays one by one, and the observers
and endings see them as if they had been there: log, recording and progress bar need to know nothing.
An ending in mid-block means that the FMUs have run on for the rest of it; nobody looks at that.

It covers FMUs of any kind. Faults change inputs between exchange and step, so a run with
manipulators, or with a model in process, takes the Python loop; so does one on a machine where
the compiled loop cannot be built.
"""

import ctypes
from collections.abc import Sequence
from typing import Any

import numpy as np

from orchestrator.fmu_slave import FmuSlave, Transfer
from orchestrator.master import End, Master
from orchestrator.slave import Indices, Slave

BLOCK = 100
"""Exchanges per compiled call."""
FETCH, SEND, STEP = 1, 2, 3
Pointer = ctypes.c_void_p
Long = ctypes.c_int64


def _structure(name: str, **fields: Any) -> Any:
    return type(name, (ctypes.Structure,), {"_fields_": list(fields.items())})


TransferC = _structure(
    "TransferC", call=Pointer, references=Pointer, buffer=Pointer, places=Pointer, count=Long, real=Long
)
SlaveC = _structure(
    "SlaveC",
    component=Pointer,
    do_step=Pointer,
    inputs=Pointer,
    outputs=Pointer,
    input_count=Long,
    output_count=Long,
    gets=Pointer,
    sets=Pointer,
    get_count=Long,
    set_count=Long,
    every=Long,
)
LinkC = _structure("LinkC", source=Long, target=Long, source_places=Pointer, target_places=Pointer, count=Long)
RunC = _structure(
    "RunC",
    slaves=Pointer,
    links=Pointer,
    slave_count=Long,
    link_count=Long,
    step_ns=Long,
    last=Long,
    failed=Long,
    failure=Long,
)


class CompiledMaster(Master):
    """A master whose loop is compiled wherever it can be."""

    def run(self) -> End:
        """Exchange and step until an ending, the stop time or an interrupt. Raises ``RunError``."""
        fmus = [slave for slave in self.slaves if isinstance(slave, FmuSlave)]
        if self.manipulators or len(fmus) < len(self.slaves):
            return super().run()
        try:
            plan = _Plan(self, fmus)
        except RuntimeError:
            return super().run()
        return self._run_blocks(fmus, plan)

    def _run_blocks(self, fmus: list[FmuSlave], plan: "_Plan") -> End:
        views = plan.views(fmus)
        first = 0
        while True:
            count = plan.advance(first)
            unseen = 0 if self.observers or self.endings else max(count - 1, 0)
            for row in range(unseen, count):
                for values, place in views:
                    values[:] = plan.rows[row, place]
                t_ns = (first + row) * self.step_ns
                for observer in self.observers:
                    observer.exchanged(t_ns)
                reason = self._over(t_ns, first + row == plan.last)
                if reason:
                    return End(reason, t_ns)
            first += count
            plan.check(fmus, first)


class _Plan:
    """The C structures of one run, and all memory they point to."""

    def __init__(self, master: Master, fmus: list[FmuSlave]) -> None:
        from fmus.master_library import master_library

        self._call = ctypes.CDLL(str(master_library())).master_run
        self._call.restype = ctypes.c_int64
        self._call.argtypes = [Pointer, Long, Long, Pointer]
        self._kept: list[Any] = []
        self._step_ns = master.step_ns
        self.last = master.stop_ns // master.step_ns
        slaves = [self._slave(slave, every) for slave, every in zip(fmus, master.every, strict=True)]
        links = [
            LinkC(
                link.source,
                link.target,
                self._places(link.source_places),
                self._places(link.target_places),
                len(link.source_places),
            )
            for link in master.connections
        ]
        self._run = RunC(
            self._array(SlaveC, slaves),
            self._array(LinkC, links),
            len(slaves),
            len(links),
            master.step_ns,
            self.last,
            0,
            0,
        )
        self.rows = np.empty((BLOCK, sum(len(part.values) for slave in fmus for part in (slave.inputs, slave.outputs))))

    def views(self, fmus: Sequence[Slave]) -> list[tuple[Any, slice]]:
        """Return (slave's array, its place in a row) in the order of the rows."""
        found, at = [], 0
        for slave in fmus:
            for ports in (slave.inputs, slave.outputs):
                found.append((ports.values, slice(at, at + len(ports.values))))
                at += len(ports.values)
        return found

    def advance(self, first: int) -> int:
        """Do a block of exchanges; return how many are in ``rows``."""
        return int(self._call(ctypes.addressof(self._run), first, BLOCK, self.rows.ctypes.data))

    def check(self, fmus: list[FmuSlave], number: int) -> None:
        """Raise the ``RunError`` of the slave that refused in the block just done; ``number`` rows are complete."""
        slave = fmus[self._run.failed]
        if self._run.failure == FETCH:
            raise slave.no_outputs()
        if self._run.failure == SEND:
            raise slave.no_inputs()
        if self._run.failure == STEP:
            raise slave.no_step((number - 1) * self._step_ns)

    def _slave(self, slave: FmuSlave, every: int) -> Any:
        gets, sets = ([self._transfer(item) for item in group] for group in (slave.gets, slave.sets))
        return SlaveC(
            slave.component,
            ctypes.cast(slave.do_step, Pointer),
            slave.inputs.values.ctypes.data,
            slave.outputs.values.ctypes.data,
            len(slave.inputs.values),
            len(slave.outputs.values),
            self._array(TransferC, gets),
            self._array(TransferC, sets),
            len(gets),
            len(sets),
            every,
        )

    def _transfer(self, item: Transfer) -> Any:
        return TransferC(
            ctypes.cast(item.function, Pointer),
            ctypes.addressof(item.references),
            ctypes.addressof(item.array),
            self._places(item.places),
            item.count,
            item.view.dtype == np.float64,
        )

    def _places(self, places: Indices) -> int:
        kept = np.ascontiguousarray(places, dtype=np.int64)
        self._kept.append(kept)
        return int(kept.ctypes.data)

    def _array(self, kind: Any, items: list[Any]) -> int:
        kept = (kind * max(len(items), 1))(*items)
        self._kept.append((kept, items))
        return ctypes.addressof(kept)
