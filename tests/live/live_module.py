"""The module of the page without a page: opened, set up and run by wasmtime."""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
import wasmtime

from fmus.compiled_batch import FAULTS
from fmus.native.web import charts_of, web_module
from modelkit.model import Model
from modelkit.variables import flatten, variables, with_values
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.simulation.cosim.algorithm import last_exchange
from orchestrator.studies.sweep.disturbed import fault_receivers, numbers_for

STOP_TIME, STANDSTILL = 0.0, 1.0


@lru_cache
def places(models: tuple[tuple[str, Model], ...]) -> dict[str, tuple[int, int, int]]:
    """Return signal -> model, place, whether it is an input."""
    return {
        f"{owner}.{item.name}": (number, place, is_input)
        for number, (owner, model) in enumerate(models)
        for is_input, cls in ((1, model.inputs), (0, model.outputs))
        for place, item in enumerate(variables(cls))
    }


def names_of(scenario: Scenario) -> list[str]:
    return list(places(tuple(scenario.models.items())))


class LiveModule:
    """One instance of the module of some models."""

    def __init__(self, models: Mapping[str, Model]) -> None:
        path = web_module(models)
        engine = wasmtime.Engine()
        self.store = wasmtime.Store(engine)
        module = wasmtime.Module(engine, path.read_bytes())
        assert not module.imports
        self.exports: Any = wasmtime.Instance(self.store, module, []).exports(self.store)
        self.call("_initialize")

    def call(self, name: str, *values: Any) -> Any:
        return self.exports[name](self.store, *values)

    def put(self, numbers: Sequence[float]) -> int:
        """Return the address of a copy of ``numbers``."""
        address = self.call("live_numbers", len(numbers))
        self.exports["memory"].write(self.store, np.array(numbers, dtype=float).tobytes(), address)
        return int(address)

    def get(self, address: int, count: int) -> Any:
        raw = self.exports["memory"].read(self.store, address, address + 8 * count)
        return np.frombuffer(bytes(raw), dtype=float)

    def run(self, scenario: Scenario, names: Sequence[str]) -> tuple[float, Any]:
        """Return how a run ended, and a line for each exchange: time, then the signals ``names``."""
        last = last_exchange(scenario.step_ns, scenario.stop_ns)
        live = self.call("live_open", self.put(setup(scenario, names)))
        trace = self.call("live_numbers", (last + 1) * (1 + len(names)))
        params, times, faults = (self.put(made(scenario)) for made in (parameters, times_of, disturbed))
        lines = self.call("live_run", live, params, times, faults, trace, 1, last + 1)
        end = self.get(self.call("live_row", live), 2)[0]
        found = self.get(trace, lines * (1 + len(names))).reshape(lines, -1)
        for address in (trace, params, times, faults):
            self.call("live_free", address)
        self.call("live_close", live)
        return end, found

    def decisions(self, scenario: Scenario, names: Sequence[str]) -> tuple[Any, Any]:
        """Return a line for each exchange of a run: ``names``; and what each chart had decided on by then."""
        charts = len(charts_of(scenario.models.values()))
        live = self.call("live_open", self.put(setup(scenario, names)))
        seen = self.call("live_numbers", len(names))
        self.call("live_begin", live, *(self.put(made(scenario)) for made in (parameters, times_of, disturbed)))
        decided = self.call("live_decided", live)
        lines, found, over = [], [], False
        while not over:
            over = self.call("live_exchange", live, seen)
            lines.append(self.get(seen, len(names)))
            found.append(self.get(decided, 3 * charts).reshape(charts, 3))
            self.call("live_advance", live)
        self.call("live_close", live)
        return np.array(lines), np.array(found)


def setup(scenario: Scenario, names: Sequence[str]) -> list[float]:
    ending = scenario.stop_condition
    final = sum(1 << value for value in ending.final())
    known = places(tuple(scenario.models.items()))
    signals = [*known[ending.signal], *known["vehicle.speed"]]
    seen = [number for name in names for number in known[name]]
    inputs = [item.inputs for item in fault_receivers(scenario)]
    plans = [(FAULTS.index(kind), model, places) for kind, model, places in inputs]
    counts = [0, len(names), len(plans), sum(len(places) for _, _, places in plans)]
    faults = [number for kind, model, places in plans for number in (kind, model, len(places), *places)]
    return [final, ending.still, ending.standstill_ns, *signals, *counts, *seen, *faults]


def disturbed(scenario: Scenario) -> list[float]:
    return [float(number) for number in numbers_for(scenario, np.array([scenario.seed]))[0]]


def parameters(scenario: Scenario) -> list[float]:
    parts = [flatten(with_values(model.params, getattr(scenario, owner))) for owner, model in scenario.models.items()]
    return [float(value) for part in parts for value in part]


def times_of(scenario: Scenario) -> list[float]:
    return [scenario.step_ns, scenario.stop_ns, *(scenario.decimation.get(owner, 1) for owner in scenario.models)]
