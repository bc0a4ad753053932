"""What an importer reads in the description: few ports, true dependencies, ranges, types, what may change when."""

import random
import re
from enum import IntEnum
from typing import Any
from xml.etree import ElementTree

import pytest
import toy_model

from controller_fmu import APA, SYSTEM_MODELS
from controller_fmu import MODEL as CONTROLLER
from controller_fmu.registry import System
from fmus.contents.dependencies import find_dependencies, initial_dependencies
from fmus.contents.description import model_description
from fmus.contents.variables import fmi_variables, limits, mode_types
from modelkit.model import Variant
from modelkit.variables import constructor, flatten, variables
from vehicle_fmu import MODEL as VEHICLE

MODELS = (toy_model.MODEL, VEHICLE, CONTROLLER, *SYSTEM_MODELS.values())
PORTS = [
    *("steering_wheel_request", "steering_active", "prompt", "advised_speed", "speed_control_active", "speed_request"),
    *("force_control_active", "force_request", "brake_request"),
    *("phase", "reason"),
]
PORTS_OF_PARKING = [
    *PORTS,
    "apa.state",
    *(f"apa.offered[{n}].{name}" for n in (1, 2, 3) for name in ("type", "side", "ax", "ay", "bx", "by", "depth")),
    *("apa.alarm", "apa.shown"),
]
FROM_OUTSIDE = ("external_slot.", "driver_selection.")
"""Inputs that a driver's display, a camera, a map or a test bench feeds, not the vehicle."""
everywhere = pytest.mark.parametrize("model", MODELS, ids=lambda model: model.name)


def xml(model: Any) -> Any:
    return model_description(model, guid="", generation_tool="", flags={})


def by_name(model: Any) -> Any:
    return {item.name: item for item in fmi_variables(model)}


@pytest.mark.parametrize(("model", "ports"), [(CONTROLLER, PORTS), (APA, PORTS_OF_PARKING)])
def test_a_block_of_the_controller_has_the_ports_it_needs(model: Any, ports: list[str]) -> None:
    outputs = [item.name for item in fmi_variables(model) if item.causality == "output"]
    assert outputs == ports
    inputs = {item.name for item in fmi_variables(VEHICLE) if item.causality == "input"}
    assert {name for name in inputs if not name.startswith("manual.")} < set(outputs)
    wanted = {item.name for item in fmi_variables(model) if item.causality == "input"}
    reported = {item.name for item in fmi_variables(VEHICLE) if item.causality == "output"}
    assert {name for name in wanted if not name.startswith(FROM_OUTSIDE)} < reported


def test_what_is_calculated_is_output_or_local_and_nothing_is_lost() -> None:
    known = by_name(CONTROLLER)
    for item in variables(CONTROLLER.outputs):
        assert known[item.name].causality == ("output" if item.name in PORTS else "local")
        assert known[item.name].initial == "calculated"


@pytest.mark.parametrize(
    ("model", "name", "variability"),
    [
        (CONTROLLER, "steering_wheel_request", "discrete"),
        (CONTROLLER, "lateral_error", "discrete"),
        (CONTROLLER, "phase", "discrete"),
        (CONTROLLER, "odometry.x", "continuous"),
        (APA, "gear", "discrete"),
        (CONTROLLER, "guo2015.k1", "tunable"),
        (CONTROLLER, "guo2015.radius", "fixed"),
        (CONTROLLER, "guo2015.threshold.park_lateral", "tunable"),
        (CONTROLLER, "system", "fixed"),
        (CONTROLLER, "car.wheelbase", "fixed"),
        (CONTROLLER, "target.x", "fixed"),
        (APA, "drive.longitudinal", "fixed"),
        (APA, "drive.k1", "tunable"),
        (VEHICLE, "pose.x", "continuous"),
        (VEHICLE, "ultrasonic[7]", "discrete"),
        (VEHICLE, "contact", "discrete"),
        (VEHICLE, "car.steering.rate_limit", "tunable"),
        (VEHICLE, "car.steering.ratio", "fixed"),
        (VEHICLE, "road.grip[1]", "tunable"),
        (VEHICLE, "scene.boxes[1].x", "fixed"),
        (VEHICLE, "driver.profile[1].speed", "fixed"),
    ],
)
def test_variability(model: Any, name: Any, variability: Any) -> None:
    assert by_name(model)[name].variability == variability


@everywhere
def test_every_numeric_parameter_has_a_range(model: Any) -> None:
    missing = [
        item.name
        for item in fmi_variables(model)
        if item.causality == "parameter" and item.kind is not bool and None in limits(item)
    ]
    assert missing == ([] if model is not toy_model.MODEL else [name for name in missing if name.startswith("drift")])


@everywhere
def test_every_mode_has_a_declared_type_with_the_names_of_its_states(model: Any) -> None:
    root: Any = ElementTree.fromstring(xml(model))
    types = {node.get("name"): node for node in root.find("TypeDefinitions")}
    names = mode_types(model)
    assert len(set(names.values())) == len(names)
    assert not set(types) & {item.name for item in fmi_variables(model)}
    shown = {node.get("name"): node for node in root.find("ModelVariables")}
    for item in fmi_variables(model):
        mode = item.signal.states
        if mode is None or not item.is_exposed:
            continue
        number = shown[item.name].find("Integer")
        kind = types[number.get("declaredType")]
        assert kind.find("Integer").attrib == {
            "quantity": names[mode],
            "min": str(int(min(mode))),
            "max": str(int(max(mode))),
        }
        for state in mode:
            assert f"{state.value} {state.name}" in kind.get("description")
        assert number.get("min") == kind.find("Integer").get("min")


def test_two_modes_of_one_name_are_told_apart() -> None:
    Mode = IntEnum("Mode", {"OFF": 0, "ON": 1}, module="engine.model")
    model = toy_model.MODEL._replace(view=Variant(states=(("mode", Mode),)))
    assert set(mode_types(toy_model.MODEL).values()) == {"Mode"}
    assert set(mode_types(model).values()) == {"toy_model.Mode", "engine.Mode"}


# Initial dependencies


def indexed(model: Any) -> Any:
    """Return (output, its dependencies) of the description, by name."""
    root: Any = ElementTree.fromstring(xml(model))
    names = [node.get("name") for node in root.find("ModelVariables")]
    return {
        names[int(node.get("index")) - 1]: {names[int(place) - 1] for place in node.get("dependencies").split()}
        for node in root.find("ModelStructure").find("InitialUnknowns")
    }


def test_dependencies_of_a_small_model_are_those_its_source_has() -> None:
    found = initial_dependencies(toy_model.MODEL)
    start = {f"start[{number}].{field}" for number in (1, 2) for field in ("position", "velocity")}
    drift = {f"drift[{number}].{field}" for number in (1, 2, 3) for field in ("position", "velocity")}
    assert set(found["oscillators[2].velocity"]) >= start
    assert set(found["drifted.position"]) >= drift
    assert not set(found["drifted.position"]) & start
    assert found["angle"] == found["mode"] == found["pull"] == []
    assert not {"stiffness", "mass", "seed"} & {name for names in found.values() for name in names}


@pytest.mark.parametrize(("model", "most"), [(VEHICLE, 3600), (CONTROLLER, 60)], ids=["Vehicle", "Controller"])
def test_few_dependencies_take_a_small_part_of_the_description(model: Any, most: Any) -> None:
    found = indexed(model)
    assert 0 < sum(map(len, found.values())) < most
    assert {name: set(names) for name, names in initial_dependencies(model).items() if name in found} == found
    content = xml(model).decode()
    structure = content[content.index("<ModelStructure>") :]
    assert len(structure) < 0.15 * len(content)


@pytest.mark.parametrize("model", [VEHICLE, CONTROLLER, SYSTEM_MODELS[System.HSIC]], ids=lambda model: model.name)
def test_what_changes_an_output_at_the_start_is_named(model: Any) -> None:
    """Points and moves of its own, drawn otherwise than by the search."""
    draw = random.Random(99)
    named = indexed(model)
    known = variables(model.params, model.first_params())
    make = constructor(model.params)
    free = [place for place, item in enumerate(known) if model.shows(item.name)]
    names = [item.name for item in variables(model.outputs)]

    def start(values: Any) -> Any:
        return dict(zip(names, flatten(model.initialize(make(values))[1]), strict=True))

    seen = set()
    for _ in range(150):
        point = [item.start for item in known]
        for place in draw.sample(free, len(free) // 3):
            point[place] = drawn(draw, known[place], point[place])
        before = start(point)
        for place in draw.sample(free, 20):
            moved = list(point)
            moved[place] = drawn(draw, known[place], point[place])
            after = start(moved)
            seen |= {(name, known[place].name) for name in named if after[name] != before[name]}
    assert len(seen) >= 4
    assert [pair for pair in seen if pair[1] not in named[pair[0]]] == []


def drawn(draw: Any, item: Any, now: Any) -> Any:
    if item.kind is bool:
        return draw.random() < 0.5
    if item.signal.states is not None:
        return int(draw.choice(list(item.signal.states)))
    low, high = item.signal.low, item.signal.high
    spread = max(1.0, abs(now))
    return item.kind(min(max(now + draw.uniform(-spread, spread), low), high))


def test_the_search_gives_the_same_each_time() -> None:
    assert find_dependencies(SYSTEM_MODELS[System.HSIC]) == find_dependencies(SYSTEM_MODELS[System.HSIC])


def test_outputs_that_nothing_changes_at_the_start_depend_on_nothing() -> None:
    found = indexed(VEHICLE)
    assert found["speed"] == found["gear"] == found["distance"] == set()
    assert {"start.x", "body"} <= found["pose.x"]
    assert "car.steering.ratio" not in found["pose.x"]
    assert {"scene.boxes[16].x", "ultrasonic.noise", "car.ultrasonic.mounts[3].yaw"} <= found["ultrasonic[3]"]
    assert not [name for name in found["ultrasonic[3]"] if re.match("drive|steering", name)]
