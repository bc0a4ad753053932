"""What is kept of every run of a study: how it ended, its measures, and values of limits that need the whole run.

The compiled batch gathers the measures while it runs; for any other engine they are read off the recording.
Both give the same bits.
"""

from collections.abc import Iterable, Mapping
from typing import get_args

import numpy as np

from orchestrator.evaluation.verdict.conditions import CONDITIONS
from orchestrator.evaluation.verdict.judge import CHART, judge
from orchestrator.evaluation.verdict.measures import Instants, Measure, measure_recording
from orchestrator.evaluation.verdict.numbers import MEASURES, NUMBERS, OF_WHOLE_RUNS, RunFacts, of_whole_run
from orchestrator.inputs.scenario.end_condition import state_word, states_of
from orchestrator.inputs.scenario.requirements import Requirement, Where, Window
from orchestrator.inputs.scenario.scenario import PENETRATION, Scenario
from orchestrator.inputs.text.errors import BadInput, suggestion
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.recording import Recording
from orchestrator.studies.sweep.study.imported_fmu import files_of, signals_of

STOP_TIME, STANDSTILL, ABORTED = 0.0, 1.0, 2.0
"""How a run ended: first number of its row; the second is when [ns]."""
FIRST_MEASURE = 2


def last_words(scenario: Scenario) -> tuple[Measure, Measure]:
    """Return the measures that tell how far the controller was at the end, and why it gave up."""
    return Measure("last", scenario.stop_condition.signal), Measure("last", scenario.stop_condition.reason)


def measures_for(
    scenario: Scenario, more: Iterable[Requirement] = (), further: Iterable[Measure] = ()
) -> list[Measure]:
    """Return the measures a verdict on ``scenario`` needs, and those of ``more`` limits, and ``further`` ones.

    Raises ``BadInput`` for a limit or measure of an unknown signal, or for one of ``more`` that takes the whole run.
    """
    known = signals_of(scenario)
    for item in last_words(scenario):
        if item.signal not in known:
            hint = suggestion(item.signal, known)
            raise BadInput(f"no signal of this name{hint}", file=scenario.file, key=f"stop_condition: {item.signal}")
    found = [measure for measure in (*MEASURES, *last_words(scenario)) if measure.signal in known]
    for limit in (*scenario.requirements, *more):
        if limit.signal in known:
            found += measures_of(limit)
        elif limit.signal not in NUMBERS:
            hint = suggestion(limit.signal, [*known, *NUMBERS])
            raise BadInput(f"no signal or number of this name{hint}", file=scenario.file, key=f"limits: {limit.id}")
    for limit in more:
        if limit.signal in OF_WHOLE_RUNS or (limit.signal in known and measure_of(limit) is None):
            raise BadInput("takes the whole run; only a scenario's own limits may", key=f"within: {limit.id}")
    for measure in further:
        if measure.signal not in known:
            raise BadInput(
                f"no signal of this name{suggestion(measure.signal, known)}", key=f"measures: {measure.signal}"
            )
        found.append(measure)
    return list(dict.fromkeys(found))


def measure_of(limit: Requirement) -> Measure | None:
    """Return the measure that decides about a limit on a signal; None if that takes the whole run."""
    window, worst = limit.window, None if limit.ever else CONDITIONS[limit.condition].worst
    if window is not None and window == Window(at="end", if_never=window.if_never):
        return Measure("last", limit.signal)
    if worst is None:
        return None
    if window is None:
        return Measure(worst, limit.signal)
    during = _phases(window)
    return None if during is None else Measure(worst, limit.signal, during)


def _phases(window: Window) -> Instants | None:
    """Return the instants of a window that is made of phases alone; None for any other."""
    if window != Window(phase=window.phase, if_never=window.if_never):
        return None
    numbers = {name: number for number, name in states_of(CHART).items()}
    words = [state_word(phase) for phase in window.phase]
    return Instants(CHART, tuple(numbers[word] for word in words)) if set(words) <= numbers.keys() else None


def measures_of(limit: Requirement) -> list[Measure]:
    """Return all measures that a limit on a signal needs: of a window also the first of its instants."""
    found = measure_of(limit)
    if found is None:
        return []
    return [found] if found.when is None else [found, Measure("first", CHART, found.when)]


def values_of(limit: Requirement, found: Mapping[Measure, Array]) -> Array:
    """Return the worst values for a limit on a signal; the limit itself where a window never comes and that will do."""
    measure = measure_of(limit)
    assert measure is not None
    values = found[measure]
    if limit.window is None or limit.window.if_never == "fail" or measure.when is None:
        return values
    assert not isinstance(limit.limit, str)
    return np.where(np.isnan(found[Measure("first", CHART, measure.when)]), limit.limit, values)


def limits_of_whole_runs(scenario: Scenario) -> list[int]:
    """Return the places of the limits of ``scenario`` that take the whole run."""
    return [
        place
        for place, limit in enumerate(scenario.requirements)
        if (limit.signal not in NUMBERS and measure_of(limit) is None)
        or (limit.signal in OF_WHOLE_RUNS and (limit.where != "obstacles" or scenario.obstacles))
        or (limit.signal in (PENETRATION, CLEARANCE_NUMBER) and _needs_poses(scenario))
    ]


CLEARANCE_NUMBER = "min_clearance"


def _needs_poses(scenario: Scenario) -> bool:
    """Return whether contact is derived from poses alone: with polygons, or a third-party vehicle."""
    return bool(scenario.obstacles) or "vehicle" in files_of(scenario)


def why_not_compiled(scenario: Scenario) -> str:
    """Return why runs of ``scenario`` need a full recording each, an empty string if they do not."""
    if scenario.system is not None:
        return "the scenario has a system of its own"
    places = limits_of_whole_runs(scenario)
    return f"the limit {scenario.requirements[places[0]].id!r} needs the whole run" if places else ""


def row_of(recording: Recording, scenario: Scenario, measures: list[Measure]) -> Array:
    """Return the row that the compiled batch would have made of this run, then the values of recorded limits."""
    end = str(recording.info["end"]["reason"])
    code = {"stop_time": STOP_TIME, "standstill": STANDSTILL}.get(end, ABORTED)
    found = [measure_recording(item, recording) for item in measures]
    worst = [_worst(scenario.requirements[place], recording, scenario) for place in limits_of_whole_runs(scenario)]
    return np.array([code, float(recording.t_ns[-1]) if len(recording.t_ns) else 0.0, *found, *worst])


def _worst(limit: Requirement, recording: Recording, scenario: Scenario) -> float:
    facts = RunFacts(of_whole_run(recording, scenario), frozenset(get_args(Where)))
    (check,) = judge([limit], recording, facts, scenario.file)
    return check.limit if check.passed and check.value != check.value else check.value
