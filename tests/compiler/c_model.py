"""A translated model compiled and called from Python, its structs seen by ctypes."""

import ctypes
import math
import shutil
import struct
from enum import IntEnum
from typing import Any

from fmus.compiler import members
from fmus.compiler.source.types import BOOL, FLOAT, INT, Array, Cells, Struct, fields_of
from fmus.compiler.target.names import member_name
from fmus.native.compilers import FLAGS, find_compiler

WARNINGS = ("-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wno-unused-parameter", "-Werror")
ZIG = find_compiler("zig")
COMPILER = find_compiler("gcc") if shutil.which("gcc") else ZIG
CELLS: dict[str, Any] = {
    **{"double": ctypes.c_double, "float": ctypes.c_float},
    **{"int32_t": ctypes.c_int32, "int16_t": ctypes.c_int16},
}
SCALARS = {FLOAT: ctypes.c_double, INT: ctypes.c_int64, BOOL: ctypes.c_bool}


def compiled(
    folder: Any, name: Any, file: Any, compiler: Any = COMPILER, options: Any = FLAGS, warnings: Any = WARNINGS
) -> Any:
    """Return a shared library made of a C file without a warning."""
    compiler.run([*options, *warnings, "-shared", "-fPIC", "-o", f"{name}.so", file, "-lm"], folder)
    return ctypes.CDLL(str(folder / f"{name}.so"))


_structures: dict[Any, Any] = {}


def structure(kind: Any) -> Any:
    """Return the ctypes type of a kind."""
    if isinstance(kind, Array):
        return structure(kind.item) * kind.length
    if isinstance(kind, Cells):
        return CELLS[kind.c] * kind.length
    if not isinstance(kind, Struct):
        return SCALARS[kind]
    if kind.cls not in _structures:
        fields = [(member_name(name), structure(part)) for name, part in fields_of(kind.cls).items()]
        _structures[kind.cls] = type(kind.cls.__name__, (ctypes.Structure,), {"_fields_": fields})
    return _structures[kind.cls]


def to_c(value: Any, kind: Any) -> Any:
    """Return a Python value as ctypes."""
    if isinstance(kind, Array):
        return structure(kind)(*(to_c(item, kind.item) for item in value))
    if isinstance(kind, Struct):
        parts = zip(value, fields_of(kind.cls).values(), strict=True)
        return structure(kind)(*(to_c(item, part) for item, part in parts))
    return int(value) if isinstance(value, IntEnum) else value


def bits(scalar: Any) -> Any:
    """Return something that is equal for scalars of the same bits only."""
    if isinstance(scalar, float):
        return "NaN" if math.isnan(scalar) else struct.pack("d", scalar)
    return int(scalar)


def all_bits(scalars: Any) -> Any:
    """Return the bits of all scalars at once; alike for equal NaN only, which ``bits`` forgives."""
    kinds = "".join("d" if isinstance(scalar, float) else "q" for scalar in scalars)
    return kinds, struct.pack(kinds, *scalars)


_libraries: dict[Any, Any] = {}
"""Header, source and how it was compiled -> library: its functions keep nothing, so models of one process share it."""


class CModel:
    """The C of a model behind the functions of the model."""

    def __init__(self, model: Any, translation: Any, folder: Any, **how: Any) -> None:
        key = (translation.header, translation.source, *sorted(how.items()))
        if key not in _libraries:
            (folder / f"{model.name}.h").write_text(translation.header)
            (folder / f"{model.name}.c").write_text(translation.source)
            _libraries[key] = compiled(folder, model.name, f"{model.name}.c", **how)
        self.model = model
        self.library = _libraries[key]
        self.kinds = {group: Struct(getattr(model, group)) for group in ("params", "inputs", "outputs", "state")}
        self.state, self.outputs = (structure(self.kinds[group])() for group in ("state", "outputs"))
        self.store = structure(Struct(model.store))() if model.store else None
        self.names = {}
        self.flat = {}
        for group in ("state", "outputs", "params", "inputs"):
            found = members(model, (group,))
            self.names[group] = [item.name for item in found]
            items = "".join(f"{item.path.replace(group, 'o', 1)}," for item in found)
            self.flat[group] = eval(f"lambda o: ({items})")

    def function(self, name: Any) -> Any:
        return getattr(self.library, f"{self.model.name}_{name}")

    def defaults(self) -> Any:
        """Return start values of parameters and inputs, flat."""
        params, inputs = (structure(self.kinds[group])() for group in ("params", "inputs"))
        self.function("defaults")(ctypes.byref(params), ctypes.byref(inputs))
        return self.flat["params"](params), self.flat["inputs"](inputs)

    def initialize(self, params: Any) -> None:
        self.params = to_c(params, self.kinds["params"])
        pointers = (ctypes.byref(item) for item in (self.params, self.state, self.outputs))
        self.function("initialize")(*pointers)

    def step(self, inputs: Any, dt_ns: Any) -> None:
        inputs = to_c(inputs, self.kinds["inputs"])
        state, params, outputs = (ctypes.byref(item) for item in (self.state, self.params, self.outputs))
        store = [] if self.store is None else [ctypes.byref(self.store)]
        self.function("step")(*store, state, ctypes.byref(inputs), params, ctypes.c_int64(dt_ns), outputs)

    def differing_columns(self, store: Any) -> Any:
        """Return the names of the columns whose bytes differ from CPython's."""
        return [name for name in store._fields if bytes(getattr(self.store, name)) != getattr(store, name).tobytes()]

    def differing(self, state: Any, outputs: Any) -> Any:
        """Return the names of state and outputs whose bits differ from CPython's."""
        found: list[str] = []
        for group, own, other in (("state", self.state, state), ("outputs", self.outputs, outputs)):
            in_c, in_python = self.flat[group](own), flatten(other)
            if all_bits(in_c) == all_bits(in_python):
                continue
            pairs = zip(self.names[group], in_c, in_python, strict=True)
            found += [f"{group}.{name}: {a!r} {b!r}" for name, a, b in pairs if bits(a) != bits(b)]
        return found


def flatten(value: Any) -> Any:
    if not isinstance(value, tuple):
        return [value]
    return [scalar for item in value for scalar in flatten(item)]
