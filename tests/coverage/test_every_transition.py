"""Every transition of every chart is taken by scenarios and step tests, each guard seen true and false."""

from pathlib import Path

import pytest

from orchestrator.cli import main
from orchestrator.inputs.scenario.models import MODELS, apart_models
from orchestrator.testing.coverage.covered import ChartCoverage, chart_coverage
from orchestrator.testing.coverage.tracer import name_of, tracing

pytestmark = pytest.mark.release  # measures the tests, not the models
HERE = Path(__file__).parent
SHIPPED = (
    "guo2015-case4",
    "fault-driver-takes-over",
    "fault-no-path",
    "apa-takeover",
    "apa-sensor-loss",
    "apa-pedestrian",
    "apa-no-slot",
    "adaptive",
    "adaptive-ahead",
    "valet-obstacle-on-path",
)
"""Of the shipped scenarios those that the others add nothing to."""
OWN = (*(HERE / "suite").glob("*.yaml"), HERE.parent / "steptest" / "test_guo2015_manoeuvre.yaml")
SEARCH = (
    ("OFF", "RESUMED"),
    ("OFF", "SWITCHED_ON"),
    ("SEARCH", "SWITCHED_OFF"),
    ("SEARCH", "FAULT"),
    ("SEARCH", "FOUND"),
    ("SHOWN", "SWITCHED_OFF"),
    ("SHOWN", "FAULT"),
    ("SHOWN", "REFUSED"),
    ("SHOWN", "DRIVEN_ON"),
    ("SHOWN", "CONFIRMED"),
)
SEARCHED = "a drive of the valet's search takes minutes in CPython; tests/valet/test_valet_search.py has some, compiled"
UNDER_CONSTRUCTION = ("parking",)
"""Systems whose chart is tested by itself (tests/parking) until they replace another."""
NEVER_TAKEN = {
    (
        "apa.manoeuvre_chart",
        "IDLE",
        "STARTED",
    ): "the assist makes a manoeuvre that plans already when it shows the slot",
    **{("valet.chart", source, guard): SEARCHED for source, guard in SEARCH},
    **{("valet.chart", source, "SWITCHED_OFF"): SEARCHED for source in ("PARKED", "FAILED", "TAKEN_OVER")},
}
"""(chart, source, guard) -> why nothing takes it."""
NEVER_REFUSED = {key: why for key, why in NEVER_TAKEN.items() if key[1] not in ("PARKED", "FAILED", "TAKEN_OVER")}
"""(chart, source, guard) -> why the guard is never false while it decides."""
VALET = """
model: controller
step: 10 ms
stop_time: 2 s
parameters: {{system: valet, target: {{x: 3, y: 0, heading: 0}}}}
inputs:
  odometry.x: {{step: {{at: 1.2 s, from: 0, to: 3}}}}
  measured_speed: {{table: [[0, 0.08], [0.2, 0.08], [0.21, 0], [1.2, 0], [1.21, 0.08], [1.5, 0.08], [1.51, 0]]}}
  steering_wheel_angle: {{table: [[0.25, 0], [0.26, 0.4], [0.5, 0.4], [0.51, 0], [1.5, 0], [1.51, 0.4]]}}
  {input}: {{step: {{at: {at} s, to: {value}}}}}
expect:
  - {{id: before, signal: valet.step, always: {{equals: {before}}}, from: {at} s, to: {at} s}}
  - {{id: after, signal: valet.step, always: {{equals: {after}}}, from: {at} s + 0.02}}
"""
"""The valet alone: it plans to go straight ahead, waits for the wheel, drives, halts and straightens the wheel."""
VALET_STEPS = {"PLAN": 0.1, "SET_WHEEL": 0.4, "DRIVE": 0.9, "HALT": 1.35, "STRAIGHTEN": 1.7}
CAUSES = {"TAKEN_OVER": ("driver_takeover", "true"), "FAILED": ("vehicle_fault", "1")}


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> list[ChartCoverage]:
    folder = tmp_path_factory.mktemp("every")
    own = [str(file) for file in OWN]
    for before, at in VALET_STEPS.items():
        for after, (name, value) in CAUSES.items():
            file = folder / f"valet-{before}-{after}.yaml"
            words = {"input": name, "at": at, "value": value, "before": before, "after": after}
            file.write_text(VALET.format(**words).replace(f"{at} s + 0.02", f"{at + 0.02:.2f} s"))
            own.append(str(file))
    apart = {name: model for name, model in apart_models().items() if name not in UNDER_CONSTRUCTION}
    charts = [chart for model in (*MODELS.values(), *apart.values()) for chart in model.all_charts()]
    with tracing(charts) as seen:
        assert main(["test", *SHIPPED, *own, "--fmus", "none", "--out", str(folder / "out")]) == 0
    return [chart_coverage(chart, seen[name_of(chart)]) for chart in charts]


def test_every_transition_is_taken_but_those_with_a_reason(found: list[ChartCoverage]) -> None:
    missing = {(short(chart.name), row.source, row.guard) for chart in found for row in chart.rows if not row.taken}
    assert missing == set(NEVER_TAKEN)


def test_every_guard_decides_against_its_row_too_but_those_with_a_reason(found: list[ChartCoverage]) -> None:
    missing = {(short(chart.name), row.source, row.guard) for chart in found for row in chart.rows if not row.refused}
    assert missing == set(NEVER_REFUSED)


def test_every_state_is_visited(found: list[ChartCoverage]) -> None:
    assert len(found) == 5
    never = {(short(chart.name), name) for chart in found for name, count in chart.states.items() if not count}
    assert never == {(chart, source) for chart, source, _ in NEVER_REFUSED}


def short(name: str) -> str:
    return name.removeprefix("controller_fmu.")
