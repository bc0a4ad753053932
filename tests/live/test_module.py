"""WebAssembly against the native FMUs, and against the same C with the same mathematics library on this machine."""

import subprocess
from collections import Counter
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fmus.native.platforms import CompileTarget
from fmus.native.web import charts_of, live_library
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.models import models_for
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.algorithm import last_exchange
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.studies.live.situation import why_not
from orchestrator.testing.coverage.tracer import name_of, tracing
from tests.live.live_module import STANDSTILL, STOP_TIME, LiveModule, disturbed, names_of, parameters, setup, times_of
from tests.native_runs import shipped_scenarios

PAGES = [models_for({"system": system}) for system in ("", "apa")]
SHIPPED = [name for name, scenario in shipped_scenarios().items() if not why_not(scenario) and scenario.models in PAGES]
EACH_CHANGE = (
    *("guo2015-case4", "apa-parallel", "zhang2022-double-track", "adaptive", "hsic", "preview"),
    *("fault-pose-noise", "apa-takeover"),
)
"""A scenario of each system of one controller, a fault, a driver who takes over; ``make release`` compares all, those
of a controller apart too, whose WebAssembly takes a compiler a quarter of a minute."""
GROW = ("preview-camera", "preview-geometry")
"""Loops on the edge, one with a picture 20 ms old: they swing, and grow the last bit of a sine to centimetres."""
REPLANS = "valet-search-60"
"""A search that weighs paths of nearly equal cost: the last bit of a sine, which is another in the C library here,
decides between them, so page and native FMU drive different paths to the same pose."""
STATIC = CompileTarget("x86_64-linux-musl", ("-static", "-Wl,-s"))


@pytest.fixture(scope="module")
def module_of() -> Any:
    modules = cache(lambda models: LiveModule(dict(models)))
    return lambda scenario: modules(tuple(scenario.models.items()))


@pytest.fixture(scope="module")
def run_of_page(module_of: Any) -> Any:
    def run(scenario: Any) -> Any:
        names = names_of(scenario)
        return names, *module_of(scenario).run(scenario, names)

    return run


def test_those_compared_on_each_change_are_shipped() -> None:
    assert set(EACH_CHANGE) < set(SHIPPED)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=() if name in EACH_CHANGE else pytest.mark.release)
        for name in SHIPPED
        if name not in (*GROW, REPLANS)
    ],
)
def test_runs_as_the_native_fmus_do(name: Any, run_of_page: Any) -> None:
    scenario = load_scenario(name)
    recording = run_scenario(scenario, fmu_files("native"), kind="native").recording
    names, end, lines = run_of_page(scenario)
    assert end == {"stop_time": STOP_TIME, "standstill": STANDSTILL}[recording.info["end"]["reason"]]
    assert (lines[:, 0] == recording.t).all()
    assert set(recording.signals) <= set(names)
    for signal, theirs in recording.signals.items():
        ours = lines[:, 1 + names.index(signal)]
        exact = recording.variables[signal].kind is not float
        within = 0.0 if exact else 1e-6
        with np.errstate(invalid="ignore"):
            is_near = bool((np.abs(ours - theirs) <= within).all())  # quicker than what says where
        if not is_near:
            np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=within, equal_nan=True, err_msg=signal)


@pytest.mark.release
def test_a_run_on_another_path_ends_as_the_native_one(run_of_page: Any) -> None:
    scenario = load_scenario(REPLANS)
    recording = run_scenario(scenario, fmu_files("native"), kind="native").recording
    names, end, lines = run_of_page(scenario)
    assert end == STANDSTILL
    assert recording.info["end"]["reason"] == "standstill"
    for signal, within in (("controller.phase", 0.0), ("vehicle.pose.x", 0.05), ("vehicle.pose.y", 0.05)):
        ours, theirs = lines[-1, 1 + names.index(signal)], recording.signals[signal][-1]
        assert abs(ours - theirs) <= within, (signal, ours, theirs)
    planned = "controller.manoeuvres"
    assert lines[-1, 1 + names.index(planned)] == recording.signals[planned][-1]


def test_a_run_ends_at_its_stop_time_also_between_two_steps(run_of_page: Any) -> None:
    scenario = load_scenario("guo2015-case4", ["stop_time=0.5237", "decimation.controller=3"])
    recording = run_scenario(scenario, fmu_files("native"), kind="native").recording
    names, _, lines = run_of_page(scenario)
    assert (lines[:, 0] == recording.t).all()
    assert lines[-1, 0] == 0.5237
    for signal, theirs in recording.signals.items():
        np.testing.assert_allclose(lines[:, 1 + names.index(signal)], theirs, rtol=0.0, atol=1e-6, equal_nan=True)


@pytest.fixture(scope="module")
def static_of(tmp_path_factory: pytest.TempPathFactory) -> Any:
    main = (Path(__file__).parent / "static.c").read_text(encoding="utf-8")

    @cache
    def program_of(models: Any) -> Path:
        built = live_library(dict(models), STATIC, ".program", {"main_unit.c": main})
        program = tmp_path_factory.mktemp("static") / "live"
        program.write_bytes(built.read_bytes())
        program.chmod(0o755)
        return program

    return lambda scenario: program_of(tuple(scenario.models.items()))


@pytest.mark.release
@pytest.mark.parametrize(
    "name", ["guo2015-case4", "apa-parallel-real", "zhang2022-double-track", "fault-pose-noise", *GROW, REPLANS]
)
def test_has_the_bits_of_this_machine_with_the_same_mathematics_library(
    name: Any, static_of: Any, run_of_page: Any
) -> None:
    scenario = load_scenario(name)
    names, end, lines = run_of_page(scenario)
    room = last_exchange(scenario.step_ns, scenario.stop_ns) + 1
    parts: list[Any] = [
        setup(scenario, names),
        parameters(scenario),
        times_of(scenario),
        disturbed(scenario),
        [room, 1 + len(names)],
    ]
    sent = b"".join(np.array([len(part), *part], dtype=float).tobytes() for part in parts)
    done = subprocess.run([static_of(scenario)], input=sent, capture_output=True, check=True)
    found = np.frombuffer(done.stdout, dtype=float)
    assert found[0] == end
    assert found[2:].tobytes() == lines.tobytes()


def next_by_table(chart: Any, state: Any, guards: Any) -> Any:
    """Return where the first row leads whose guard holds; ``state`` if there is none."""
    is_end = all(row[0] != state for row in chart.rows)
    rows = [row for row in chart.rows if row[0] == state or (row[0] < 0 and not is_end)]
    return next((row[2] for row in rows if guards >> row[1] & 1), state)


@pytest.mark.parametrize(
    "name",
    [
        *("guo2015-case4", "apa-parallel", "adaptive"),
        pytest.param("valet-search-perpendicular", marks=pytest.mark.release),
    ],
)
def test_the_guards_told_are_those_that_the_chart_went_by(name: str, module_of: Any) -> None:
    scenario = load_scenario(name)
    charts = charts_of(scenario.models.values())
    known = [f"controller.{chart.signal or 'phase'}" for chart in charts]
    lines, decided = module_of(scenario).decisions(scenario, known)
    own = [number for number, chart in enumerate(charts) if (decided[:, number, 0] >= 0).any()]
    assert sum(bool(charts[number].signal) for number in own) == 1
    for number in [item for item in own if charts[item].signal]:
        changes = 0
        for i in range(1, len(lines)):
            before, state, guards = decided[i, number].astype(int)
            if before == i - 1:
                assert state == lines[i - 1, number]
                assert next_by_table(charts[number], state, guards) == lines[i, number]
                changes += state != lines[i, number]
            else:
                assert lines[i, number] == lines[i - 1, number]
        assert changes == (np.diff(lines[:, number]) != 0).sum() >= 3


def test_the_guards_told_are_those_of_the_model_in_python(module_of: Any) -> None:
    scenario = load_scenario("guo2015-case4")
    charts = charts_of(scenario.models.values())
    _, decided = module_of(scenario).decisions(scenario, ["controller.phase"])
    with tracing(charts) as seen:
        run_scenario(scenario, {}, kind="none")
    for number, chart in enumerate(charts):
        found = [tuple(row) for i, row in enumerate(decided[:, number].astype(int)) if row[0] == i - 1 >= 0]
        assert Counter((state, guards) for _, state, guards in found) == seen[name_of(chart)]
    assert len(seen["controller_fmu.guo2015.chart"]) >= 15
