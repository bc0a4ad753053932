"""Code made for one study: slices of the models, compiled for this machine, held against the complete models.

Where the processor has vectors, several runs advance at once, each in one lane of them.
"""

import threading
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from fmus.compiled_batch import Rows
from fmus.study_slices import outputs_left_out
from modelkit.model import Model
from modelkit.variables import variables
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.sweep.job import Times

if TYPE_CHECKING:
    from fmus.compiler.slicing import Slice

STUDY_CODE_FROM = 5_000
"""Runs from which a study gets code of its own: it takes 4 s of processor time and saves 0.5 ms a run of case 4."""
CHECKED_RUNS = 8
"""Runs of a study that are made by the complete models, too: one in each lane."""

Choices = tuple[tuple[str, frozenset[int]], ...]
"""Model -> values that its parameter which chooses a system takes in a study."""


def choices_of(scenario: Scenario, parameters: Array) -> Choices:
    """Return the systems that the runs of ``parameters`` choose, of the models that have several."""
    found, first = [], 0
    for name, model in scenario.models.items():
        known = [item.name for item in variables(model.params)]
        if model.systems is not None:
            values = parameters[:, first + known.index(model.systems.parameter)]
            found.append((name, frozenset(int(value) for value in np.unique(values))))
        first += len(known)
    return tuple(found)


class StudyRows:
    """The compiled runs of the first of a study's ``own`` codes whose first runs have the bits of the complete models;
    those of the complete models if none has."""

    def __init__(self, complete: Rows, *own: Rows) -> None:
        self.complete, self.own = complete, own
        self._lock = threading.Lock()
        self.chosen: Rows | None = None
        """What makes the runs; None before any run."""

    def __call__(self, parameters: Array, times: Times, faults: Array, out: Array) -> None:
        """Make runs: see ``fmus.compiled_batch.Rows``."""
        with self._lock:
            if self.chosen is None:
                few = slice(CHECKED_RUNS)
                self.chosen = self._choose(parameters[few], times[few], faults[few], out[few])
        self.chosen(parameters, times, faults, out)

    def _choose(self, parameters: Array, times: Times, faults: Array, out: Array) -> Rows:
        expected, found = np.empty_like(out), np.empty_like(out)
        self.complete(parameters, times, faults, expected)
        for own in self.own:
            own(parameters, times, faults, found)
            if found.tobytes() == expected.tobytes():
                return own
        return self.complete


def explanation(models: Mapping[str, Model], own: Mapping[str, Model], slices: "Mapping[str, Slice]") -> str:
    """Return what the code of a study omits, lines for each of the ``models``; ``own``: those that it is made of."""
    lines = []
    for name, omitted in outputs_left_out(models, slices).items():
        count = len(variables(models[name].outputs))
        groups = dict.fromkeys(item.partition("[")[0] for item in omitted)
        lines.append(f"{name}: {len(omitted)} of {count} outputs are not computed: {', '.join(groups) or '-'}")
        form = models[name].smallest
        if form is not None and own[name] is not models[name]:
            lines.append(f"{name}: {', '.join(sorted(form.outputs))} where it cannot be the smallest is not computed")
        choices = slices[name].choices
        systems = models[name].systems
        if choices is not None and systems is not None:
            kept = [item.field for item in systems.systems if choices & set(item.values)]
            lines.append(f"{name}: {len(kept)} of {len(systems.systems)} systems: {', '.join(kept)}")
    return "\n".join(lines)
