"""FMI 2.0 calls in random order with random values on our native FMUs: no crash, no number that is none."""

import math
import random
from collections.abc import Iterator
from ctypes import byref, c_double, c_int, c_size_t, c_uint, c_void_p
from pathlib import Path
from typing import Any

from orchestrator.simulation.cosim.fmu_files import fmu_files
from tests.fmi.raw import ERROR, OK, Library

NUMBERS = (
    0.0,
    -0.0,
    1.0,
    -1.0,
    1e-320,
    1e308,
    -1e308,
    math.inf,
    -math.inf,
    math.nan,
    1e9,
    0.01,
    2.5,
    -7.0,
    1e-9,
    3600.0,
)
WHOLE = (0, 1, 2, 3, 7, 9, -1, 2**31 - 1, -(2**31))
STEPS = (0.01, 0.01, 0.01, 0.02, 0.001, 1.0, 0.0, -0.01, math.nan, math.inf, 1e-12, 20.0)
CALLS = 400
"""Calls in the life of an instance."""


class Life:
    """One instance and what a host may do to it."""

    def __init__(self, library: Library, draw: random.Random) -> None:
        self._library, self._draw = library, draw
        self.component: Any = library.instantiate(b"other")
        self._states: list[Any] = []
        self._time = 0.0
        self._variables = library.description.modelVariables

    def act(self) -> str:
        """Make one call; return what is wrong, empty if nothing."""
        draw = self._draw
        call = draw.choice(
            (self._step,) * 6 + (self._set,) * 5 + (self._get,) * 4 + (self._phase,) * 2 + (self._state,)
        )
        status = call()
        return "" if OK <= status <= ERROR else f"{call.__name__}: status {status}"

    def _step(self) -> int:
        size = self._draw.choice(STEPS)
        time = self._time if self._draw.random() < 0.95 else self._draw.choice(NUMBERS)
        status = int(self._library.step(self.component, time, size))
        if status == OK:
            self._time = time + size
        return status

    def _set(self) -> int:
        variable = self._draw.choice(self._variables)
        value = self._draw.choice(NUMBERS if variable.type == "Real" else WHOLE)
        return int(self._library.set(self.component, variable.name, value))

    def _get(self) -> int:
        variable = self._draw.choice(self._variables)
        kind = c_double if variable.type == "Real" else c_int
        number = kind()
        reference = byref(c_uint(self._draw.choice((variable.valueReference, 1 << 30))))
        return int(self._library.call(f"Get{variable.type}", self.component, reference, c_size_t(1), byref(number)))

    def _phase(self) -> int:
        name = self._draw.choice(
            ("SetupExperiment", "EnterInitializationMode", "ExitInitializationMode", "Terminate", "Reset")
        )
        if name == "SetupExperiment":
            return int(self._library.setup(self.component, self._draw.choice((0.0, 0.0, 1.0, math.nan))))
        if name in ("Terminate", "Reset") and self._draw.random() < 0.8:
            return OK
        self._time = 0.0 if name == "Reset" else self._time
        return int(self._library.call(name, self.component))

    def _state(self) -> int:
        if self._states and self._draw.random() < 0.5:
            return int(self._library.call("SetFMUstate", self.component, self._draw.choice(self._states)))
        state = c_void_p(None)
        status = int(self._library.call("GetFMUstate", self.component, byref(state)))
        if status == OK:
            self._states.append(state)
        return status

    def begin(self) -> str:
        """Bring the instance to Step Mode; return the first output that is no number."""
        self._library.setup(self.component)
        self._library.call("EnterInitializationMode", self.component)
        self._library.call("ExitInitializationMode", self.component)
        return ""

    def not_finite(self) -> str:
        """Return the name of an output that is no finite number after a step that went well."""
        if self._library.step(self.component, self._time, 0.01) != OK:
            return ""
        self._time += 0.01
        for variable in self._variables:
            if variable.causality == "output" and variable.type == "Real":
                number = c_double()
                reference = byref(c_uint(variable.valueReference))
                status = self._library.call("GetReal", self.component, reference, c_size_t(1), byref(number))
                if status == OK and not math.isfinite(number.value):
                    return f"{variable.name} = {number.value}"
        return ""

    def end(self) -> None:
        """Free states and instance."""
        for state in self._states:
            self._library.call("FreeFMUstate", self.component, byref(state))
        self._library.free(self.component)


def fuzz(folder: Path, _log: Path, draw: random.Random) -> Iterator[tuple[list[str], str]]:
    """Live one life after the other without end; yield the model and what was wrong, empty if nothing."""
    libraries = {}
    for name, path in fmu_files("native").items():
        (folder / name).mkdir()
        libraries[name] = Library(path, folder / name)
    while True:
        name = draw.choice(list(libraries))
        libraries[name].messages.clear()
        life = Life(libraries[name], draw)
        wrong = life.begin() if draw.random() < 0.8 else ""
        for _ in range(draw.randrange(CALLS)):
            wrong = wrong or life.act()
        wrong = wrong or life.not_finite()
        life.end()
        yield [name], wrong
