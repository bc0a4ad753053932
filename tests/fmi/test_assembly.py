"""Models as one model: whatever they are, its Python and its C give the same bits."""

import sys

import pytest
import store_model
import toy_model

from fmus.contents.fmu_documentation import in_python
from fmus.contents.variables import visible_variables
from fmus.native.compilers import can_compile
from fmus.native.libraries import in_c
from modelkit.assembly import assemble
from tests.fmi.built import native_fmu_of
from tests.fmi.fmpy_check import problems_of
from tests.fmi.host import OK, Host

STEPS = [3_000_000, 7_000_000, 17_000_000, 50_000_000] * 5
HERE = sys.modules[__name__]


def test_models_that_do_not_feed_each_other_and_one_with_work_arrays() -> None:
    parts = {"a": toy_model.MODEL, "b": store_model.MODEL}
    model = assemble("Both", "two", HERE, parts, 10_000_000)
    ports = {item.name for item in visible_variables(model) if item.causality == "input"}
    assert ports > {"a.brake", "b.u"}
    rows = list(in_c(model, STEPS))
    assert rows == [[float(value) for value in row] for row in in_python(model, STEPS)]
    assert rows[-1] != rows[0]


@pytest.mark.skipif(not can_compile(), reason="needs a C compiler")
def test_their_fmu_is_valid_takes_parameters_and_continues_from_a_saved_state() -> None:
    path = native_fmu_of(assemble("Both", "two", HERE, {"a": toy_model.MODEL, "b": store_model.MODEL}, 10_000_000))
    assert problems_of(path) == []
    with Host(path) as host, Host(path) as other, Host(path) as stiff:
        host.initialize()
        stiff.initialize(**{"a.stiffness": 7.0})
        for k in range(20):
            assert host.step(k * 0.007, 0.007) == stiff.step(k * 0.007, 0.007) == OK
        assert host.outputs() != stiff.outputs()
        content = host.fmu.serializeFMUstate(host.fmu.getFMUstate())
        other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(content))
        for k in range(20, 40):
            assert host.step(k * 0.007, 0.007) == other.step(k * 0.007, 0.007) == OK
        assert host.outputs() == other.outputs()


def test_two_models_with_work_arrays_are_refused() -> None:
    parts = {"a": store_model.MODEL, "b": store_model.MODEL._replace(name="Other")}
    with pytest.raises(ValueError, match="Both: only one of the models may have a store"):
        assemble("Both", "two", HERE, parts, 10_000_000)


def test_start_values_of_a_model_are_checked() -> None:
    model = toy_model.MODEL.with_start_values({"mass": 3, "noisy": False})
    assert (model.first_params().mass, model.first_params().noisy) == (3.0, False)
    assert model.with_start_values({}) == toy_model.MODEL
    with pytest.raises(KeyError, match="maas"):
        toy_model.MODEL.with_start_values({"maas": 3.0})
    with pytest.raises(ValueError, match="mass = -1"):
        toy_model.MODEL.with_start_values({"mass": -1.0})
