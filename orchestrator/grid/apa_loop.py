"""Vehicle and controller in this process, compiled where it can be: fast enough for a study, every signal at hand.

Compiled, the models are the libraries of :mod:`fmus.native.libraries`, called at the addresses of arrays made once a
run; else they are plain Python. Both give the same bits.
"""

from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from modelkit.model import Model
from modelkit.variables import constructor, flatten, variables, with_values
from orchestrator.cosim.slave import Array
from orchestrator.scenario.end_condition import EndCondition
from orchestrator.scenario.models import MODELS

STEP_NS = 10_000_000
FINAL = EndCondition().final()
"""Phases in which a manoeuvre is over."""
AFTER = 60
"""Steps that are still taken then: the car comes to rest."""


class Part(NamedTuple):
    """One model of a run: what it hears, what it says, and its next step."""

    inputs: Array
    outputs: Array
    step: Callable[[], object]


Start = Callable[[dict[str, Any]], Part]


class Loop:
    """A Jacobi loop of both models with a step of 10 ms: the master's exchange, for two models in process."""

    def __init__(self, kept: tuple[str, ...], *, compiled: bool) -> None:
        start = _compiled if compiled else _plain
        self._starts = {name: start(model) for name, model in MODELS.items()}
        self._names = {
            name: ([v.name for v in variables(model.inputs)], [v.name for v in variables(model.outputs)])
            for name, model in MODELS.items()
        }
        self._links = [(a, b, *self._places(a, b)) for a, b in (("vehicle", "controller"), ("controller", "vehicle"))]
        self._kept = [(name, *self._place(name)) for name in kept]

    def run(self, vehicle: dict[str, Any], controller: dict[str, Any], stop: float) -> Iterator[Mapping[str, float]]:
        """Yield the kept signals at every exchange until the end."""
        params = {"vehicle": vehicle, "controller": controller}
        parts = {name: start(params[name]) for name, start in self._starts.items()}
        links = [(parts[a].outputs, parts[b].inputs, outputs, inputs) for a, b, outputs, inputs in self._links]
        kept = [(name, parts[owner].outputs, place) for name, owner, place in self._kept]
        left = AFTER
        for _ in range(int(stop * 1e9) // STEP_NS):
            row = {name: float(outputs[place]) for name, outputs, place in kept}
            yield row
            left = left - 1 if row["controller.phase"] in FINAL else AFTER
            if left == 0:
                return
            for source, target, outputs, inputs in links:
                target[inputs] = source[outputs]
            for part in parts.values():
                part.step()

    def _places(self, source: str, target: str) -> tuple[Any, Any]:
        outputs, inputs = self._names[source][1], self._names[target][0]
        shared = [name for name in inputs if name in outputs]
        return (
            np.array([outputs.index(name) for name in shared]),
            np.array([inputs.index(name) for name in shared]),
        )

    def _place(self, signal: str) -> tuple[str, int]:
        owner, name = signal.split(".", 1)
        return owner, self._names[owner][1].index(name)


def _compiled(model: Model) -> Start:
    from fmus.native.libraries import load_model, memory_size

    library = load_model(model)
    size = memory_size(library)

    def start(changes: dict[str, Any]) -> Part:
        params = np.array(flatten(with_values(model.params, changes)), dtype=float)
        memory, u, y = np.zeros(size, dtype=np.uint8), *_ports(model)
        instance, inputs, outputs = (array.ctypes.data for array in (memory, u, y))
        library.model_start(instance, params.ctypes.data, outputs)

        def on(_held: object = memory) -> None:
            library.model_step(instance, inputs, outputs, STEP_NS)

        return Part(u, y, on)

    return start


def _plain(model: Model) -> Start:
    inputs_of = constructor(model.inputs)

    def start(changes: dict[str, Any]) -> Part:
        params = with_values(model.params, changes)
        u, y = _ports(model)
        state, first = model.initialize(params)
        y[:] = flatten(first)

        def on() -> None:
            nonlocal state
            state, told = model.step(state, inputs_of(u.tolist()), params, STEP_NS)
            y[:] = flatten(told)

        return Part(u, y, on)

    return start


def _ports(model: Model) -> tuple[Array, Array]:
    """Return inputs and outputs at the start."""
    return np.array(flatten(model.inputs()), dtype=float), np.array(flatten(model.outputs()), dtype=float)
