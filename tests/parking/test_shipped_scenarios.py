"""The shipped scenarios of the parking system: each ends as it is meant to, within its own requirements.

``python -m tests.parking.test_shipped_scenarios`` prints all of them, and the share.
"""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import pytest

from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.session.drive import drive

SCENARIOS = Path(__file__).parents[2] / "orchestrator" / "library" / "scenarios"
NAMES = sorted(file.stem for kind in ("apa", "valet", "cicap") for file in SCENARIOS.glob(f"{kind}-*.yaml"))


class Ended(NamedTuple):
    """How a scenario is meant to end, how it ended, why, and whether anything was touched."""

    expected: str
    outcome: str
    reason: str
    contact: bool


def ended(name: str, folder: Path) -> Ended:
    """Return how a scenario ends."""
    scenario = load_scenario(name)
    ran = drive(scenario, "native", folder / f"{name}.mcap")
    summary = summarize(ran.recording, scenario, ran.wall_time)
    touched = bool(ran.recording.signals["vehicle.contact"].max() > 0)
    return Ended(str(scenario.expected_outcome), str(summary.outcome), str(summary.reason), touched)


def is_as_meant(found: Ended) -> bool:
    return found.outcome == found.expected and not found.contact


@pytest.mark.release  # tests/golden drives the same scenarios and compares their ends with the expected ones
@pytest.mark.parametrize("name", NAMES)
def test_it_ends_as_meant(name: str, tmp_path: Path) -> None:
    assert is_as_meant(ended(name, tmp_path)), ended(name, tmp_path)


def print_all() -> None:
    """Print how each scenario ends, and the share that ends as meant."""
    count = 0
    with TemporaryDirectory() as folder:
        for name in NAMES:
            found = ended(name, Path(folder))
            count += is_as_meant(found)
            print(f"{name:32} {'as meant' if is_as_meant(found) else 'NOT':9} {found}")
    print(f"{count} of {len(NAMES)} end as meant")


if __name__ == "__main__":
    print_all()
