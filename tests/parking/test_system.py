"""The whole system in closed loop: it parks where the others do, and in an empty bay of a car park."""

import math
from pathlib import Path
from typing import Any

import pytest
import yaml

from controller_fmu.common.chart import bit
from controller_fmu.interface import Reason
from controller_fmu.parking.chart import Condition, ParkingState
from controller_fmu.parking.following.path_tracking import PathProgress
from controller_fmu.parking.map.local_map import LandmarkMap
from controller_fmu.parking.measurement.sensor import MAX_SENSORS
from controller_fmu.parking.measurement.silent_sensor import MISSED_ECHOES, MissedEchoes
from controller_fmu.parking.monitor.collision_monitor import MonitorVerdict
from controller_fmu.parking.monitor.fault_monitor import FaultClocks
from controller_fmu.parking.params import ParkingParams
from controller_fmu.parking.planning.work import PlanningWork
from controller_fmu.parking.signals import ParkingSystemInput
from controller_fmu.parking.state import ParkingMemory, Perception
from controller_fmu.parking.system import conditions_of, parking_sample
from modelkit.store import new_store
from modelkit.vocabulary import Pose
from orchestrator.cli import main

SCENARIOS = Path(__file__).parents[2] / "orchestrator" / "library" / "scenarios"


def as_parking(name: str, folder: Path, **changes: Any) -> str:
    """Return a file with a shipped scenario, driven by this system."""
    scenario = yaml.safe_load((SCENARIOS / f"{name}.yaml").read_text(encoding="utf-8"))
    scenario |= {"name": "trial", "controller": {"system": "apa"}, "requirements": ["valet-slot"], **changes}
    file = folder / "trial.yaml"
    file.write_text(yaml.safe_dump(scenario), encoding="utf-8")
    return str(file)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["apa-perpendicular-real", "apa-perpendicular-left", "apa-parallel-real"])
def test_it_parks(name: str, tmp_path: Path) -> None:
    file = as_parking(name, tmp_path)
    assert main(["test", file, "--fmus", "native", "--out", str(tmp_path / "out")]) == 0


@pytest.mark.slow
def test_it_parks_in_the_empty_bay_of_a_car_park(tmp_path: Path) -> None:
    """Bays of 2.7 m with cars of 1.8 m, two beyond each neighbour: `apa` takes three cars for one and drives by."""
    cars = [{"x": 1.8 + 2.7 * bay, "y": -2.25, "length": 1.8, "width": 4.5} for bay in (-3, -2, -1, 1, 2, 3)]
    file = as_parking(
        "apa-perpendicular-real",
        tmp_path,
        scene={"boxes": cars},
        target={"reference_point": "front", "x": 1.8, "y": 0.0, "heading": math.pi / 2},
        slot={"x": 1.8, "y": -2.3, "heading": math.pi / 2, "length": 4.6, "width": 3.6},
    )
    assert main(["test", file, "--fmus", "native", "--out", str(tmp_path / "out")]) == 0


@pytest.mark.parametrize(
    ("silent", "gives_up"),
    [({1}, False), ({1, 2}, True), ({0, 2, 5, 7, 8, 10}, False), ({3, 4}, False), ({7, 8}, False), ({9, 10}, False)]
    + [({8, 9}, True), ({10, 11}, True), ({4, 5}, True)],
)
def test_it_gives_up_where_two_sensors_beside_each_other_are_silent(silent: set[int], gives_up: bool) -> None:
    missed = MissedEchoes(tuple(MISSED_ECHOES if number in silent else 0 for number in range(MAX_SENSORS)))
    memory = ParkingMemory(state=ParkingState.DRIVING, perception=Perception(local_map=LandmarkMap(missed=missed)))
    inputs = ParkingSystemInput(apa_switch=True, measured_speed=0.3)
    after = parking_sample(new_store(PlanningWork), memory, inputs, ParkingParams(), 1_000_000)
    assert (after.state == ParkingState.FAILED) == gives_up
    assert after.reason == (Reason.SENSOR_LOSS if gives_up else Reason.NONE)


@pytest.mark.parametrize("obstructed", [False, True])
def test_after_a_wait_it_plans_again_only_where_the_path_is_obstructed(obstructed: bool) -> None:
    memory = ParkingMemory(
        state=ParkingState.STOPPING,
        progress=PathProgress(remaining=1.0, manoeuvres=1),
        verdict=MonitorVerdict(free_distance=0.05, is_blocked=True, is_mapped=True) if obstructed else MonitorVerdict(),
        clocks=FaultClocks(blocked=2_000_000_000),
    )
    conditions = conditions_of(memory, ParkingSystemInput(odometry=Pose(3.0, 2.0, 1.2)), ParkingParams())
    assert bool(conditions & bit(Condition.REPLAN, True)) == obstructed
