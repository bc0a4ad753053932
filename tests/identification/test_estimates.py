"""Identification of cars whose parameters are known: intervals that hold, and names of what a log does not tell."""

from collections.abc import Iterable

import numpy as np
import pytest

from orchestrator.inputs.text.errors import BadInput
from orchestrator.studies.identification.compiled_vehicle import CompiledVehicle
from orchestrator.studies.identification.estimate import correlation_time
from orchestrator.studies.identification.identify import identify
from orchestrator.studies.identification.parameter import GEOMETRY, ODOMETRY
from orchestrator.studies.identification.playback import dead_time_resolution
from orchestrator.studies.identification.result import Identification, as_json, sentence
from orchestrator.studies.identification.signals import MeasuredDrive, Series, drive_of
from tests.identification.drives import CAR, STEP, measurements_only, pair, random_drive, simulated_log

PAIRS, COVERAGE = 20, 0.9


@pytest.fixture(scope="module")
def vehicle() -> CompiledVehicle:
    return CompiledVehicle()


def covered(found: Identification, true: dict[str, float]) -> list[bool]:
    """Return for each identified parameter whether its interval has the true value."""
    return [
        item.interval[0] <= true[item.candidate.name] <= item.interval[1]
        for item in found.parameters
        if item.identified
    ]


def check_coverage(seeds: Iterable[int], vehicle: CompiledVehicle, least: int) -> None:
    """Require that nine of ten intervals have the true value, and that what has no interval is named."""
    inside, count = 0, 0
    for seed in seeds:
        drawn = pair(seed, vehicle)
        found = identify(drawn.drive, drawn.known, drawn.names, vehicle)
        held = covered(found, drawn.true)
        inside, count = inside + sum(held), count + len(held)
        unnamed = {item.candidate.name for item in found.parameters if not item.identified}
        assert unnamed == {name for group in found.identifiability.undetermined for name in group.names}
    assert count >= least
    assert inside >= COVERAGE * count


def test_intervals_hold_for_some_cars_and_drives(vehicle: CompiledVehicle) -> None:
    check_coverage((1, 3, 4), vehicle, 12)


@pytest.mark.release
def test_intervals_hold_for_random_cars_and_drives(vehicle: CompiledVehicle) -> None:
    check_coverage(range(PAIRS), vehicle, 3 * PAIRS)


def gentle(vehicle: CompiledVehicle, car: dict[str, float] = CAR) -> MeasuredDrive:
    """Return measurements of a drive that turns the wheel little: tan is straight there."""
    random = np.random.default_rng(47)
    log = simulated_log(car, random_drive(random, largest=2.0, longest=20.0), random, vehicle)
    return drive_of(measurements_only(log, car), "log")


def test_ratio_and_wheelbase_of_small_angles_are_named_and_have_no_value(vehicle: CompiledVehicle) -> None:
    found = identify(gentle(vehicle), {}, [*GEOMETRY, "drive.drive_lag", *ODOMETRY], vehicle)
    together, alone = found.identifiability.undetermined
    assert set(together.names) >= set(GEOMETRY)
    assert "full lock" in together.manoeuvre
    assert alone.names == ("drive.drive_lag",)
    assert alone.is_without_effect
    assert "no effect" in sentence(alone)
    rows = {row["name"]: row for row in as_json(found)["parameters"]}
    assert all(rows[name]["value"] is None for name in (*GEOMETRY, "drive.drive_lag"))
    assert rows["odometry.radius_error"]["low"] <= 0.01 <= rows["odometry.radius_error"]["high"]
    assert found.identifiability.singular_values[-1] < 1e-3


def test_a_known_wheelbase_makes_the_ratio_identifiable(vehicle: CompiledVehicle) -> None:
    found = identify(gentle(vehicle), {"car.wheelbase": 2.62}, ["car.steering.ratio", *ODOMETRY], vehicle)
    assert covered(found, CAR) == [True] * 3


def test_the_proposed_manoeuvre_identifies_what_was_not(vehicle: CompiledVehicle) -> None:
    random = np.random.default_rng(48)
    lock = 570.0 * np.pi / 180.0
    angle = np.concatenate([np.full(int(20 / STEP), share * lock) for share in (1.0, 0.33, -0.33, -1.0)])
    speed = np.full(len(angle), 1.0)
    angle[:50], speed[:250] = 0.0, 0.0
    log = measurements_only(simulated_log(CAR, (angle, speed), random, vehicle), CAR)
    found = identify(drive_of(log, "log"), {}, [*GEOMETRY, *ODOMETRY], vehicle)
    assert covered(found, CAR) == [True] * 4


def test_a_log_that_begins_in_motion_is_met(vehicle: CompiledVehicle) -> None:
    random = np.random.default_rng(49)
    log = measurements_only(simulated_log(CAR, random_drive(random), random, vehicle), CAR)
    later = {name: Series(item.t[700:2700], item.values[700:2700], item.column) for name, item in log.items()}
    assert abs(later["measured_speed"].values[0]) > 0.1
    found = identify(drive_of(later, "log"), {"car.wheelbase": 2.62}, ["car.steering.ratio", *ODOMETRY], vehicle)
    assert covered(found, CAR) == [True] * 3


def test_the_dead_time_of_the_vehicle_has_the_resolution_of_its_line() -> None:
    assert dead_time_resolution(0.16) == pytest.approx(0.0075)


def test_correlated_residuals_count_less() -> None:
    noise = np.random.default_rng(1).normal(size=20_000)
    assert correlation_time(noise) < 1.1
    assert correlation_time(np.convolve(noise, np.ones(10) / 10, "valid")) == pytest.approx(10.0, rel=0.2)


def test_an_actuator_without_its_request_is_refused(vehicle: CompiledVehicle) -> None:
    with pytest.raises(BadInput, match=r"steering\.lag: the log has no steering_wheel_request"):
        identify(gentle(vehicle), {}, ["steering.lag"], vehicle)


def test_a_body_with_mass_needs_its_speed_request(vehicle: CompiledVehicle) -> None:
    with pytest.raises(BadInput, match="needs its speed_request"):
        identify(gentle(vehicle), {"body": 2.0}, ["car.steering.ratio"], vehicle)
