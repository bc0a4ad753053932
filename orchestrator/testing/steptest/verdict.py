"""A recording held against the expectations of a step test: one check each, with the instant that decided."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from orchestrator.evaluation.comparison.compare import compare
from orchestrator.evaluation.comparison.tolerance import Tolerance, Tolerances
from orchestrator.evaluation.verdict.conditions import CONDITIONS
from orchestrator.evaluation.verdict.judge import NEVER, Check, judge
from orchestrator.evaluation.verdict.numbers import facts_of
from orchestrator.evaluation.verdict.truth import Bools
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput, suggestion_or_choices
from orchestrator.inputs.text.quantities import number, scalar
from orchestrator.simulation.cosim.fmu_instance import Array, Indices
from orchestrator.simulation.cosim.recording import Recording
from orchestrator.testing.steptest.expectation import Expectation, Limit, Number, Reaction
from orchestrator.testing.steptest.response import RESPONSES, Response
from orchestrator.testing.steptest.step_test import StepTest
from orchestrator.testing.steptest.temporal import TemporalResult, always, eventually, rises, until


class LimitMargins(NamedTuple):
    """A limit as numbers: signal, limit in its unit, margins at all instants."""

    signal: str
    limit: float
    margins: Array


def judge_step_test(test: StepTest, recording: Recording) -> list[Check]:
    """Return one check for each expectation. Raises ``BadInput`` for a signal or unit that does not fit."""
    return [*(_Judge(test, recording, item).check() for item in test.expect), *_contact(test, recording)]


def _contact(test: StepTest, recording: Recording) -> list[Check]:
    """Return the check that the car touches nothing, for a vehicle with something in its scene."""
    owner = next(iter(recording.signals), "").split(".", 1)[0]

    def with_vehicle_names(items: Mapping[str, Any]) -> dict[str, Any]:
        return {f"vehicle.{name.removeprefix(f'{owner}.')}": item for name, item in items.items()}

    as_vehicle = replace(
        recording, signals=with_vehicle_names(recording.signals), parameters=with_vehicle_names(recording.parameters)
    )
    scenario = Scenario(name="test", contact_allowed=test.contact_allowed)
    return judge([scenario.contact_rule], as_vehicle, facts_of(as_vehicle, scenario), str(test.file))


def equivalent(test: StepTest, recording: Recording, reference: Recording) -> list[Check]:
    """Return one check for each output that has to be the reference's, worst first."""
    asked = test.reference
    assert asked is not None
    tolerances = Tolerances(Tolerance(asked.absolute, asked.relative, asked.time))
    owner = next(iter(recording.signals)).split(".", 1)[0]
    patterns = [f"{owner}.{pattern}" for pattern in asked.signals]
    found = compare(reference, recording, tolerances, patterns)
    return [
        Check(
            id=f"as the reference: {row.signal}",
            limit=row.allowed,
            value=math.nan if row.largest is None else row.largest,
            passed=row.passed,
            source="reference",
            unit=row.unit,
            margin=math.nan if row.largest is None else row.allowed - row.largest,
            required=True,
            t=row.t_largest or 0.0,
            signal=row.signal,
            condition="max",
            note=row.note,
        )
        for row in found.signals
    ]


class Outcome(NamedTuple):
    """What came of one expectation."""

    value: float
    margin: float
    t: float
    passed: bool
    note: str = ""
    unit: str = ""
    """Where it is not the signal's."""


class _Judge:
    """One expectation and one recording."""

    def __init__(self, test: StepTest, recording: Recording, item: Expectation) -> None:
        self._file = test.file
        self._step = test.step_ns / 1e9
        self._recording = recording
        self._item = item
        self._owner = next(iter(recording.signals)).split(".", 1)[0]

    def check(self) -> Check:
        item = self._item
        if item.response is not None:
            return self._response(item.response)
        limit = item.always or item.eventually or item.hold
        assert limit is not None
        found = self._measure(limit)
        decided = self._decide(found)
        if decided is None:
            return self._check(limit, found, Outcome(math.nan, math.nan, 0.0, item.if_never == "pass", NEVER))
        value = float(self._recording.signals[found.signal][decided.row])
        states = self._recording.states(found.signal)
        note = "" if not math.isfinite(value) else states.get(int(value), "")
        t = float(self._recording.t[decided.row])
        return self._check(limit, found, Outcome(value, decided.margin, t, decided.margin >= 0.0, note))

    def _decide(self, found: LimitMargins) -> TemporalResult | None:
        item, count = self._item, len(self._recording.t)
        starts = self._starts()
        length = count if item.within is None else round(self._seconds(item.within) / self._step) + 1
        if item.eventually is not None:
            return eventually(found.margins, starts, length)
        if item.until is not None:
            return until(found.margins, self._measure(item.until).margins, starts, length)
        rows = np.zeros(count, dtype=bool)
        for start in starts:
            rows[start : start + length] = True
        return always(found.margins, rows & self._window())

    def _starts(self) -> Indices:
        window = self._window()
        if self._item.after is None:
            return np.flatnonzero(window)[:1].astype(np.intp)
        begun = rises(self._measure(self._item.after).margins)
        return begun[window[begun]]

    def _window(self) -> Bools:
        t, item = self._recording.t, self._item
        first = 0.0 if item.from_ is None else self._seconds(item.from_)
        last = math.inf if item.to is None else self._seconds(item.to)
        return np.asarray((t >= first - 1e-9) & (t <= last + 1e-9))

    def _measure(self, limit: Limit) -> LimitMargins:
        name = self._name(limit.signal or self._item.signal)
        value = self._value(limit.limit, name)
        return LimitMargins(name, value, CONDITIONS[limit.condition].margin(self._recording.signals[name], value))

    def _response(self, asked: Reaction) -> Check:
        name = self._name(self._item.signal)
        measured = RESPONSES[asked.measure]
        t = self._recording.t
        end = math.inf if asked.end is None else self._seconds(asked.end)
        rows = (t >= self._seconds(asked.at) - 1e-9) & (t <= end + 1e-9)
        band = number(asked.band, "1", file=self._file, key=self._item.id)
        values = self._recording.signals[name][rows]
        unit = measured.unit or self._recording.variables[name].signal.unit
        limit = number(asked.limit.limit, unit, file=self._file, key=self._item.id)
        value = math.nan
        if len(values) and np.isfinite(values).all():
            value = measured.of(Response(t[rows], values, self._value(asked.to, name), band))
        margin = float(CONDITIONS[asked.limit.condition].margin(np.array([value]), limit)[0])
        found = LimitMargins(name, limit, np.array([margin]))
        outcome = Outcome(value, margin, self._seconds(asked.at), margin >= 0.0, unit=unit)
        return self._check(asked.limit, found, outcome)

    def _check(self, limit: Limit, found: LimitMargins, outcome: Outcome) -> Check:
        item, states = self._item, self._recording.states(found.signal)
        named = states.get(int(found.limit), "") if states and limit.condition == "equals" else ""
        return Check(
            id=item.id,
            limit=found.limit,
            value=outcome.value,
            passed=bool(outcome.passed),
            source=f"{item.source}, {item.response.measure.replace('_', ' ')}" if item.response else item.source,
            unit=outcome.unit or self._recording.variables[found.signal].signal.unit,
            margin=outcome.margin,
            required=True,
            t=outcome.t,
            signal=found.signal,
            condition=limit.condition,
            note=outcome.note,
            limit_name=named,
        )

    def _name(self, name: str) -> str:
        full = f"{self._owner}.{name}"
        if full not in self._recording.signals:
            known = [item.split(".", 1)[1] for item in self._recording.signals]
            hint = suggestion_or_choices(name, known)
            raise BadInput(f"{name}: no such input or output{hint}", file=self._file, key=self._item.id)
        return full

    def _value(self, given: Number, name: str) -> float:
        variable = self._recording.variables[name]
        bare = variable._replace(name=self._item.id, signal=variable.signal._replace(low=-math.inf, high=math.inf))
        return float(scalar(given, bare, file=self._file))

    def _seconds(self, given: Number) -> float:
        return number(given, "s", file=self._file, key=self._item.id)
