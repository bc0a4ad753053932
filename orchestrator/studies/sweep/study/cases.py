"""A design from complete scenarios, one for each run: what differs becomes columns, what does not is shared."""

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from modelkit.variables import variables
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.sweep.fields import SCENARIO_FIELDS, TRUE_FIELDS, TRUE_OWNERS, Field, find_field
from orchestrator.studies.sweep.study.design import Design

OWN = {"name", "title", "description", "source", "extends", "car", "file", "overrides", "slot_layout"}
"""Keys of a scenario in which runs may differ without any effect."""


class LabelledScenario(NamedTuple):
    """One run."""

    labels: Mapping[str, str | float]
    """What it is called in tables: by the same keys in all runs of a study."""
    scenario: Scenario


def design_of(cases: Iterable[LabelledScenario]) -> tuple[Scenario, Design]:
    """Return what all runs share, and a design with a column for each number in which they differ.

    Raises ``ValueError`` if they differ in anything else.
    """
    labels, scenarios = zip(*cases, strict=True)
    shared = scenarios[0]
    fixed = _common_values(shared)
    for scenario in scenarios:
        unlike = [key for key, value in _common_values(scenario).items() if value != fixed[key]]
        if unlike:
            raise ValueError(f"the scenarios of a study may differ in numbers only, not in {', '.join(unlike)}")
    columns = {key: np.array(values, dtype=float) for key, values in _numbers(scenarios).items()}
    columns = {key: values for key, values in columns.items() if (values != values[0]).any()}
    fields = [find_field(key, shared) for key in columns]
    values = np.column_stack([*columns.values()]) if columns else np.empty((len(scenarios), 0))
    seeds = np.array([scenario.seed for scenario in scenarios])
    words = {key: np.array([item[key] for item in labels]) for key in labels[0]}
    without_origin = {"car": None, "extends": None, "slot_layout": None}
    return shared.model_copy(update=without_origin), Design(fields, values, seeds, words)


def with_samples(design: Design, samples: Mapping[Field, Array]) -> Design:
    """Return every run of ``design`` with every sample; samples change fastest."""
    count = len(next(iter(samples.values())))
    fields, times = [*design.fields, *samples], len(design.seeds)
    drawn = np.tile(np.column_stack([*samples.values()]), (times, 1))
    values = np.column_stack([np.repeat(design.values, count, axis=0), drawn])
    labels = {key: np.repeat(words, count) for key, words in design.labels.items()}
    return Design(fields, values, np.repeat(design.seeds, count), labels)


def _common_values(scenario: Scenario) -> dict[str, Any]:
    """Return what must be the same in all runs: of target and slot whether there is one."""
    numbers = {*MODELS, *(key.partition(".")[0] for key in (*SCENARIO_FIELDS, *TRUE_FIELDS))}
    there = {owner: getattr(scenario, owner) is not None for owner in TRUE_OWNERS}
    return {**scenario.model_dump(exclude=numbers | OWN), **there}


def _numbers(scenarios: Iterable[Scenario]) -> dict[str, list[float]]:
    """Return every number that may differ from run to run by its key; a parameter not given has its default."""
    items = list(scenarios)
    found: dict[str, list[float]] = {}
    for owner, model in items[0].models.items():
        given = [getattr(item, owner) for item in items]
        for variable in variables(model.params):
            values = [float(own.get(variable.name, variable.start)) for own in given]
            found[f"{owner}.{variable.name}"] = values
        found[f"decimation.{owner}"] = [float(item.decimation.get(owner, 1)) for item in items]
    for owner in TRUE_OWNERS:
        if getattr(items[0], owner) is not None:
            for name in type(getattr(items[0], owner)).model_fields:
                found[f"{owner}.{name}"] = [getattr(getattr(item, owner), name) for item in items]
    found["stop_time"] = [item.longest for item in items]
    found["step"] = [item.step for item in items]
    return found
