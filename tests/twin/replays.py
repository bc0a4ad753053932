"""Models played the inputs that a run has recorded, step by step, by ways that no master of ours drives."""

from ctypes import c_size_t, c_uint32, c_void_p
from typing import Any

import numpy as np

from fmus.contents.arrays import fmi_arrays
from fmus.native.libraries import load_model, memory_size
from modelkit.variables import flatten, variables, with_values
from orchestrator.inputs.scenario.models import MODELS
from tests.fmi.raw3 import OK, Library3

FUNCTIONS = {
    "Float64": ("Float64", np.float64),
    "Int32": ("Int32", np.int32),
    "Enumeration": ("Int64", np.int64),
    "Boolean": ("Boolean", np.bool_),
}
"""Type in FMI 3.0 -> name of its functions, type of an element."""


def played(target: Any, scenario: Any, recording: Any, name: Any) -> Any:
    """Return the outputs of model ``name`` at each exchange of ``recording``, played its inputs by ``target``."""
    model = MODELS[name]
    inputs, outputs = ([f"{name}.{item.name}" for item in variables(cls)] for cls in (model.inputs, model.outputs))
    given = np.column_stack([recording.signals[key] for key in inputs])
    every = scenario.decimation.get(name, 1)
    params = np.array(flatten(with_values(model.params, dict(getattr(scenario, name)))), dtype=float)
    rows = target(params, np.ascontiguousarray(given[::every]), scenario.step_ns * every)
    return dict(zip(outputs, np.repeat(rows, every, axis=0)[: len(given)].T, strict=True))


class CLibrary:
    """The C of a model, without FMI."""

    def __init__(self, model: Any) -> None:
        self.library, self.count = load_model(model), len(variables(model.outputs))

    def __call__(self, params: Any, given: Any, step_ns: Any) -> Any:
        memory, rows = np.zeros(memory_size(self.library), dtype=np.uint8), np.empty((len(given), self.count))
        self.library.model_start(memory.ctypes.data, params.ctypes.data, rows.ctypes.data)
        at, y = given.ctypes.data, rows.ctypes.data
        for k in range(len(given) - 1):
            u, after = at + k * given.strides[0], y + (k + 1) * rows.strides[0]
            self.library.model_step(memory.ctypes.data, u, after, step_ns)
        return rows


class Block:
    """The variables of one FMI 3.0 type among the parameters, inputs or outputs."""

    def __init__(self, dll: Any, verb: Any, kind: Any, arrays: Any, places: Any) -> None:
        name, self.dtype = FUNCTIONS[kind]
        chosen = [item for item in arrays if item.fmi_type == kind and item.first.name in places]
        self.places = [places[element.name] for item in chosen for element in item.elements]
        self.references = (c_uint32 * len(chosen))(*(item.vr for item in chosen))
        self.function = getattr(dll, f"fmi3{verb}{name}")
        self.function.argtypes = [c_void_p, c_void_p, c_size_t, c_void_p, c_size_t]

    def rows(self, count: Any) -> Any:
        """Return room for the values of ``count`` exchanges."""
        return np.empty((count, len(self.places)), dtype=self.dtype)

    def caller(self, component: Any, rows: Any) -> Any:
        """Return the function that hands over, or fetches, a row by its number and returns the status."""
        at, width = rows.ctypes.data, rows.strides[0]
        function, references, count, size = self.function, self.references, len(self.references), len(self.places)
        return lambda k: function(component, references, count, at + k * width, size)


class Fmi3:
    """An FMI 3.0 FMU: a call for each type of variable."""

    def __init__(self, model: Any, path: Any, folder: Any) -> None:
        self.library = Library3(path, folder)
        arrays = fmi_arrays(model)

        def blocks(verb: Any, cls: Any) -> Any:
            places = {item.name: place for place, item in enumerate(variables(cls))}
            found = [Block(self.library.dll, verb, kind, arrays, places) for kind in FUNCTIONS]
            assert sorted(place for block in found for place in block.places) == list(range(len(places)))
            return [block for block in found if block.places]

        self.params, self.inputs = blocks("Set", model.params), blocks("Set", model.inputs)
        self.outputs = blocks("Get", model.outputs)

    def __call__(self, params: Any, given: Any, step_ns: Any) -> Any:
        component = self.library.instantiate()
        for block in self.params:
            row = np.array([params[block.places]], block.dtype)
            assert block.caller(component, row)(0) == OK, self.library.messages
        assert self.library.enter(component) == OK
        assert self.library.call("ExitInitializationMode", component) == OK
        heard = [(block, np.ascontiguousarray(given[:, block.places]).astype(block.dtype)) for block in self.inputs]
        reported = [(block, block.rows(len(given))) for block in self.outputs]
        fetch = [block.caller(component, rows) for block, rows in reported]
        hand_over = [block.caller(component, rows) for block, rows in heard]
        for k in range(len(given)):
            good = all(call(k) == OK for call in fetch)
            if k + 1 < len(given):
                good &= all(call(k) == OK for call in hand_over)
                good &= self.library.step(component, k * step_ns / 1e9, step_ns / 1e9) == OK
            assert good, self.library.messages
        self.library.free(component)
        found = np.empty((len(given), sum(len(block.places) for block in self.outputs)))
        for block, rows in reported:
            found[:, block.places] = rows
        return found
