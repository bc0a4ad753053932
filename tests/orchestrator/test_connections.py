"""Connections by equal names, refused where type or unit differ."""

import pytest

from modelkit.signal import Signal
from modelkit.variables import Variable
from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.connections import connect
from orchestrator.simulation.cosim.fmu_instance import FmuInstance
from orchestrator.simulation.cosim.model_instance import ModelInstance
from tests.orchestrator.toy_models import BRAIN, PLANT


def toys() -> list[ModelInstance]:
    return [ModelInstance("plant", PLANT, {}), ModelInstance("brain", BRAIN, {})]


def replace(instance: FmuInstance, name: str, variable: Variable) -> None:
    instance.inputs.variables[instance.inputs.index[name]] = variable


def test_equal_names_are_connected_both_ways() -> None:
    instances = toys()
    found = {
        (instances[link.source].outputs.names[a], instances[link.target].inputs.names[b])
        for link in connect(list(instances))
        for a, b in zip(link.source_places, link.target_places, strict=True)
    }
    names = {"command", "mode", "active", "right", "pose.x", "pose.y", "pose.heading", "moving", "left"}
    assert found == {(name, name) for name in names}


def test_another_unit_is_refused_by_name() -> None:
    instances = toys()
    replace(instances[0], "command", Variable("command", float, Signal("rad", ""), 0.0))
    with pytest.raises(BadInput, match="command: output of brain is in m/s, input of plant in rad"):
        connect(list(instances))


def test_another_type_is_refused_by_name() -> None:
    instances = toys()
    replace(instances[0], "command", Variable("command", int, Signal("m/s", ""), 0))
    with pytest.raises(BadInput, match="command: output of brain is float, input of plant is int"):
        connect(list(instances))


def test_two_sources_for_one_input_are_refused() -> None:
    instances = [*toys(), ModelInstance("second", BRAIN, {})]
    with pytest.raises(BadInput, match="brain and second both have an output"):
        connect(list(instances))
