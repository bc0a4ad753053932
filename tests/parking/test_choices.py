"""What a user requests beside a search, and every way to end otherwise than parked: shipped scenarios, driven."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from controller_fmu.interface import Reason
from controller_fmu.parking.chart import ParkingState
from modelkit.car import Car
from modelkit.vocabulary import Prompt
from orchestrator.evaluation.verdict.summary import Summary, summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import can_compile, fmu_files
from orchestrator.simulation.cosim.recording import Recording

pytestmark = pytest.mark.skipif(not can_compile(), reason="FMUs without Python need a C compiler: pip install ziglang")
PERSON = ["vehicle.scene.boxes[4].x=2.25", "vehicle.scene.boxes[4].y=-0.65", "vehicle.scene.boxes[4].length=0.5"]
PERSON += ["vehicle.scene.boxes[4].width=0.5", "vehicle.scene.boxes[4].appear_at=14"]


@pytest.fixture(scope="module")
def files() -> Any:
    return fmu_files("native", lambda text: None)


def driven(name: str, files: Any, *sets: str) -> tuple[Recording, Summary]:
    scenario = load_scenario(name, list(sets))
    ran = run_scenario(scenario, files, kind="native")
    return ran.recording, summarize(ran.recording, scenario, ran.wall_time)


def last(recording: Recording, signal: str) -> float:
    return float(recording.signals[signal][-1])


def test_without_the_external_slot_nothing_is_found(files: Any, tmp_path: Path) -> None:
    changed = tmp_path / "changed.yaml"
    faults = "faults: [{signal: controller.external_slot.kind, kind: override, value: none}]"
    changed.write_text(f"name: changed\nextends: apa-external-slot\nstop_time: 25\n{faults}\n", encoding="utf-8")
    recording, _ = driven(str(changed), files)
    assert not (recording.signals["controller.apa.state"] == ParkingState.CONFIRMING).any()


@pytest.mark.parametrize("name", ["apa-pull-out", "apa-pull-out-right"])
def test_the_car_is_handed_over_on_the_road(name: str, files: Any) -> None:
    recording, summary = driven(name, files)
    assert summary.outcome == "finished"
    front = recording.signals["vehicle.pose.y"] + Car().wheelbase * np.sin(recording.signals["vehicle.pose.heading"])
    assert abs(front[-1] - front[0]) > 0.6
    assert last(recording, "controller.prompt") == Prompt.TAKE_OVER


@pytest.mark.parametrize("ahead", [6.65, 6.8])
def test_a_neighbour_that_protrudes_more_than_is_taken_is_not_touched(ahead: float, files: Any) -> None:
    """Its corner is 0.1 m nearer to the road than the map takes it, and was passed at 0.9 m/s."""
    recording, summary = driven("apa-pull-out-right", files, f"vehicle.scene.boxes[2].x={ahead}")
    assert min(recording.signals["vehicle.clearance"]) > 0.03
    assert summary.outcome == "finished"


def test_both_slots_are_offered_and_the_one_chosen_is_shown(files: Any) -> None:
    recording, _ = driven("apa-choose", files)
    signals = recording.signals
    shows = signals["controller.apa.state"] == ParkingState.CONFIRMING
    assert set(signals["controller.apa.shown"][shows]) == {1, 2}
    sides = {number: set(signals[f"controller.apa.offered[{number}].side"][shows]) for number in (1, 2)}
    assert sides == {1: {-1}, 2: {1}}
    assert set(signals["controller.apa.offered[3].type"][shows]) == {0}


def test_the_driver_resumes_without_a_new_search(files: Any) -> None:
    recording, summary = driven("apa-resume", files)
    later = recording.t > 50.0
    assert not (recording.signals["controller.apa.state"][later] == ParkingState.SEARCHING).any()
    assert summary.outcome == "parked"


def test_the_left_is_the_mirror_image_of_the_right(files: Any) -> None:
    ends = []
    for name in ("apa-perpendicular", "apa-perpendicular-left"):
        recording, _ = driven(name, files)
        ends.append([last(recording, f"vehicle.pose.{axis}") for axis in ("x", "y", "heading")])
    right, left = ends
    assert [left[0], -left[1], -left[2]] == pytest.approx(right, abs=0.01)


@pytest.mark.parametrize(
    "takeover",
    [
        ["driver.takeover_time=14"],
        ["driver.brake_time=14"],
        ["driver.steering_override_time=14", "driver.steering_override_angle=9 rad"],
    ],
)
def test_the_driver_takes_over_at_any_time(takeover: list[str], files: Any) -> None:
    recording, _ = driven("apa-parallel", files, *(f"vehicle.{item}" for item in takeover))
    assert last(recording, "controller.apa.state") == ParkingState.TAKEOVER
    assert last(recording, "controller.reason") == Reason.NONE
    assert last(recording, "controller.steering_active") == 0.0
    assert recording.t[-1] < 18.0


@pytest.mark.parametrize(
    ("sets", "reason"),
    [
        (["controller.limit.duration=8"], Reason.TIMEOUT),
        (["vehicle.car.steering.rate_limit=0.02"], Reason.STEERING_FAULT),
        (["controller.limit.manoeuvres=1"], Reason.NO_PATH),
        ([*PERSON], Reason.BLOCKED),
    ],
)
def test_every_failure_has_its_reason(sets: list[str], reason: Reason, files: Any) -> None:
    recording, _ = driven("apa-parallel", files, *sets)
    assert last(recording, "controller.apa.state") == ParkingState.FAILED
    assert last(recording, "controller.reason") == reason
    assert recording.signals["vehicle.clearance"].min() > 0.0


def test_a_person_who_goes_away_again_is_waited_for(files: Any) -> None:
    recording, summary = driven("apa-pedestrian", files)
    assert summary.outcome == "parked"
    assert recording.signals["vehicle.clearance"].min() > 0.1
