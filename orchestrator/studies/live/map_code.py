"""The code that makes the runs of a page's map: program slices that work out what decides about runs, and no more."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from fmus.compiled_batch import RecordedSignal, in_smallest_forms, signals_to_read
from fmus.native.web import LazySlices, web_module
from fmus.study_slices import study_slices
from modelkit.variables import variables, with_values
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.studies.sweep.batch import signal_to_record, stop_condition_of
from orchestrator.studies.sweep.rows import measures_for


class MapCode(NamedTuple):
    """The module for the runs of one system, and what the page has to know of it."""

    module: Path
    system: int
    """The value of ``controller.system``."""
    last_is_smallest: list[str]
    """Signals whose last value is the smallest one of the run."""

    def data(self) -> dict[str, Any]:
        """Return all but the module."""
        return {"system": self.system, "lastIsSmallest": self.last_is_smallest}


def map_code(scenarios: Sequence[Scenario]) -> MapCode | None:
    """Return the code for all ``scenarios`` that have the system of the first one.

    None of a controller that has one system: its runs need nearly all of the models.
    """
    models, choices = scenarios[0].models, _choices(scenarios[0])
    if not choices:
        return None
    alike = [scenario for scenario in scenarios if _choices(scenario) == choices]
    kept = [signal_to_record(item) for scenario in alike for item in measures_for(scenario)]
    read = frozenset[str]().union(*(signals_to_read(stop_condition_of(scenario), ()) for scenario in alike))
    kept += [RecordedSignal("last", signal) for signal in sorted(read)]
    own, wanted = in_smallest_forms(models, None, list(dict.fromkeys(kept)))
    signals = signals_to_read(None, wanted)
    words = (*sorted(signals), *(f"{name} {sorted(values)}" for name, values in choices.items()))
    module = web_module(own, LazySlices(words, lambda: study_slices(own, signals, choices)))
    (system,) = (value for values in choices.values() for value in values)
    changed = {item.signal for item in kept if item.how == "smallest" and item not in wanted}
    return MapCode(module, system, sorted(changed))


def _choices(scenario: Scenario) -> dict[str, frozenset[int]]:
    """Return the system that a scenario chooses of each model that has several."""
    return {
        name: frozenset({int(item.start)})
        for name, model in scenario.models.items()
        for item in variables(model.params, with_values(model.params, getattr(scenario, name)))
        if model.systems is not None and item.name == model.systems.parameter
    }
