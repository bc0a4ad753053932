"""Work arrays of a model: in every kind of FMU and library the same bits, saved and restored with the state."""

import ctypes
import importlib
import sys
from ctypes import byref, c_size_t, c_void_p
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import store_model

from fmus.compiler import UnsupportedError, translate
from fmus.contents.variables import fmi_variables
from fmus.model_fields import field_refusals
from fmus.native import fmu as native_fmu
from fmus.native.c_library import write_c_library
from fmus.native.libraries import load_model, memory_size
from fmus.native.platforms import host as platform
from fmus.python import fmu as python_fmu
from modelkit.store import bytes_of, size_of, store_of
from modelkit.variables import constructor, flatten
from tests.fmi.host import OK, Host, random_inputs
from tests.fmi.raw import Library, state_pointer

MODEL = store_model.MODEL
INPUTS = random_inputs(fmi_variables(MODEL), 5, 90)


def in_process(first: Any = 0, last: Any = 90, store: Any = None, state: Any = None) -> Any:
    """Return store, state and the outputs after each step."""
    params = MODEL.params()
    start, _ = MODEL.initialize(params)
    store, state = MODEL.new_store() if store is None else store, start if state is None else state
    step, make, found = MODEL.stepper(store), constructor(MODEL.inputs), []
    for values in INPUTS[first:last]:
        state, outputs = step(state, make(list(values.values())), params, 10_000_000)
        found.append(flatten(outputs))
    return store, state, found


def test_a_store_becomes_bytes_and_comes_back() -> None:
    store, state, _ = in_process(0, 40)
    content = bytes_of(store)
    assert len(content) == size_of(MODEL.store)
    _, _, expected = in_process(40, 90, store, state)
    assert in_process(40, 90, store_of(MODEL.store, content), state)[2] == expected
    assert bytes_of(None) == b""
    assert store_of(None, b"") is None


def test_compiled_in_process_it_has_the_same_bits() -> None:
    library = load_model(MODEL)
    memory = np.zeros(memory_size(library), dtype=np.uint8)
    params, outputs = np.array(flatten(MODEL.params())), np.zeros(3)
    for _ in range(2):  # a second run begins with zeros
        library.model_start(memory.ctypes.data, params.ctypes.data, outputs.ctypes.data)
        for values, expected in zip(INPUTS, in_process()[2], strict=True):
            inputs = np.array(list(values.values()), dtype=float)
            library.model_step(memory.ctypes.data, inputs.ctypes.data, outputs.ctypes.data, 10_000_000)
            assert outputs.tolist() == expected


def run_on(fmu: Any, component: Any, first: Any, last: Any) -> Any:
    found = []
    for number in range(first, last):
        for name, value in INPUTS[number].items():
            assert fmu.set(component, name, value) == OK
        assert fmu.step(component, number * 0.01) == OK
        found.append(fmu.outputs(component))
    return found


def test_the_native_fmu_saves_and_serializes_it(tmp_path: Path) -> None:
    fmu = Library(native_fmu.build(MODEL, tmp_path, [platform()]), tmp_path / "native")
    component, other = fmu.initialized(), fmu.instantiate(b"other")
    expected = in_process()[2]
    assert run_on(fmu, component, 0, 40) == expected[:40]
    state, size, restored = state_pointer(), c_size_t(), state_pointer()
    assert fmu.call("GetFMUstate", component, byref(state)) == OK
    assert fmu.call("SerializedFMUstateSize", component, state, byref(size)) == OK
    assert size.value > size_of(MODEL.store)
    content = ctypes.create_string_buffer(size.value)
    assert fmu.call("SerializeFMUstate", component, state, content, size) == OK
    assert run_on(fmu, component, 40, 90) == expected[40:]
    assert fmu.call("SetFMUstate", component, state) == OK
    assert run_on(fmu, component, 40, 90) == expected[40:]
    assert fmu.call("DeSerializeFMUstate", other, content, size, byref(restored)) == OK
    assert fmu.call("SetFMUstate", other, restored) == OK
    assert run_on(fmu, other, 40, 90) == expected[40:]
    assert fmu.call("Reset", c_void_p(other).value) == OK
    for instance, pointer in ((component, state), (other, restored)):
        fmu.call("FreeFMUstate", instance, byref(pointer))
        fmu.free(instance)


def test_the_python_fmu_saves_and_serializes_it(tmp_path: Path) -> None:
    path, expected = python_fmu.build(MODEL, tmp_path), in_process()[2]

    def run(fmu: Any, first: Any, last: Any) -> Any:
        found = []
        for number in range(first, last):
            fmu.set(INPUTS[number])
            assert fmu.step(number * 0.01, 0.01) == OK
            found.append(fmu.outputs())
        return found

    with Host(path) as one, Host(path, "other") as other:
        one.initialize()
        assert run(one, 0, 40) == expected[:40]
        state = one.fmu.getFMUstate()
        content = one.fmu.serializeFMUstate(state)
        assert run(one, 40, 90) == expected[40:]
        one.fmu.setFMUstate(state)
        assert run(one, 40, 90) == expected[40:]
        other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(content))
        assert run(other, 40, 90) == expected[40:]


def test_the_c_library_has_it_in_its_memory(tmp_path: Path) -> None:
    write_c_library(MODEL, tmp_path)
    assert "Worker_step(&model.store, &model.state," in (tmp_path / "main.c").read_text()
    assert "    Work store;" in (tmp_path / "Worker.h").read_text()


NOT_READ = """
def step(store: Work, state: State, inputs: Input, params: Params, dt_ns: int) -> tuple[State, Output]:
    often = note(store, 3, inputs.u)
    return state, Output()
"""
INSIDE = """
def step(store: Work, state: State, inputs: Input, params: Params, dt_ns: int) -> tuple[State, Output]:
    return state, Output(count=note(store, 3, inputs.u) + 1)
"""
ANEW = """
def step(store: Work, state: State, inputs: Input, params: Params, dt_ns: int) -> tuple[State, Output]:
    other = store
    other.exact[0] = inputs.u
    return state, Output()
"""
A_PART = """
def step(store: Work, state: State, inputs: Input, params: Params, dt_ns: int) -> tuple[State, Output]:
    return state, Output(total=store.exact[1:3][0])
"""
A_FLOAT = """
def step(store: Work, state: State, inputs: Input, params: Params, dt_ns: int) -> tuple[State, Output]:
    store.whole[2] = inputs.u
    return state, Output()
"""


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (NOT_READ, "often is never read"),
        (INSIDE, "note() writes to a store inside an expression"),
        (ANEW, "other as a second name for a store"),
        (A_PART, "a part of a column"),
        (A_FLOAT, "store.whole is a column of int"),
    ],
)
def test_what_would_not_be_the_same_in_c_is_refused(
    text: Any, said: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "refused_store.py").write_text("from store_model import *\n" + text)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "refused_store", raising=False)
    module = importlib.import_module("refused_store")
    with pytest.raises(UnsupportedError) as refused:
        translate(MODEL._replace(package=module, step=module.step))
    assert said in str(refused.value)


def test_a_field_that_is_no_column_is_said() -> None:
    assert field_refusals(MODEL) == []
    found = field_refusals(MODEL._replace(store=store_model.State))
    assert [item.what for item in found] == ["State.place is no column of a store"]
