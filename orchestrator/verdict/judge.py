"""From requirements and a recording to verdicts: the only place where a limit meets a value."""

import math
from functools import cache
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict

from modelkit.variables import variables
from orchestrator.cosim.recording import Recording
from orchestrator.cosim.slave import Array
from orchestrator.scenario.end_condition import state_word, states_of
from orchestrator.scenario.models import MODELS
from orchestrator.scenario.requirements import Condition, Occasion, Requirement, Window
from orchestrator.text.errors import BadInput, suggestion, suggestion_or_choices
from orchestrator.verdict.conditions import CONDITIONS
from orchestrator.verdict.numbers import NUMBERS, Facts, signals_of
from orchestrator.verdict.truth import Bools

CHART = "controller.phase"
NEVER = "the window never comes"
CLOSE = 1e-9
"""Instants are the same within this [s]."""


class Check(BaseModel):
    """One requirement and how the run stands against it."""

    model_config = ConfigDict(extra="forbid")

    id: str
    """Name of the requirement."""
    limit: float
    """What is asked for [unit]."""
    value: float
    """The worst value, NaN if there is none."""
    passed: bool
    """Whether the limit is kept."""
    source: str
    """Who asks for it."""
    unit: str
    """SI unit of value, limit and margin."""
    margin: float
    """Distance to the limit, negative beyond it."""
    required: bool
    """A run counts as parked only if every required one is met."""
    t: float
    """When the value occurred [s]."""
    signal: str
    """Signal or number of the summary."""
    condition: Condition
    """max, min, max_abs or equals."""
    note: str = ""
    """Name of the state, or why there is no value."""
    limit_name: str = ""
    """Name of the state asked for."""
    judged: bool = True
    """False: the run has nothing to judge by, as an FMU does not put it out; such a check is never passed."""


def judge(requirements: list[Requirement], recording: Recording, facts: Facts, file: str) -> list[Check]:
    """Return one check for each requirement that is asked of a run with these facts.

    Raises ``BadInput`` for a name that neither the run nor the summary has, or a limit in another unit.
    """
    asked = [item for item in requirements if item.where is None or item.where in facts.has]
    return [_check(item, recording, facts.numbers, file) for item in asked]


def _check(item: Requirement, recording: Recording, numbers: dict[str, float], file: str) -> Check:
    where = f"{item.id}: {item.signal}"
    if _unmeasured(item, recording, numbers):
        return _not_judged(item)
    if item.signal in recording.signals:
        unit = recording.variables[item.signal].signal.unit
        states = recording.states(item.signal)
        rows = _rows(item.window, recording, file, where)
        values, times = recording.signals[item.signal][rows], recording.t[rows]
    elif item.signal in numbers:
        unit, states = NUMBERS[item.signal].unit, {}
        if item.window is not None:
            raise BadInput("a number of the summary has no window", file=file, key=where)
        values, times = np.array([numbers[item.signal]]), np.array([numbers["duration"]])
    else:
        known = [*recording.signals, *numbers]
        raise BadInput(f"no signal or number of this name{suggestion(item.signal, known)}", file=file, key=where)
    if item.unit is not None and item.unit != unit:
        raise BadInput(f"the limit is in {item.unit}, the signal in {unit}", file=file, key=where)
    limit = _number(item.limit, states, file, where)
    return _worst(item, values, times, limit, unit, states)


def _unmeasured(item: Requirement, recording: Recording, numbers: dict[str, float]) -> bool:
    """Return whether a requirement needs what our models put out, but the FMUs of this run do not."""
    named = [item.signal, *([item.window.after.signal] if item.window is not None and item.window.after else [])]
    missing = any(name not in recording.signals and name in _known_signals() for name in named)
    phase = item.window is not None and bool(item.window.phase) and not _has_phases(item.window.phase, recording)
    number = item.signal in numbers and not all(name in recording.signals for name in signals_of(item.signal))
    return missing or phase or number


def _has_phases(names: list[str], recording: Recording) -> bool:
    """Return whether the chart of a run has phases of these names, or should have: another's need not have ours."""
    if CHART not in recording.signals:
        return False
    there, ours = set(recording.states(CHART).values()), set(states_of(CHART).values())
    return all(word in there or word not in ours for word in map(state_word, names))


@cache
def _known_signals() -> frozenset[str]:
    return frozenset(f"{owner}.{item.name}" for owner, model in MODELS.items() for item in variables(model.outputs))


def _not_judged(item: Requirement) -> Check:
    known = NUMBERS[item.signal].unit if item.signal in NUMBERS else item.unit or "1"
    limit = item.limit if isinstance(item.limit, float) else math.nan
    return Check(
        id=item.id,
        limit=limit,
        value=math.nan,
        passed=False,
        source=item.source,
        unit=known,
        margin=math.nan,
        required=item.required,
        t=0.0,
        signal=item.signal,
        condition=item.condition,
        note="not measured",
        limit_name=item.limit if isinstance(item.limit, str) else "",
        judged=False,
    )


def _worst(item: Requirement, values: Array, times: Array, limit: float, unit: str, states: dict[int, str]) -> Check:
    """Return the check at the value that decides, the worst or the best; NaN is the worst there is, passes nothing."""
    value = margin = math.nan
    when, note, passed = 0.0, "", False
    if len(values):
        found = CONDITIONS[item.condition].margin(values, limit)
        row = int((np.argmax if item.ever else np.argmin)(np.where(np.isnan(found), -np.inf, found)))
        value, margin, when = float(values[row]), float(found[row]), float(times[row])
        passed = margin >= 0.0
        unknown = "not known" if item.signal in NUMBERS else "not a number"
        note = states.get(int(value), "") if math.isfinite(value) else unknown
    else:
        note = NEVER
        passed = item.window is not None and item.window.if_never == "pass"
    return Check(
        id=item.id,
        limit=limit,
        value=value,
        passed=passed,
        source=item.source,
        unit=unit,
        margin=margin,
        required=item.required,
        t=when,
        signal=item.signal,
        condition=item.condition,
        note=note,
        limit_name=states.get(int(limit), "") if states and item.condition == "equals" and math.isfinite(limit) else "",
    )


def _number(limit: float | str, states: dict[int, str], file: str, where: str) -> float:
    if not isinstance(limit, str):
        return limit
    word = state_word(limit)
    for value, name in states.items():
        if name == word:
            return float(value)
    names = [name.lower() for name in states.values()]
    hint = suggestion_or_choices(limit.lower(), names)
    raise BadInput(f"{limit!r} is no state{hint}", file=file, key=where)


def _rows(window: Window | None, recording: Recording, file: str, where: str) -> Bools:
    """Return which instants of a run are in a window."""
    t = recording.t
    rows = np.ones(len(t), dtype=bool)
    if window is None:
        return rows
    if window.from_ is not None:
        rows &= t >= window.from_
    if window.to is not None:
        rows &= t <= window.to
    if window.at == "end":
        rows[:-1] = False
    if window.after is not None:
        rows &= _after(window.after, window, recording, file, f"{where}: window.after")
    if window.phase:
        phases: Any = recording.signals.get(CHART)
        if phases is None:
            raise BadInput(f"the run has no {CHART}", file=file, key=f"{where}: window.phase")
        wanted = [_number(name, recording.states(CHART), file, f"{where}: window.phase") for name in window.phase]
        rows &= np.isin(phases, wanted)
    return rows


def _after(moment: Occasion, window: Window, recording: Recording, file: str, where: str) -> Bools:
    """Return which instants lie in the time after each one at which ``moment`` begins to hold."""
    if moment.signal not in recording.signals:
        hint = suggestion(moment.signal, list(recording.signals))
        raise BadInput(f"no signal of this name{hint}", file=file, key=where)
    unit = recording.variables[moment.signal].signal.unit
    if moment.unit is not None and moment.unit != unit:
        raise BadInput(f"the limit is in {moment.unit}, the signal in {unit}", file=file, key=where)
    limit = _number(moment.limit, recording.states(moment.signal), file, where)
    holds = CONDITIONS[moment.condition].margin(recording.signals[moment.signal], limit) >= 0.0
    begins = np.flatnonzero(holds & ~np.concatenate(([False], holds[:-1])))
    t, rows = recording.t, np.zeros(len(holds), dtype=bool)
    for start in t[begins] + window.delay:
        end = np.inf if window.lasting is None else start + window.lasting
        rows |= (t >= start - CLOSE) & (t <= end + CLOSE)
    return rows
