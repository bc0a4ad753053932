"""Code made for one study: slices of the models, compiled for this machine, held against the complete models."""

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
CHECKED_RUNS = 4
"""Runs of a study that are made by the complete models, too."""

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
    """The compiled runs of a study's own code; those of the complete models if the first runs differ in any bit."""

    def __init__(self, complete: Rows, own: Rows) -> None:
        self._complete, self._own = complete, own
        self._lock = threading.Lock()
        self.is_equal: bool | None = None
        """Whether the first runs had the same bits; None before any run."""

    def __call__(self, parameters: Array, times: Times, faults: Array, out: Array) -> None:
        """Make runs: see ``fmus.compiled_batch.Rows``."""
        with self._lock:
            if self.is_equal is None:
                few = slice(CHECKED_RUNS)
                self.is_equal = self._compare(parameters[few], times[few], faults[few], out[few])
        (self._own if self.is_equal else self._complete)(parameters, times, faults, out)

    def _compare(self, parameters: Array, times: Times, faults: Array, out: Array) -> bool:
        rows = [np.empty_like(out), np.empty_like(out)]
        for made, found in zip((self._complete, self._own), rows, strict=True):
            made(parameters, times, faults, found)
        return rows[0].tobytes() == rows[1].tobytes()


def explanation(models: Mapping[str, Model], slices: "Mapping[str, Slice]") -> str:
    """Return what the code of a study omits, a line for each model."""
    lines = []
    for name, omitted in outputs_left_out(models, slices).items():
        count = len(variables(models[name].outputs))
        groups = dict.fromkeys(item.partition("[")[0] for item in omitted)
        lines.append(f"{name}: {len(omitted)} of {count} outputs are not computed: {', '.join(groups) or '-'}")
        choices = slices[name].choices
        systems = models[name].systems
        if choices is not None and systems is not None:
            kept = [item.field for item in systems.systems if choices & set(item.values)]
            lines.append(f"{name}: {len(kept)} of {len(systems.systems)} systems: {', '.join(kept)}")
    return "\n".join(lines)
