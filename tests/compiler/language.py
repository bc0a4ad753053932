"""Python functions run in CPython and in the C made of them, side by side."""

import ctypes
import importlib.util
import re
import sys
from typing import Any, NamedTuple

from fmus.compiler import translate
from modelkit.model import Model
from tests.compiler.c_model import CModel, bits, flatten

HEAD = """\
import enum
import math
from enum import IntEnum
from math import pi
from typing import Annotated, NamedTuple

"""
FRAME = """

class In(NamedTuple):
    x: float = 0.0
    y: float = 0.0
    n: int = 0
    m: int = 0
    p: bool = False
    q: bool = False


class Out(NamedTuple):
{fields}


class Nothing(NamedTuple):
    unused: float = 0.0


def initialize(params: Nothing) -> tuple[Nothing, Out]:
    return Nothing(), Out()


def step(state: Nothing, inputs: In, params: Nothing, dt_ns: int) -> tuple[Nothing, Out]:
    x, y, n, m, p, q = inputs.x, inputs.y, inputs.n, inputs.m, inputs.p, inputs.q
    return state, Out(
{calls}
    )
"""
SIGNATURE = "x: float, y: float, n: int, m: int, p: bool, q: bool"
STARTS = {"float": "0.0", "int": "0", "bool": "False"}


class Inputs(NamedTuple):
    """What every function under test takes."""

    x: float = 0.0
    y: float = 0.0
    n: int = 0
    m: int = 0
    p: bool = False
    q: bool = False


def load(text: Any, folder: Any, name: Any) -> Any:
    """Return the module made of ``text``."""
    path = folder / f"{name}.py"
    path.write_text(text)
    spec: Any = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def model_of(module: Any) -> Any:
    """Return the model that a module holds in the usual names."""
    return Model(
        "Trial", "a trial", module, module.Nothing, module.Nothing, module.In, module.Out, module.initialize,
        module.step, 0.01, 1.0,
    )  # fmt: skip


def results(text: Any) -> Any:
    """Return name and result type of the functions under test: those that take all six inputs."""
    return re.findall(rf"^def (\w+)\({re.escape(SIGNATURE)}\) -> (\w+):", text, re.MULTILINE)


def whole_module(text: Any) -> Any:
    """Return a module that has the functions in ``text`` and a model that calls all of them."""
    found = results(text)
    fields = "\n".join(f"    {name}: {kind} = {STARTS.get(kind, f'{kind}()')}" for name, kind in found)
    calls = "\n".join(f"        {name}(x, y, n, m, p, q)," for name, _ in found)
    return HEAD + text + FRAME.format(fields=fields, calls=calls)


class Twins:
    """The functions of a text, in CPython and in C."""

    def __init__(self, text: Any, folder: Any, name: Any, **how: Any) -> None:
        self.names = [name for name, _ in results(text)]
        self.module = load(whole_module(text), folder, name)
        self.translation = translate(model_of(self.module))
        folder = folder / name
        folder.mkdir()
        self.c = CModel(model_of(self.module), self.translation, folder, **how)
        self.c.initialize(self.module.Nothing())
        self.raised = 0

    def differing(self, inputs: Any, only: Any = None) -> Any:
        """Return what differs; where CPython raises or leaves 64 bits there is nothing to compare."""
        self.c.step(self.module.In(*inputs), 0)
        found = []
        for name in self.names if only is None else [only]:
            try:
                expected = flatten(getattr(self.module, name)(*inputs))
            except (ArithmeticError, ValueError, IndexError):
                expected = None
            if expected is None or any(type(item) is int and not -(2**63) <= item < 2**63 for item in expected):
                self.raised += 1
                continue
            own = flat_c(getattr(self.c.outputs, name))
            same = [bits(a) == bits(b) for a, b in zip(own, expected, strict=True)]
            if not all(same):
                found.append(f"{name}{tuple(inputs)}: CPython {expected}, C {own}")
        return found


def flat_c(value: Any) -> Any:
    """Return the scalars of a ctypes value."""
    if isinstance(value, ctypes.Array):
        return [scalar for item in value for scalar in flat_c(item)]
    if isinstance(value, ctypes.Structure):
        return [scalar for name, *_ in value._fields_ for scalar in flat_c(getattr(value, name))]
    return [value]
