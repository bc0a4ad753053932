"""What is said of a signal at both ends of a connection between our models: the same."""

from typing import Any

import pytest

from controller_fmu import APA, SYSTEM_MODELS
from controller_fmu import MODEL as CONTROLLER
from fmus.contents.arrays import visible_arrays
from fmus.contents.variables import limits, visible_variables
from modelkit.connections import connections, part_of
from modelkit.model import Model
from modelkit.variables import variables
from vehicle_fmu import MODEL as VEHICLE

CONTROLLERS: tuple[Model[Any, Any, Any, Any], ...] = (CONTROLLER, APA, *SYSTEM_MODELS.values())


def said(item: Any, fmi_type: str, shape: Any = ()) -> Any:
    """Return what an importer reads of a variable, its causality and start value aside."""
    states = item.signal.states and [(state.name, state.value) for state in item.signal.states]
    return item.name, fmi_type, item.signal.unit, limits(item), states, shape


def ends(model: Model[Any, Any, Any, Any], causality: str, fmi: int) -> dict[str, Any]:
    if fmi == 2:
        return {v.name: said(v, v.fmi_type) for v in visible_variables(model) if v.causality == causality}
    chosen = [array for array in visible_arrays(model) if array.first.causality == causality]
    return {array.name: said(array.first, array.fmi_type, array.shape) for array in chosen}


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("controller", CONTROLLERS, ids=[model.name for model in CONTROLLERS])
def test_both_ends_of_a_connection_say_the_same(controller: Model[Any, Any, Any, Any], fmi: int) -> None:
    count = 0
    for sender, receiver in ((VEHICLE, controller), (controller, VEHICLE)):
        outputs, inputs = ends(sender, "output", fmi), ends(receiver, "input", fmi)
        both = outputs.keys() & inputs.keys()
        assert {name: outputs[name] for name in both} == {name: inputs[name] for name in both}
        count += len(both)
    assert count >= 15


@pytest.mark.parametrize("controller", CONTROLLERS, ids=[model.name for model in CONTROLLERS])
def test_what_is_connected_inside_is_of_the_same_signal(controller: Model[Any, Any, Any, Any]) -> None:
    """Hidden variables too, in the assembly of a container: kind, unit, range, states."""
    models = (VEHICLE, controller)
    wires = connections([part_of("vehicle", VEHICLE), part_of("controller", controller)])
    for wire in wires:
        output = variables(models[wire.source].outputs)[wire.output]
        taken = variables(models[wire.target].inputs)[wire.input]
        facts = [(item.name, item.kind, item.signal._replace(text="")) for item in (output, taken)]
        assert facts[0] == facts[1]
    assert len(wires) > 15
