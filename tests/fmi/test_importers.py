"""What an importer reads in the description: few ports, true dependencies, ranges, types, what may change when."""

from enum import IntEnum
from typing import Any
from xml.etree import ElementTree

import pytest
import toy_model

from controller_fmu import APA, SYSTEM_MODELS
from controller_fmu import MODEL as CONTROLLER
from controller_fmu.registry import System
from fmus.contents.description import model_description
from fmus.contents.variables import fmi_variables, limits, mode_types
from modelkit.model import Variant
from modelkit.variables import variables
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


@pytest.mark.parametrize("model", [VEHICLE, CONTROLLER, SYSTEM_MODELS[System.HSIC]], ids=lambda model: model.name)
def test_outputs_depend_at_the_start_on_every_parameter_and_on_no_input(model: Any) -> None:
    root: Any = ElementTree.fromstring(xml(model))
    causes = {node.get("name"): node.get("causality") for node in root.find("ModelVariables")}
    found = indexed(model)
    assert set(found) == {name for name, causality in causes.items() if causality == "output"}
    assert all(
        names == {name for name, causality in causes.items() if causality == "parameter"} for names in found.values()
    )
