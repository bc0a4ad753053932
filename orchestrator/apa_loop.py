"""Vehicle and controller in this process, compiled if numba is there: fast enough for a study, every signal at hand."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from modelkit.variables import flatten, variables, with_values
from orchestrator.models import MODELS
from orchestrator.slave import Array

STEP_NS = 10_000_000
FINAL = (9.0, 10.0, 11.0)
"""Phases in which a manoeuvre is over."""
AFTER = 60
"""Steps that are still taken then: the car comes to rest."""


class Loop:
    """A Jacobi loop of both models with a step of 10 ms: the master's exchange, for two models in process."""

    def __init__(self, kept: tuple[str, ...], *, compiled: bool) -> None:
        self.compiled = compiled
        self._entries = {name: _entries(name, compiled) for name in MODELS}
        self._names = {
            name: ([v.name for v in variables(model.inputs)], [v.name for v in variables(model.outputs)])
            for name, model in MODELS.items()
        }
        self._links = [(a, b, *self._places(a, b)) for a, b in (("vehicle", "controller"), ("controller", "vehicle"))]
        self._kept = [(name, *self._place(name)) for name in kept]

    def run(self, vehicle: dict[str, Any], controller: dict[str, Any], stop: float) -> Iterator[Mapping[str, float]]:
        """Yield the kept signals at every exchange until the end."""
        params = {"vehicle": vehicle, "controller": controller}
        data = {name: self._start(name, params[name]) for name in MODELS}
        left = AFTER
        for _ in range(int(stop * 1e9) // STEP_NS):
            row = {name: float(data[owner][3][place]) for name, owner, place in self._kept}
            yield row
            left = left - 1 if row["controller.phase"] in FINAL else AFTER
            if left == 0:
                return
            for source, target, outputs, inputs in self._links:
                data[target][1][inputs] = data[source][3][outputs]
            for name, (s, u, p, y) in data.items():
                self._entries[name].step(s, u, p, y, STEP_NS)

    def _start(self, name: str, changes: dict[str, Any]) -> tuple[Any, Any, Any, Any]:
        model = MODELS[name]
        p = _array(flatten(with_values(model.params, changes)), self.compiled)
        s = _array(flatten(model.state()), self.compiled)
        u = np.array(flatten(model.inputs()), dtype=float)
        y = np.array(flatten(model.outputs()), dtype=float)
        self._entries[name].initialize(s, p, y)
        return s, u, p, y

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


def _entries(name: str, compiled: bool) -> Any:
    if compiled:
        from fmus.compiled import compiled_entries

        return compiled_entries(MODELS[name])
    from fmus.flat_entry import entries

    return entries(MODELS[name])


def _array(values: list[Any], compiled: bool) -> Array | list[Any]:
    return np.array(values, dtype=float) if compiled else list(values)
