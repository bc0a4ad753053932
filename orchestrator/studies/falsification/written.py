"""The space of a study that is written in a file: its keys are the factors, its spreads their ranges."""

from collections.abc import Mapping

import numpy as np

from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.sweep.fields import Field
from orchestrator.studies.sweep.study.space import Factor, Seeds, Space
from orchestrator.studies.sweep.study.study import Study


def space_of(study: Study) -> Space:
    """Return the study's own space, or that of its columns: from the least to the greatest value of each.

    A column of few different values is a choice among them. Columns of the same values are one factor. Raises
    ``BadInput`` if nothing varies.
    """
    if study.space is not None:
        return study.space
    names: dict[bytes, str] = {}
    factors: dict[str, Factor] = {}
    follows = []
    for field, column in zip(study.design.fields, study.design.values.T, strict=True):
        name = names.setdefault(column.tobytes(), field.key)
        follows.append(name)
        if name == field.key and len(np.unique(column)) > 1:
            factors[name] = _factor(field, column, study.scenario)
    if not factors:
        raise BadInput("the study varies nothing", key="runs")
    values = {name: np.unique(_column(study, name)) for name, factor in factors.items() if factor.choices}

    def place(named: Mapping[str, Array], seeds: Seeds) -> Array:
        given = {
            name: values[name][item.astype(int)] if name in values else _whole(study, name, item)
            for name, item in named.items()
        }
        same = [np.full(len(seeds), _column(study, name)[0]) for name in follows]
        return np.column_stack([given.get(name, one) for name, one in zip(follows, same, strict=True)])

    return Space([*factors.values()], place)


MAX_LISTED_VALUES = 12
"""Different values."""


def _factor(field: Field, column: Array, scenario: Scenario) -> Factor:
    signal, values = field.variable.signal, np.unique(column)
    nominal = _nominal(field, scenario)
    if len(values) <= MAX_LISTED_VALUES or field.variable.kind is bool:
        place = int(np.argmin(np.abs(values - nominal)))
        words = tuple(f"{v:g}" if signal.states is None else signal.states(int(v)).name.lower() for v in values)
        return Factor(field.key, signal.unit, 0, place, len(values) - 1, signal.text, words)
    low, high = float(values[0]), float(values[-1])
    return Factor(field.key, signal.unit, low, min(max(nominal, low), high), high, signal.text)


def _nominal(field: Field, scenario: Scenario) -> float:
    """Return the value that the scenario has itself."""
    if field.owner in ("vehicle", "controller"):
        return float(getattr(scenario, field.owner).get(field.name, field.variable.start))
    if field.owner in ("target", "slot"):
        return float(getattr(getattr(scenario, field.owner), field.name))
    if field.owner == "faults":
        value = getattr(scenario.faults[field.place], field.name)
        return float(value) if isinstance(value, (int, float)) else 0.0
    if field.name.startswith("decimation."):
        return float(scenario.decimation.get(field.name.removeprefix("decimation."), 1))
    return float(getattr(scenario, field.name))


def _column(study: Study, key: str) -> Array:
    keys = [field.key for field in study.design.fields]
    column: Array = study.design.values[:, keys.index(key)]
    return column


def _whole(study: Study, key: str, values: Array) -> Array:
    field = next(field for field in study.design.fields if field.key == key)
    return np.round(values) if field.variable.kind is int else values
