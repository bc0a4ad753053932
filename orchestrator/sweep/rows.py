"""What is kept of every run of a study: how it ended, its measures, and values of limits that need the whole run.

The compiled batch gathers the measures while it runs; for any other engine they are read off the recording.
Both give the same bits.
"""

from typing import get_args

import numpy as np

from modelkit.variables import variables
from orchestrator.cosim.recording import Recording
from orchestrator.cosim.slave import Array
from orchestrator.scenario.models import MODELS
from orchestrator.scenario.requirements import Requirement, Where, Window
from orchestrator.scenario.scenario import Scenario
from orchestrator.text.errors import BadInput, suggestion
from orchestrator.verdict.conditions import CONDITIONS
from orchestrator.verdict.judge import judge
from orchestrator.verdict.measures import Measure, measured
from orchestrator.verdict.numbers import MEASURES, NUMBERS, Facts

STOP_TIME, STANDSTILL, ABORTED = 0.0, 1.0, 2.0
"""How a run ended: first number of its row; the second is when [ns]."""
FIRST_MEASURE = 2


def signals() -> set[str]:
    """Return the names of all inputs and outputs of the models."""
    return {
        f"{owner}.{item.name}"
        for owner, model in MODELS.items()
        for cls in (model.inputs, model.outputs)
        for item in variables(cls)
    }


def last_words(scenario: Scenario) -> tuple[Measure, Measure]:
    """Return the measures that tell how far the controller was at the end, and why it gave up."""
    return Measure("last", scenario.ending.signal), Measure("last", scenario.ending.reason)


def measures_for(scenario: Scenario) -> list[Measure]:
    """Return the measures a verdict on ``scenario`` needs. Raises ``BadInput`` for a limit on an unknown signal."""
    known = signals()
    for item in last_words(scenario):
        if item.signal not in known:
            hint = suggestion(item.signal, known)
            raise BadInput(f"no signal of this name{hint}", file=scenario.file, key=f"ending: {item.signal}")
    found = [measure for measure in (*MEASURES, *last_words(scenario)) if measure.signal in known]
    for limit in scenario.limits:
        if limit.signal in known:
            found += [item for item in (measure_of(limit),) if item is not None]
        elif limit.signal not in NUMBERS:
            hint = suggestion(limit.signal, [*known, *NUMBERS])
            raise BadInput(f"no signal or number of this name{hint}", file=scenario.file, key=f"limits: {limit.id}")
    return list(dict.fromkeys(found))


def measure_of(limit: Requirement) -> Measure | None:
    """Return the measure that decides about a limit on a signal; None if that takes the whole run."""
    window, worst = limit.window, CONDITIONS[limit.condition].worst
    if window is not None and window == Window(at="end", if_never=window.if_never):
        return Measure("last", limit.signal)
    return Measure(worst, limit.signal) if window is None and worst is not None else None


def recorded_limits(scenario: Scenario) -> list[int]:
    """Return the places of the limits of ``scenario`` that take the whole run."""
    return [
        place
        for place, limit in enumerate(scenario.limits)
        if limit.signal not in NUMBERS and measure_of(limit) is None
    ]


def why_not_compiled(scenario: Scenario) -> str:
    """Return why runs of ``scenario`` need a full recording each, an empty string if they do not."""
    if scenario.faults:
        return "the scenario has faults"
    places = recorded_limits(scenario)
    return f"the limit {scenario.limits[places[0]].id!r} needs the whole run" if places else ""


def row_of(recording: Recording, scenario: Scenario, measures: list[Measure]) -> Array:
    """Return the row that the compiled batch would have made of this run, then the values of recorded limits."""
    end = str(recording.info["end"]["reason"])
    code = {"stop_time": STOP_TIME, "standstill": STANDSTILL}.get(end, ABORTED)
    found = [measured(item, recording) for item in measures]
    worst = [_worst(scenario.limits[place], recording, scenario) for place in recorded_limits(scenario)]
    return np.array([code, float(recording.t_ns[-1]) if len(recording.t_ns) else 0.0, *found, *worst])


def _worst(limit: Requirement, recording: Recording, scenario: Scenario) -> float:
    (check,) = judge([limit], recording, Facts({}, frozenset(get_args(Where))), scenario.file)
    return check.limit if check.passed and check.value != check.value else check.value
