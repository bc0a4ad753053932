"""The conditions of a requirement: how a value stands against a limit, and which value of a run is the worst."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from orchestrator.evaluation.verdict.measures import How
from orchestrator.inputs.scenario.requirements import Condition
from orchestrator.simulation.cosim.fmu_instance import Array


class Rule(NamedTuple):
    """What one condition means."""

    sign: str
    """Before the limit, for people."""
    margin: Callable[[Array, float], Array]
    """Distance of each value to the limit, negative beyond it."""
    worst: How | None
    """The measure that decides over a whole run; None: every instant must be looked at."""
    is_upper: bool
    """The limit is one from above, so that value over limit says how much of it is used."""


CONDITIONS: dict[Condition, Rule] = {
    "max": Rule("\u2264", lambda values, limit: limit - values, "greatest", True),
    "min": Rule("\u2265", lambda values, limit: values - limit, "smallest", False),
    "max_abs": Rule("\u00b1", lambda values, limit: limit - np.abs(values), "largest", True),
    "equals": Rule("=", lambda values, limit: 0.0 - np.abs(values - limit), None, False),
}


def share(condition: Condition, values: Array, limit: float) -> Array:
    """Return |value| over limit where the limit is one from above, else 0; NaN counts as infinitely much."""
    if not CONDITIONS[condition].is_upper or not limit > 0.0:
        return np.zeros(len(values))
    return np.nan_to_num(np.abs(values) / limit, nan=np.inf)
