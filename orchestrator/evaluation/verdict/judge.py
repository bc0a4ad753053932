"""From requirements and a recording to verdicts: the only place where a limit meets a value."""

import math
from functools import cache

import numpy as np
from pydantic import BaseModel, ConfigDict

from modelkit.variables import variables
from orchestrator.evaluation.verdict.conditions import CONDITIONS
from orchestrator.evaluation.verdict.numbers import NUMBERS, RunFacts, signals_of
from orchestrator.evaluation.verdict.truth import Bools
from orchestrator.inputs.scenario.end_condition import state_word, states_of
from orchestrator.inputs.scenario.models import MODELS, apart_models
from orchestrator.inputs.scenario.requirements import Condition, Occasion, Requirement, Window
from orchestrator.inputs.text.errors import BadInput, suggestion, suggestion_or_choices
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.simulation.cosim.recording import Recording

CHART = "controller.phase"
NEVER = "the window never comes"
TIME_TOLERANCE = 1e-9
"""Instants are the same within this [s]."""


class Check(BaseModel):
    """The result of one requirement."""

    model_config = ConfigDict(extra="forbid")

    id: str
    """Name of the requirement."""
    limit: float
    """Required limit [unit]."""
    value: float
    """Value with the smallest margin; NaN if there is none."""
    passed: bool
    """Whether the run meets the requirement."""
    source: str
    """Origin of the requirement."""
    unit: str
    """SI unit of value, limit and margin."""
    margin: float
    """Distance to the limit; negative if the limit is violated."""
    required: bool
    """If true, a violation excludes the outcomes `parked` and `finished`."""
    t: float
    """Time of the value [s]."""
    signal: str
    """Signal, or metric of the summary."""
    condition: Condition
    """max, min, max_abs or equals."""
    note: str = ""
    """Name of the state, or reason for a missing value."""
    limit_name: str = ""
    """Name of the required state."""
    evaluated: bool = True
    """False if an FMU lacks the output; then `passed` is false."""


def judge(requirements: list[Requirement], recording: Recording, facts: RunFacts, file: str) -> list[Check]:
    """Return one check for each requirement that is asked of a run with these facts.

    Raises ``BadInput`` for a name that neither the run nor the summary has, or a limit in another unit.
    """
    asked = [item for item in requirements if item.where is None or item.where in facts.has]
    return [_check(item, recording, facts.numbers, file) for item in asked]


def _check(item: Requirement, recording: Recording, numbers: dict[str, float], file: str) -> Check:
    where = f"{item.id}: {item.signal}"
    if _lacks_signals(item, recording, numbers):
        return _not_judged(item)
    if item.signal in recording.signals:
        unit = recording.variables[item.signal].signal.unit
        states = recording.states(item.signal)
    elif item.signal in numbers:
        unit, states = NUMBERS[item.signal].unit, {}
        if item.window is not None:
            raise BadInput("a number of the summary has no window", file=file, key=where)
    else:
        known = [*recording.signals, *numbers]
        raise BadInput(f"no signal or number of this name{suggestion(item.signal, known)}", file=file, key=where)
    if item.unit is not None and item.unit != unit:
        raise BadInput(f"the limit is in {item.unit}, the signal in {unit}", file=file, key=where)
    limit = _number(item.limit, states, file, where)
    worst = _Worst(item, limit)
    if item.signal in recording.signals:
        window = _WindowRows(item.window, recording, file, where)
        for part, first_row, is_last in recording.parts():
            rows = window.rows(part, first_row, is_last)
            worst.add(part.signals[item.signal][rows], part.t[rows])
    else:
        worst.add(np.array([numbers[item.signal]]), np.array([numbers["duration"]]))
    return _verdict(item, worst, limit, unit, states)


def _lacks_signals(item: Requirement, recording: Recording, numbers: dict[str, float]) -> bool:
    """Return whether a requirement needs what our models put out, but the FMUs of this run do not."""
    named = [item.signal, *([item.window.after.signal] if item.window is not None and item.window.after else [])]
    absent = [name for name in named if name not in recording.signals and name not in NUMBERS]
    missing = any(name in _signal_names() for name in absent)
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
def _signal_names() -> frozenset[str]:
    models = [*MODELS.items(), *(("controller", model) for model in apart_models().values())]
    return frozenset(f"{owner}.{item.name}" for owner, model in models for item in variables(model.outputs))


def _not_judged(item: Requirement) -> Check:
    known = NUMBERS[item.signal].unit if item.signal in NUMBERS else item.unit or "1"
    limit = item.limit if isinstance(item.limit, float) else math.nan
    name = item.limit if isinstance(item.limit, str) else ""
    lacking = {"passed": False, "note": "not measured", "limit_name": name, "evaluated": False}
    return _verdict(item, _Worst(item, limit), limit, known, {}).model_copy(update=lacking)


class _Worst:
    """The value that decides, the worst or the best of those that come in parts; NaN is the worst there is."""

    def __init__(self, item: Requirement, limit: float) -> None:
        self._item, self._limit = item, limit
        self._rank = 0.0
        self.value = self.margin = math.nan
        self.t = 0.0
        self.is_known = False
        """There was a value."""

    def add(self, values: Array, times: Array) -> None:
        """Take further values at ``times`` [s]."""
        if not len(values):
            return
        found = CONDITIONS[self._item.condition].margin(values, self._limit)
        ranks = np.where(np.isnan(found), -np.inf, found)
        row = int(np.argmax(ranks) if self._item.ever else np.argmin(ranks))
        rank = float(ranks[row])
        if not self.is_known or (rank > self._rank if self._item.ever else rank < self._rank):
            self._rank, self.value, self.margin = rank, float(values[row]), float(found[row])
            self.t, self.is_known = float(times[row]), True


def _verdict(item: Requirement, worst: _Worst, limit: float, unit: str, states: dict[int, str]) -> Check:
    """Return the check at the value that decides; not-a-number passes nothing."""
    if worst.is_known:
        passed = worst.margin >= 0.0
        unknown = "not known" if item.signal in NUMBERS else "not a number"
        note = states.get(int(worst.value), "") if math.isfinite(worst.value) else unknown
    else:
        note = NEVER
        passed = item.window is not None and item.window.if_never == "pass"
    return Check(
        id=item.id,
        limit=limit,
        value=worst.value,
        passed=passed,
        source=item.source,
        unit=unit,
        margin=worst.margin,
        required=item.required,
        t=worst.t,
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


class _WindowRows:
    """Which instants of a run are in a window; asked part by part, in order of time. Raises ``BadInput``."""

    def __init__(self, window: Window | None, recording: Recording, file: str, where: str) -> None:
        self._window = window
        self._after: _After | None = None
        self._phases: list[float] = []
        if window is None:
            return
        if window.after is not None:
            self._after = _After(window.after, window, recording, file, f"{where}: window.after: {window.after.signal}")
        if window.phase:
            if CHART not in recording.signals:
                raise BadInput(f"the run has no {CHART}", file=file, key=f"{where}: window.phase")
            states = recording.states(CHART)
            self._phases = [_number(name, states, file, f"{where}: window.phase") for name in window.phase]

    def rows(self, part: Recording, first_row: int, is_last: bool) -> Bools:
        """Return which instants of the next part, which begins at ``first_row``, count."""
        t, window = part.t, self._window
        rows = np.ones(len(t), dtype=bool)
        if window is None:
            return rows
        if window.from_ is not None:
            rows &= t >= window.from_
        if window.to is not None:
            rows &= t <= window.to
        if window.at == "end":
            rows[: -1 if is_last else None] = False
        if self._after is not None:
            rows &= self._after.rows(part)
        if self._phases:
            rows &= np.isin(part.signals[CHART], self._phases)
        return rows


class _After:
    """Which instants lie in the time after each one at which an occasion begins to hold."""

    def __init__(self, occasion: Occasion, window: Window, recording: Recording, file: str, where: str) -> None:
        if occasion.signal not in recording.signals:
            hint = suggestion(occasion.signal, list(recording.signals))
            raise BadInput(f"no signal of this name{hint}", file=file, key=where)
        unit = recording.variables[occasion.signal].signal.unit
        if occasion.unit is not None and occasion.unit != unit:
            raise BadInput(f"the limit is in {occasion.unit}, the signal in {unit}", file=file, key=where)
        self._occasion, self._window = occasion, window
        self._limit = _number(occasion.limit, recording.states(occasion.signal), file, where)
        self._held = False
        self._starts: list[float] = []
        """Of the times that have not ended yet [s]."""

    def rows(self, part: Recording) -> Bools:
        """Return which instants of the next part are in such a time."""
        t, lasting = part.t, np.inf if self._window.lasting is None else self._window.lasting
        rows = np.zeros(len(t), dtype=bool)
        if not len(t):
            return rows
        values = part.signals[self._occasion.signal]
        holds = CONDITIONS[self._occasion.condition].margin(values, self._limit) >= 0.0
        begins = np.flatnonzero(holds & ~np.concatenate(([self._held], holds[:-1])))
        self._held = bool(holds[-1])
        self._starts += (t[begins] + self._window.delay).tolist()
        if self._window.lasting is None:
            self._starts = self._starts[:1]
        for start in self._starts:
            rows |= (t >= start - TIME_TOLERANCE) & (t <= start + lasting + TIME_TOLERANCE)
        self._starts = [start for start in self._starts if start + lasting + TIME_TOLERANCE >= t[-1]]
        return rows
