"""The shipped scenarios of `apa` and with known goals, driven by this system: which of them end as they are meant to.

``python -m tests.parking.test_shipped_scenarios`` prints all of them, and the share.
"""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import pytest

from controller_fmu.parking.params import ParkingParams, ParkingSystem
from modelkit.variables import variables
from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.requirements import Requirement, library_requirements
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.session.drive import drive

SCENARIOS = Path(__file__).parents[2] / "orchestrator" / "library" / "scenarios"
NAMES = sorted(file.stem for kind in ("apa", "valet", "cicap") for file in SCENARIOS.glob(f"{kind}-*.yaml"))
OTHERWISE = frozenset(
    {
        "apa-slot-too-short",
    }
)
"""Those that do not end as they are meant to: they need what the system does not have yet, or go wrong."""
ENDS_DIFFERENTLY = {"apa-external-slot-nose-in": "parked"}
"""What the system can do and `apa` cannot."""
SAME = {"apa.drive.longitudinal": "drive.longitudinal", "apa.search.wish": "slot.wanted"}
"""Parameters of `apa` that this system has at another place."""
AS_MEANT = tuple(name for name in NAMES if name not in OTHERWISE)


class Ended(NamedTuple):
    """How a scenario is meant to end, how it ended, why, and whether anything was touched."""

    expected: str
    outcome: str
    reason: str
    contact: bool


def of_standard(scenario: Scenario) -> list[Requirement]:
    """Return the requirements of a scenario that is meant to end otherwise than parked, as far as GB/T has them."""
    meant = scenario.expected_outcome == "not_parked"
    return [item for item in scenario.requirements if meant and item.source == "GB/T 41630"]


def ended(name: str, folder: Path) -> Ended:
    """Return how a scenario ends with this system instead of its own."""
    scenario = load_scenario(name)
    known = {variable.name for variable in variables(ParkingParams)}
    named = {SAME.get(key, key): value for key, value in scenario.controller.items()}
    kept = {key: value for key, value in named.items() if key in known}
    parked = scenario.expected_outcome in ("parked", "finished")
    update = {
        "controller": {**kept, "system": int(ParkingSystem.PARKING)},
        "requirements": [*library_requirements("valet-slot" if parked else "no-contact"), *of_standard(scenario)],
    }
    scenario = scenario.model_copy(update=update)
    try:
        if scenario.expected_outcome == "finished":
            scenario = scenario.model_copy(update={"requirements": [*library_requirements("no-contact")]})
        ran = drive(scenario, "native", folder / f"{name}.mcap")
    except BadInput as error:
        return Ended(str(scenario.expected_outcome), "not possible", str(error), False)
    summary = summarize(ran.recording, scenario, ran.wall_time)
    touched = bool(ran.recording.signals["vehicle.contact"].max() > 0)
    return Ended(
        ENDS_DIFFERENTLY.get(name, str(scenario.expected_outcome)), str(summary.outcome), str(summary.reason), touched
    )


def is_as_meant(found: Ended) -> bool:
    return found.outcome == found.expected and not found.contact


@pytest.mark.slow
@pytest.mark.parametrize("name", AS_MEANT)
def test_it_ends_as_meant(name: str, tmp_path: Path) -> None:
    assert is_as_meant(ended(name, tmp_path)), ended(name, tmp_path)


def test_the_list_names_shipped_scenarios() -> None:
    assert set(NAMES) >= OTHERWISE


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
