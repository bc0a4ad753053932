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
    "adaptive",
    "adaptive-ahead",
)
"""Of the shipped scenarios those that the others add nothing to."""
OWN = (*(HERE / "suite").glob("*.yaml"), HERE.parent / "steptest" / "test_guo2015_manoeuvre.yaml")
BY_ITSELF = ("apa", "apa_large")
"""Systems whose chart has exhaustive tests of its own (tests/parking/test_chart.py)."""
NEVER_TAKEN: dict[tuple[str, str, str], str] = {}
"""(chart, source, guard) -> why nothing takes it."""
NEVER_REFUSED = {
    key: why for key, why in NEVER_TAKEN.items() if key[1] not in ("PARKED", "FAILED", "TAKEN_OVER", "TAKEOVER")
}
"""(chart, source, guard) -> why the guard is never false while it decides."""


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> list[ChartCoverage]:
    folder = tmp_path_factory.mktemp("every")
    own = [str(file) for file in OWN]
    apart = {name: model for name, model in apart_models().items() if name not in BY_ITSELF}
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
    assert len(found) == 2
    never = {(short(chart.name), name) for chart in found for name, count in chart.states.items() if not count}
    assert never == {(chart, source) for chart, source, _ in NEVER_REFUSED}


def short(name: str) -> str:
    return name.removeprefix("controller_fmu.")
