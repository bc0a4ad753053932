"""The bake-off: the same slots for all, refusals that are right, slots that each controller parks in."""

import math
from pathlib import Path

import pytest

from controller_fmu.common.arc_line_arc import arc_line_arc, largest_radius
from controller_fmu.zhang2022.path import MAX_PATH_HEADING, PathStatus, plan, through
from modelkit.vocabulary import Pose
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.simulation.cosim.fmu_files import can_compile
from orchestrator.studies.bakeoff.claim import LIMITS, STEERING, SYSTEMS, Setting, rate_of, rates
from orchestrator.studies.bakeoff.claim import study as claim
from orchestrator.studies.bakeoff.drives import Drive, drives
from orchestrator.studies.bakeoff.entries import CONTROLLERS, SLOTS, entries, scenario_of
from orchestrator.studies.bakeoff.study import report, study_of
from orchestrator.studies.sweep.in_memory import columns_in_memory
from orchestrator.studies.sweep.study.cases import LabelledScenario
from orchestrator.studies.sweep.sweep import Options, sweep
from orchestrator.studies.sweep.table import Table

compiles = pytest.mark.skipif(not can_compile(), reason="needs a C compiler")
EVERY = list(entries())


def chosen(**labels: str | float) -> list[LabelledScenario]:
    return [case for case in EVERY if all(case.labels[key] == value for key, value in labels.items())]


def scenario(drive: Drive) -> Scenario:
    return scenario_of(drive.controller, drive.slot, drive.car, drive.body, drive.start, drive.disturbance)


@pytest.fixture(scope="module")
def undisturbed() -> list[Drive]:
    return drives(columns_in_memory(study_of(chosen(disturbance="none"))))


def test_all_have_the_same_slots() -> None:
    scenes: dict[tuple[float, str], set[tuple[float | int | bool, ...]]] = {}
    for case in EVERY:
        boxes = tuple(value for key, value in case.scenario.vehicle.items() if key.startswith("scene.boxes["))
        scenes.setdefault((float(case.labels["slot"]), str(case.labels["car"])), set()).add(boxes)
    assert len(scenes) == 6
    assert all(len(boxes) == 1 for boxes in scenes.values())
    assert len(EVERY) == len(CONTROLLERS) * 3 * 60


def smallest_peak(start: Pose, radius: float) -> float:
    """Return the least peak of the quintics [1/m] over 501 radii."""
    widest = largest_radius(start.x, start.y)
    low = min(radius, widest)
    arcs = [arc_line_arc(start.x, start.y, low + (widest - low) * n / 500) for n in range(501)]
    return min(
        through(start, arc).largest_curvature for arc in arcs if arc.line >= 0.0 and 0.0 < arc.angle < MAX_PATH_HEADING
    )


def test_quintics_are_refused_where_no_radius_keeps_the_curvature_and_only_there() -> None:
    verdicts = {}
    for labels, given in chosen(controller="zhang2022", disturbance="none", body="kinematic"):
        car = given.controller
        lock = car["car.steering.angle_limit"] / car["car.steering.ratio"]
        limit = 0.95 * math.tan(lock) / car["car.wheelbase"]
        start = Pose(*(float(given.vehicle[f"start.{axis}"]) for axis in ("x", "y", "heading")))
        possible = smallest_peak(start, 5.0) <= limit
        assert plan(start, 5.0, limit).status == (PathStatus.FOUND if possible else PathStatus.CURVATURE_LIMIT)
        verdicts[labels["slot"], labels["car"], labels["start"]] = possible
    assert [sum(verdicts[key] for key in verdicts if key[0] == slot) for slot in SLOTS] == [0, 4, 6]


@compiles
def test_refusals_are_those_of_the_planner(undisturbed: list[Drive]) -> None:
    refused = [item for item in undisturbed if item.controller == "zhang2022" and not item.parked]
    assert {item.why for item in refused} == {"no_path"}
    assert len(refused) == 2 * (6 + 2)


@compiles
def test_two_arcs_are_refused_where_their_radius_is_below_the_cars(undisturbed: list[Drive]) -> None:
    for item in undisturbed:
        if item.controller.startswith("ntbpt"):
            car, start = scenario(item).controller, scenario(item).vehicle
            smallest = (
                1.05 * car["car.wheelbase"] / math.tan(car["car.steering.angle_limit"] / car["car.steering.ratio"])
            )
            possible = largest_radius(start["start.x"], start["start.y"]) >= smallest
            assert (item.why == "no_path") != possible, item


@compiles
def test_every_controller_parks_from_every_start_in_the_longest_slot(undisturbed: list[Drive]) -> None:
    longest = [item for item in undisturbed if item.slot == max(SLOTS)]
    assert [item for item in longest if not item.parked] == []
    assert len(longest) == len(CONTROLLERS) * 12


@compiles
def test_point_tracking_parks_more_drivers_than_path_tracking_alone() -> None:
    found = rates(columns_in_memory(claim(200, 1)))
    by_group = {rate.group: rate for rate in found}
    assert len(by_group) == 2 * 2 * 2
    for steering in STEERING:
        for limit in LIMITS:
            ours, plain = (by_group[Setting(system, steering, limit)] for system in SYSTEMS)
            assert ours.low > plain.high
    assert rates(columns_in_memory(claim(20, 1))) == rates(columns_in_memory(claim(20, 1)))


def test_wilson_keeps_to_shares() -> None:
    group = Setting("ntbpt", "30 deg/s", "house")
    none, half = rate_of(group, 100, 0), rate_of(group, 100, 50)
    assert none.low == 0.0
    assert none.high == pytest.approx(0.0370, abs=1e-4)
    assert (half.low, half.high) == (pytest.approx(0.4038, abs=1e-4), pytest.approx(0.5962, abs=1e-4))


@compiles
def test_its_report_shows_table_and_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    swept = sweep(study_of(chosen(slot=7.7, car="guo2015", start="near")), tmp_path, Options())
    assert swept.table is not None
    assert swept.count == 50
    assert report(Table(swept.table), tmp_path) == 0
    said = capsys.readouterr().out
    assert "100 %" in next(line for line in said.splitlines() if "zhang2022" in line)
    assert (tmp_path / "bakeoff.png").stat().st_size > 20_000
