"""Where each shipped scenario ends, and how, beside what it did when ``scenarios.yaml`` was last written.

A change of behaviour shows as a difference of that file: ``pytest tests/golden --update``, then ``git diff``.
"""

from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml

from orchestrator.evaluation.verdict.summary import Summary, summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario, scenario_names
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import can_compile, fmu_files

FILE = Path(__file__).parent / "scenarios.yaml"
DIGITS = 6
"""Of what is kept. Mathematics libraries differ by less, compilers not at all."""
LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
TOLERANCE = 2 * 10.0**-DIGITS
PARKING = ("apa-", "cicap-", "valet-")
"""How scenarios of the parking system are called: it touches nothing."""

pytestmark = pytest.mark.skipif(not can_compile(), reason="FMUs without Python need a C compiler: pip install ziglang")


@cache
def kept() -> dict[str, Any]:
    return yaml.load(FILE.read_text(encoding="utf-8"), Loader=LOADER) if FILE.exists() else {}


def driven(name: str) -> dict[str, Any]:
    scenario = load_scenario(name, [])
    ran = run_scenario(scenario, fmu_files("native", lambda text: None), kind="native")
    assert not (name.startswith(PARKING) and ran.recording.signals["vehicle.contact"].any()), "contact"
    return reported(summarize(ran.recording, scenario, ran.wall_time))


def reported(summary: Summary) -> dict[str, Any]:
    final = summary.final
    return {
        "outcome": summary.outcome,
        "reason": summary.reason,
        "duration": rounded(summary.duration),
        "manoeuvres": summary.manoeuvres,
        "pose": [rounded(value) for value in (final.x, final.y, final.heading)],
        "events": [[rounded(event.t), event.to] for event in summary.events],
        "margins": {check.id: rounded(check.margin) if check.evaluated else None for check in summary.checks},
    }


def rounded(value: float) -> float:
    return round(value, DIGITS) + 0.0


@pytest.fixture(scope="session")
def update(request: pytest.FixtureRequest) -> bool:
    return bool(request.config.getoption("--update"))


def test_the_record_is_of_the_shipped_scenarios(update: bool) -> None:
    if update:
        record = {name: driven(name) for name in scenario_names()}
        FILE.write_text(yaml.safe_dump(record, default_flow_style=None, sort_keys=False, width=120), encoding="utf-8")
    assert set(kept()) == set(scenario_names()), "scenarios were added or removed: pytest tests/golden --update"


def test_the_record_has_the_outcomes_that_the_scenarios_expect() -> None:
    record = kept()
    expected = {name: load_scenario(name, []).expected_outcome for name in scenario_names() if name in record}
    assert {name: record[name]["outcome"] for name in expected} == expected


@pytest.mark.parametrize("name", scenario_names())
def test_a_scenario_ends_as_it_did(name: str, update: bool) -> None:
    found, asked = driven(name), kept()[name]
    assert alike(found, asked), "\n".join(
        f"{key}: {found[key]}, was {asked.get(key)}" for key in found if not alike(found[key], asked.get(key))
    )


def alike(found: Any, asked: Any) -> bool:
    if isinstance(found, dict):
        return (
            isinstance(asked, dict) and found.keys() == asked.keys() and all(alike(found[k], asked[k]) for k in found)
        )
    if isinstance(found, list):
        return isinstance(asked, list) and len(found) == len(asked) and all(map(alike, found, asked))
    if isinstance(found, float):
        return bool(found == pytest.approx(asked, abs=TOLERANCE, rel=0, nan_ok=True))
    return bool(found == asked)
