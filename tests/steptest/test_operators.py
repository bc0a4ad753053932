"""Temporal operators against their definition written out, step responses against closed forms."""

import math
import warnings
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from orchestrator.testing.steptest.response import Response, overshoot, rise_time, settling_time, steady_state_error
from orchestrator.testing.steptest.temporal import TemporalResult, always, eventually, rises, until

margins = st.lists(st.floats(-10.0, 10.0), min_size=1, max_size=12)


def spread(values: Any) -> Any:
    return np.array(values)


@given(margins, st.data())
def test_always_is_the_least_margin_of_its_window(values: Any, data: Any) -> None:
    rows = spread(data.draw(st.lists(st.booleans(), min_size=len(values), max_size=len(values))))
    found = always(spread(values), rows)
    chosen = [value for value, is_in in zip(values, rows, strict=True) if is_in]
    assert (found is None) == (not chosen)
    if found is not None:
        assert (found.margin, values[found.row]) == (min(chosen), min(chosen))


def margin_of(found: TemporalResult | None) -> float:
    assert found is not None
    return found.margin


@given(margins, st.data())
def test_eventually_is_the_best_of_each_window_and_the_worst_of_those(values: Any, data: Any) -> None:
    starts = data.draw(st.lists(st.integers(0, len(values) - 1), max_size=4))
    length = data.draw(st.integers(1, 14))
    found = eventually(spread(values), np.array(starts, dtype=np.intp), length)
    asked = [max(values[start : start + length]) for start in starts]
    assert (None if found is None else found.margin) == (min(asked) if asked else None)


@given(margins, st.data())
def test_until_is_as_signal_temporal_logic_defines_it(values: Any, data: Any) -> None:
    ends = data.draw(st.lists(st.floats(-10.0, 10.0), min_size=len(values), max_size=len(values)))
    start, length = data.draw(st.integers(0, len(values) - 1)), data.draw(st.integers(1, 14))
    found = until(spread(values), spread(ends), np.array([start], dtype=np.intp), length)
    window = range(start, min(start + length, len(values)))
    asked = max(min([ends[row], *values[start:row]]) for row in window)
    assert margin_of(found) == asked


@pytest.fixture(scope="module")
def rtamt() -> Any:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        return pytest.importorskip("rtamt", exc_type=ImportError)


@pytest.mark.parametrize("seed", range(10))
def test_another_monitor_finds_the_same_margins(rtamt: Any, seed: Any) -> None:
    a, b = np.random.default_rng(seed).normal(size=(2, 12)).round(3)
    for length in (1, 4, 12):
        ours = {
            f"always[0,{length - 1}](a >= 0)": lambda row, n=length: always(a, (row <= T) & (row + n > T)),
            f"eventually[0,{length - 1}](a >= 0)": lambda row, n=length: eventually(a, np.array([row]), n),
            f"(a >= 0) until[0,{length - 1}] (b >= 0)": lambda row, n=length: until(a, b, np.array([row]), n),
        }
        for formula, margin in ours.items():
            theirs = monitored(rtamt, formula, a, b)
            assert [margin_of(margin(row)) for row in T] == pytest.approx(theirs), formula


T = np.arange(12)


def monitored(rtamt: Any, formula: Any, a: Any, b: Any) -> Any:
    monitor = rtamt.StlDiscreteTimeSpecification()
    for name in ("a", "b", "out"):
        monitor.declare_var(name, "float")
    monitor.spec = f"out = {formula}"
    monitor.parse()
    return [row[1] for row in monitor.evaluate({"time": T.tolist(), "a": a.tolist(), "b": b.tolist()})]


def test_not_a_number_meets_nothing() -> None:
    values = np.array([1.0, math.nan, 1.0])
    assert math.isnan(margin_of(always(values, np.ones(3, dtype=bool))))
    assert margin_of(eventually(np.array([math.nan]), np.array([0]), 1)) == -math.inf


def test_a_condition_rises_where_it_begins_to_hold_the_start_included() -> None:
    assert rises(np.array([0.0, 1.0, -1.0, 2.0, 3.0, math.nan, 0.0])).tolist() == [0, 3, 6]


def response(of: Any, goal: Any = 1.0, band: Any = 0.02, end: Any = 30.0, step: Any = 0.001) -> Any:
    t = np.arange(0.0, end, step)
    return Response(t, of(t), goal, band)


@pytest.mark.parametrize("scale", [1.0, -2.5])
def test_a_first_order_lag(scale: float) -> None:
    lag = 0.7
    found = response(lambda t: 3.0 + scale * (1.0 - np.exp(-t / lag)), 3.0 + scale)
    assert rise_time(found) == pytest.approx(lag * math.log(9.0), abs=1e-5)
    assert settling_time(found) == pytest.approx(lag * math.log(50.0), abs=2e-3)
    assert overshoot(found) == 0.0
    assert steady_state_error(found) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("damping", [0.2, 0.5, 0.8])
def test_a_second_order_lag_overshoots_by_the_known_formula(damping: float) -> None:
    root = math.sqrt(1.0 - damping**2)
    found = response(lambda t: 1.0 - np.exp(-damping * t) * np.sin(root * t + math.acos(damping)) / root)
    assert overshoot(found) == pytest.approx(math.exp(-math.pi * damping / root), abs=1e-5)


def test_what_never_gets_there_takes_for_ever() -> None:
    found = response(lambda t: 0.5 * (1.0 - np.exp(-t)))
    assert rise_time(found) == settling_time(found) == math.inf
    assert steady_state_error(found) == pytest.approx(-0.5, abs=1e-6)
