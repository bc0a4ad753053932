"""No range of a parameter refuses what a shipped scenario, car, study, bake-off or grid uses."""

from functools import cache
from typing import Any

import pytest

from controller_fmu import MODEL as CONTROLLER
from fmus.contents.variables import fmi_variables, limits
from modelkit.model import Model
from modelkit.signal import Group, Role, Signal
from modelkit.variables import limits_of, variables
from orchestrator.inputs.scenario.files import car_names, library_names
from orchestrator.inputs.scenario.load_scenario import load_scenario, scenario_names
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.studies.bakeoff.entries import entries
from orchestrator.studies.parking.cases import cases, scenario_of
from orchestrator.studies.sweep.study.sampling import make_design
from orchestrator.studies.sweep.study.study_file import load_study
from vehicle_fmu import MODEL as VEHICLE


def ranges(models: Any) -> Any:
    return {
        f"{owner}.{item.name}": limits(item)
        for owner, model in models.items()
        for item in fmi_variables(model)
        if item.causality == "parameter"
    }


KNOWN = ranges({"vehicle": VEHICLE, "controller": CONTROLLER})


@cache
def ranges_beside_vehicle(controller: Model) -> Any:
    return ranges({"vehicle": VEHICLE, "controller": controller})


def outside(owner: Any, values: Any, known: Any = KNOWN) -> Any:
    """Return the names of the parameters that are not within their range."""
    found = []
    for name, value in values.items():
        low, high = known[f"{owner}.{name}"]
        if (low is not None and value < low) or (high is not None and value > high):
            found.append((f"{owner}.{name}", value, low, high))
    return found


def outside_of(scenario: Any) -> Any:
    known = KNOWN if scenario.models == MODELS else ranges_beside_vehicle(scenario.models["controller"])
    return outside("vehicle", scenario.vehicle, known) + outside("controller", scenario.controller, known)


@pytest.mark.parametrize("name", scenario_names())
def test_scenarios(name: Any) -> None:
    assert outside_of(load_scenario(name, [])) == []


@pytest.mark.parametrize("name", car_names())
def test_cars(name: Any) -> None:
    assert outside_of(load_scenario("guo2015-case4", [f"car={name}"])) == []


@pytest.mark.parametrize("name", library_names("studies"))
def test_studies(name: Any) -> None:
    study, _ = load_study(name)
    design = make_design(study, load_scenario(study.scenario, []))
    assert len(design.values) > 0
    for field, column in zip(design.fields, design.values.T, strict=True):
        if field.key in KNOWN:
            owner, _, name = field.key.partition(".")
            assert outside(owner, {name: column.min()}) + outside(owner, {name: column.max()}) == []


def test_bake_off() -> None:
    assert [item for entry in entries() for item in outside_of(entry.scenario)] == []


def test_grid_of_the_parking_system() -> None:
    for case in cases():
        assert outside_of(scenario_of(case)) == []


def test_coordinates_of_a_map_are_in_range() -> None:
    """UTM: up to 834 km east, 10,000 km north."""
    map_place = {"start.x": 834e3, "start.y": 1e7, "scene.boxes[1].x": 834e3, "scene.kerbs[1].y2": 1e7}
    assert outside("vehicle", map_place) == []
    assert outside("controller", {"target.x": 834e3, "target.y": 1e7}) == []
    assert outside("vehicle", {"driver.takeover_time": 1e9, "scene.boxes[3].disappear_at": 1e9}) == []


# How a type declares it


def test_a_group_says_what_it_is_and_the_range_of_fields_that_have_none() -> None:
    start = {item.name: item.signal for item in variables(VEHICLE.params) if item.name.startswith("start.")}
    assert start["start.x"] == Signal("m", "rear-axle midpoint at time zero: x", -1e8, 1e8)
    assert start["start.heading"].high == 100.0
    pose = next(item.signal for item in variables(VEHICLE.outputs) if item.name == "pose.x")
    assert (pose.text, limits_of(pose)) == ("rear-axle midpoint: x", (float("-inf"), float("inf")))
    assert Group("g").limits == ()


def test_the_role_next_to_a_field_wins() -> None:
    roles = {item.name: item.roles for item in variables(CONTROLLER.params)}
    assert roles["guo2015.k1"] == {Role.TUNABLE}
    assert roles["guo2015.radius"] == {Role.FIXED}
    assert roles["car.wheelbase"] == frozenset()
    outputs = {item.name: item.roles for item in variables(CONTROLLER.outputs)}
    assert outputs["path.segments[3].length"] == {Role.LOCAL}
    assert outputs["phase"] == frozenset()
