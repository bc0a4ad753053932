"""Two runs side by side: alignment, tolerances in value and time, the first excess, what is missing."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from modelkit.signal import Signal
from modelkit.variables import Variable
from modelkit.vocabulary import Gear
from orchestrator.cli import main
from orchestrator.evaluation.comparison.compare import compare
from orchestrator.evaluation.comparison.tolerance import Tolerance, Tolerances, read_tolerances
from orchestrator.evaluation.comparison.tube import Trace, distance
from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.recording import Recording

T = np.linspace(0.0, 10.0, 1001)
FLOAT = Variable("x", float, Signal("m", "a length"), 0.0)
HEADING = Variable("heading", float, Signal("rad", "an angle"), 0.0)
MODE = Variable("gear", int, Signal("1", "a mode", states=Gear), 0)


def made(t: Any = T, **signals: Any) -> Recording:
    kinds = {"x": FLOAT, "heading": HEADING, "gear": MODE}
    return Recording(
        np.round(np.asarray(t) * 1e9).astype(np.int64),
        {f"vehicle.{name}": np.asarray(values, dtype=float) for name, values in signals.items()},
        {},
        {f"vehicle.{name}": kinds[name] for name in signals},
    )


def verdict(a: Recording, b: Recording, **tolerance: float) -> Any:
    found = compare(a, b, Tolerances(Tolerance(**tolerance)))
    return found, {row.signal.removeprefix("vehicle."): row for row in found.signals}


def test_a_run_equals_itself() -> None:
    run = made(x=np.sin(T), gear=T > 5.0, heading=T)
    found, rows = verdict(run, run, absolute=0.0, relative=0.0)
    assert found.passed
    assert (found.compared, found.differing) == (4, 0)
    assert all(row.largest == 0.0 and row.first is None for row in rows.values())


def test_absolute_tolerance_and_the_first_excess() -> None:
    offset = np.where(T > 4.0, 0.02, 0.0) + np.where((T > 7.0) & (T < 7.1), 0.01, 0.0)
    a, b = made(x=np.sin(T)), made(x=np.sin(T) + offset)
    assert verdict(a, b, absolute=0.0301)[0].passed
    found, rows = verdict(a, b, absolute=0.01)
    assert not found.passed
    assert rows["x"].first == pytest.approx(4.01)
    assert rows["x"].largest == pytest.approx(0.03)
    assert rows["x"].t_largest == pytest.approx(7.05, abs=0.05)
    assert verdict(a, b, absolute=0.025)[1]["x"].first == pytest.approx(7.01)


def test_the_larger_of_absolute_and_relative_counts() -> None:
    a, b = made(x=np.linspace(0.0, 100.0, 1001)), made(x=np.linspace(0.0, 100.9, 1001))
    assert verdict(a, b, absolute=0.0, relative=0.0091)[0].passed
    assert verdict(a, b, absolute=0.91, relative=0.0)[0].passed
    found, rows = verdict(a, b, absolute=0.45, relative=0.001)
    assert not found.passed
    assert rows["x"].first == pytest.approx(5.01, abs=0.011)
    assert rows["x"].allowed == 0.45


def test_time_tolerance_forgives_a_shift_but_not_a_value() -> None:
    shift = 0.2
    a, b = made(x=np.sin(2.0 * T)), made(x=np.sin(2.0 * (T - shift)))
    assert not verdict(a, b, absolute=1e-6, time=0.15)[0].passed
    inner = T[(T > 1.0) & (T < 9.0)]
    a, b = made(inner, x=np.sin(2.0 * inner)), made(inner, x=np.sin(2.0 * (inner - shift)))
    rows = verdict(a, b, absolute=1e-4, time=0.21)[1]
    assert rows["x"].passed is False, "at the first instants the reference has not yet been there"
    inside = slice(30, -30)
    b = made(inner[inside], x=np.sin(2.0 * (inner[inside] - shift)))
    assert verdict(a, b, absolute=1e-4, time=0.21)[1]["x"].passed
    taller = made(inner[inside], x=1.05 * np.sin(2.0 * (inner[inside] - shift)))
    assert not verdict(a, taller, absolute=1e-4, time=0.21)[1]["x"].passed


def test_runs_of_different_steps_are_aligned_in_time() -> None:
    coarse = np.linspace(0.0, 10.0, 101)
    a, b = made(x=3.0 * T), made(coarse, x=3.0 * coarse)
    assert verdict(a, b, absolute=1e-9)[0].passed
    assert verdict(b, a, absolute=1e-9)[0].passed


def test_a_mode_may_change_a_little_later_but_not_be_another() -> None:
    a, b = made(gear=np.where(T < 5.0, 1, 3)), made(gear=np.where(T < 5.1, 1, 3))
    assert not verdict(a, b)[0].passed
    assert verdict(a, b)[1]["gear"].first == pytest.approx(5.0)
    assert verdict(a, b, time=0.15)[0].passed
    between = made(gear=np.where(T < 5.0, 1, 3) + np.where(np.abs(T - 5.0) < 0.02, 1, 0) * (T < 5.0))
    rows = verdict(a, between, time=0.15)[1]
    assert not rows["gear"].passed, "2 lies between 1 and 3 but the reference never was 2"


def test_headings_are_compared_as_angles() -> None:
    a = made(heading=np.linspace(3.0, 3.3, 1001))
    wrapped = (np.linspace(3.0, 3.3, 1001) + math.pi) % (2.0 * math.pi) - math.pi
    assert verdict(a, made(heading=wrapped), absolute=1e-9)[0].passed
    for turns in (-1, 2):
        turned = made(heading=np.linspace(3.0, 3.3, 1001) + turns * 2.0 * math.pi)
        assert verdict(a, turned, absolute=1e-9)[0].passed
    assert not verdict(a, made(heading=wrapped + 0.01), absolute=1e-3)[0].passed


def test_not_a_number_equals_only_itself() -> None:
    hole = np.where((T > 3.0) & (T < 4.0), np.nan, 1.0)
    assert verdict(made(x=hole), made(x=hole))[0].passed
    found, rows = verdict(made(x=np.ones(1001)), made(x=hole), absolute=1e6)
    assert not found.passed
    assert rows["x"].largest is None
    assert rows["x"].first == pytest.approx(3.01)
    json.loads(found.model_dump_json())


def test_length_of_the_runs_is_judged() -> None:
    a, b = made(x=T), made(T[:901], x=T[:901])
    found, rows = verdict(a, b, absolute=0.5)
    assert not found.passed
    assert rows["duration"].largest == pytest.approx(1.0)
    assert rows["x"].passed
    assert verdict(a, b, absolute=0.5, time=1.0)[0].passed


def test_a_signal_that_is_gone_differs_and_a_new_one_is_listed() -> None:
    a, b = made(x=T, heading=T), made(x=T, gear=T > 5)
    found, rows = verdict(a, b)
    assert not found.passed
    assert rows["heading"].note == "only in A"
    assert found.only_in_a == ["vehicle.heading"]
    assert found.only_in_b == ["vehicle.gear"]


def test_patterns_choose_signals_and_tolerances(tmp_path: Path) -> None:
    file = tmp_path / "tolerances.yaml"
    file.write_text('"vehicle.*": {abs: 1 cm}\n"*.heading": {rel: 0, time: 50 ms}\n')
    tolerances = read_tolerances(file, Tolerance(0.5, 0.25, 0.0))
    assert tolerances.of("vehicle.x", "m") == Tolerance(0.01, 0.25, 0.0)
    with pytest.raises(BadInput, match=r"vehicle\.\*: abs: .*1 cm"):
        tolerances.of("vehicle.heading", "rad")
    a, b = made(x=T, gear=T > 5), made(x=T, gear=T > 6)
    assert compare(a, b, Tolerances(Tolerance()), ["*.x"]).passed
    with pytest.raises(BadInput, match="no signal fits"):
        compare(a, b, Tolerances(Tolerance()), ["*.y"])


def test_a_later_pattern_counts_even_if_an_earlier_one_has_another_unit(tmp_path: Path) -> None:
    file = tmp_path / "tolerances.yaml"
    file.write_text('"vehicle.pose.*": {abs: 1 cm, time: 100 ms}\n"*.heading": {abs: 0.5 deg}')
    tolerances = read_tolerances(file, Tolerance())
    assert tolerances.of("vehicle.pose.heading", "rad") == Tolerance(math.radians(0.5), 1e-9, 0.1)
    assert tolerances.of("vehicle.pose.x", "m") == Tolerance(0.01, 1e-9, 0.1)


@pytest.mark.parametrize("text", ["x: 3", "x: {abs: -1}", "x: {absolute: 1}", "x: {abs: 1 kg}"])
def test_bad_tolerances_are_refused_with_their_key(tmp_path: Path, text: str) -> None:
    file = tmp_path / "tolerances.yaml"
    file.write_text(text)
    with pytest.raises(BadInput, match="x"):
        read_tolerances(file, Tolerance()).of("x", "m")


def test_tube_against_a_search_over_all_pairs() -> None:
    random = np.random.default_rng(7)
    t = np.unique(np.round(random.uniform(0.0, 5.0, 60), 3))
    a, b = random.normal(size=len(t)), random.normal(size=len(t))
    tolerance = Tolerance(0.3, 0.2, 0.4)
    found = distance(Trace(t, a, False), Trace(t, b, False), tolerance)
    fine = np.linspace(t[0], t[-1], 40_001)
    line = np.interp(fine, t, a)
    allowed = np.maximum(0.3, 0.2 * np.abs(line))
    for moment, raw, excess in zip(found.t, found.raw, found.excess, strict=True):
        near = np.abs(fine - moment) <= tolerance.time
        value = np.interp(moment, t, b)
        low, high = line[near].min(), line[near].max()
        assert raw == pytest.approx(max(low - value, value - high, 0.0), abs=0.02)
        edges = (line - allowed)[near].min(), (line + allowed)[near].max()
        assert excess == pytest.approx(max(edges[0] - value, value - edges[1]), abs=0.02)


def test_runs_of_different_scenarios_are_said_to_be(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("guo2015-case3", "guo2015-case4"):
        run = ["run", name, "--fmus", "none", "--no-page", "--set", "stop_time=0.1", "--out", str(tmp_path / name)]
        assert main(run) == 1
    capsys.readouterr()
    assert main(["compare", str(tmp_path / "guo2015-case3"), str(tmp_path / "guo2015-case4")]) == 0
    assert "note: the runs are of different scenarios: guo2015-case3, guo2015-case4" in capsys.readouterr().err


def test_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    names = ("a", "same", "other")
    sets: tuple[list[str], ...] = ([], [], ["--set", "controller.guo2015.k4=3"])
    for name, changes in zip(names, sets, strict=True):
        main(["run", "guo2015-case4", "--fmus", "native", "--no-page", "--out", str(tmp_path / name), *changes])
    a, same, other = (str(tmp_path / name / "run.mcap") for name in names)
    capsys.readouterr()
    assert main(["compare", a, same, "--abs", "0", "--rel", "0"]) == 0
    assert main(["compare", a, other, "--html", str(tmp_path / "overlay.html")]) == 1
    assert main(["compare", a, other, "--signals", "vehicle.gear", "--time", "1 s"]) == 0
    capsys.readouterr()
    assert main(["compare", a, other, "--abs", "0.05", "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert [change["name"] for change in found["parameters"]] == ["controller.guo2015.k4"]
    assert found["signals"][0]["passed"] is False
    assert main(["compare", a, str(tmp_path / "nothing.mcap")]) == 2
    assert main(["compare", a, same, "--abs", "-1"]) == 2
    assert (tmp_path / "overlay.html").stat().st_size < 1_000_000
