"""Other cars than the one a scenario is written for: the assist parks them, or the slot is too small."""

from typing import Any

import pytest

from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.files import car_names
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import can_compile, fmu_files
from tests.orchestrator.parked_cars import GEOMETRIC, lacking, park, parking_scenarios

pytestmark = pytest.mark.skipif(not can_compile(), reason="FMUs without Python need a C compiler: pip install ziglang")


def ended(name: str, *sets: str) -> tuple[str, str]:
    scenario = load_scenario(name, [*sets])
    ran = run_scenario(scenario, fmu_files("native", lambda text: None), kind="native")
    summary = summarize(ran.recording, scenario, ran.wall_time)
    return summary.outcome, summary.reason


OPEN = {
    ("apa-driver-drives", "commonroad2"): "no_path in a slot that has one",
    ("apa-parallel-real", "commonroad2"): "no_path in a slot that has one",
    ("apa-parallel-tight", "commonroad1"): "left_path instead of a reason of the slot",
    ("apa-pedestrian", "preview"): "blocked, though the pedestrian has gone",
}
"""Scenario and car that do not end as they should -> how they end; each is to be taken out once it does."""


def pairs() -> list[Any]:
    """Return each scenario with each car: on each change each car in one or two of them, else ``make release``."""
    cars = car_names()
    return [
        pytest.param(name, car, marks=marks_of(name, car, (number - place) % 10 == 0), id=f"{name}-{car}")
        for number, name in enumerate(parking_scenarios())
        for place, car in enumerate(cars)
    ]


def marks_of(name: str, car: str, is_each: bool) -> list[pytest.MarkDecorator]:
    """Return the marks of a pair, which runs on each change or in ``make release``."""
    marks = [] if is_each else [pytest.mark.release]
    return [*marks, *([pytest.mark.xfail(strict=True, reason=OPEN[name, car])] if (name, car) in OPEN else [])]


@pytest.mark.parametrize(("name", "car"), pairs())
def test_a_car_that_fits_parks_and_another_is_refused_for_its_size(name: str, car: str) -> None:
    """Every car in every parking scenario, as docs/parking-use.md states."""
    found = park(name, car, fmu_files("native", lambda text: None))
    assert found.nearest > 0.0, "contact"
    if not found.lacks:
        assert found.outcome == "parked", found
    elif found.outcome != "parked":
        assert found.reason in GEOMETRIC or "outline in the slot" in found.reason, found


def test_all_cars_but_the_widest_fit_somewhere_and_most_do_not_everywhere() -> None:
    lacks = {car: [lacking(load_scenario(name, [f"car={car}"])) for name in parking_scenarios()] for car in car_names()}
    assert {car for car, found in lacks.items() if "" not in found} <= {"tpcap"}, "1.94 m wide"
    assert lacks["guo2015"] == [""] * len(parking_scenarios())
    assert lacking(load_scenario("apa-parallel-tight", ["car=zhang2022"])) == "4.85 m long, 5.54 m required"
    assert lacking(load_scenario("apa-perpendicular", ["car=zhang2022"])) == "4.20 m deep, 4.44 m required"


@pytest.mark.parametrize(
    ("name", "cycle"),
    [(name, cycle) for name in ("apa-parallel", "apa-perpendicular") for cycle in (0.02, 0.06, 0.1)],
)
def test_slower_sensors_are_the_cars_and_the_assist_knows_it(name: str, cycle: float) -> None:
    assert ended(name, f"car.ultrasonic.cycle={cycle}") == ("parked", "all checks passed")


def test_an_assist_that_believes_in_sensors_twice_as_quick_parks_all_the_same() -> None:
    assert ended("apa-parallel", "vehicle.car.ultrasonic.cycle=0.08") == ("parked", "all checks passed")


def test_with_sensors_two_and_a_half_times_as_slow_as_believed_it_parks_within_the_standard() -> None:
    limits = "requirements=[gbt41630, no-contact]"
    assert ended("apa-parallel", "vehicle.car.ultrasonic.cycle=0.1", limits) == ("parked", "all checks passed")


def test_an_assist_that_believes_in_a_smaller_car_is_a_study() -> None:
    outcome, _ = ended("apa-parallel-walls", "vehicle.car.width=2.2")
    assert outcome != "parked"


@pytest.mark.parametrize("of", ["rear_axle", "front", "rear", "left", "right", "middle"])
def test_a_target_by_a_point_of_the_outline(of: str) -> None:
    own = load_scenario(
        "apa-perpendicular",
        ["car=zhang2022", "target={x: 1.0, y: 2.0, heading: 90 deg}", f"target.reference_point={of}"],
    )
    assert own.target is not None
    x, y, heading = own.target.pose
    ahead = {"front": 3.586, "rear": -0.85, "rear_axle": 0.0}.get(of, 1.368)
    left = {"left": 0.91, "right": -0.91}.get(of, 0.0)
    assert (x - left, y + ahead, heading) == pytest.approx((1.0, 2.0, 1.5707963), abs=1e-6)
