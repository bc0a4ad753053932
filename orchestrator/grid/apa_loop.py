"""Vehicle and controller in this process, compiled where it can be: fast enough for a study, every signal at hand.

Compiled, the models are the libraries that :func:`fmus.compiled_batch.model_library` makes and keeps,
called at the addresses of arrays made once a run; else they are plain Python. Both give the same bits.
"""

import ctypes
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from fmus.flat_entry import entries
from modelkit.model import Model
from modelkit.variables import flatten, variables, with_values
from orchestrator.cosim.slave import Array
from orchestrator.scenario.models import MODELS

STEP_NS = 10_000_000
FINAL = (9.0, 10.0, 11.0)
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
    from fmus.compiled_batch import model_library

    library = ctypes.CDLL(str(model_library(model)))
    initialize, step = library.batch_initialize, library.batch_step
    initialize.argtypes = [ctypes.c_void_p] * 3
    step.argtypes = [*[ctypes.c_void_p] * 4, ctypes.c_int64]

    def start(changes: dict[str, Any]) -> Part:
        s, u, p, y = (np.array(values, dtype=float) for values in _values(model, changes))
        state, inputs, params, outputs = (array.ctypes.data for array in (s, u, p, y))
        initialize(state, params, outputs)

        def on(_held: tuple[Array, Array] = (s, p)) -> None:
            step(state, inputs, params, outputs, STEP_NS)

        return Part(u, y, on)

    return start


def _plain(model: Model) -> Start:
    entry = entries(model)

    def start(changes: dict[str, Any]) -> Part:
        s, u, p, y = _values(model, changes)
        inputs, outputs = np.array(u, dtype=float), np.array(y, dtype=float)
        entry.initialize(s, p, outputs)
        return Part(inputs, outputs, partial(entry.step, s, inputs, p, outputs, STEP_NS))

    return start


def _values(model: Model, changes: dict[str, Any]) -> tuple[list[Any], list[Any], list[Any], list[Any]]:
    """Return state, inputs, parameters and outputs at the start."""
    params = flatten(with_values(model.params, changes))
    return flatten(model.state()), flatten(model.inputs()), params, flatten(model.outputs())
