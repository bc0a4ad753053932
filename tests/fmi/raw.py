"""A native FMU's library called as C calls it, by ctypes: every status is seen, nothing is checked on the way."""

import ctypes
import zipfile
from ctypes import CFUNCTYPE, byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p
from typing import Any

from fmpy import read_model_description

OK, WARNING, DISCARD, ERROR, FATAL = range(5)
CO_SIMULATION = 1
LOGGER = CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)
NUMBER: dict[str, Any] = {"Real": c_double, "Integer": c_int, "Boolean": c_int}


class Callbacks(ctypes.Structure):
    _fields_ = (
        ("logger", LOGGER),
        ("allocate", c_void_p),
        ("free", c_void_p),
        ("finished", c_void_p),
        ("environment", c_void_p),
    )


class Library:
    """The shared library of one FMU and its description."""

    def __init__(self, path: Any, folder: Any, platform: str = "linux64") -> None:
        with zipfile.ZipFile(path) as archive:
            archive.extractall(folder)
        self.description = read_model_description(str(path))
        self.refs = {v.name: v.valueReference for v in self.description.modelVariables}
        self.types = {v.name: v.type for v in self.description.modelVariables}
        (file,) = (folder / "binaries" / platform).iterdir()
        self.file = file
        self.dll = ctypes.CDLL(str(file))
        self.dll.fmi2Instantiate.restype = c_void_p
        self.dll.fmi2GetVersion.restype = c_char_p
        self.dll.fmi2GetTypesPlatform.restype = c_char_p
        self.messages: list[tuple[int, str, str]] = []
        self.callbacks = Callbacks(LOGGER(self._log), None, None, None, None)

    def _log(self, _environment: Any, name: Any, status: Any, category: Any, text: Any) -> None:
        assert name in (b"toy", b"other", b"")
        self.messages.append((status, category.decode(), text.decode()))

    def instantiate(
        self, name: Any = b"toy", kind: Any = CO_SIMULATION, guid: Any = None, callbacks: bool = True, logging: Any = 1
    ) -> Any:
        guid = self.description.guid.encode() if guid is None else guid
        pointer = byref(self.callbacks) if callbacks else None
        return self.dll.fmi2Instantiate(name, kind, guid or None, b"file:///tmp", pointer, 0, logging)

    def call(self, function: Any, component: Any, *arguments: Any) -> Any:
        """Return the status of fmi2<function>."""
        return getattr(self.dll, f"fmi2{function}")(c_void_p(component), *arguments)

    def setup(self, component: Any, start: Any = 0.0) -> Any:
        return self.call("SetupExperiment", component, 0, c_double(0.0), c_double(start), 0, c_double(0.0))

    def initialized(self, **values: Any) -> Any:
        """Return a new instance, ready to step."""
        component = self.instantiate()
        assert self.setup(component) == OK
        for name, value in values.items():
            assert self.set(component, name, value) == OK
        assert self.call("EnterInitializationMode", component) == OK
        assert self.call("ExitInitializationMode", component) == OK
        return component

    def set(self, component: Any, name: Any, value: Any) -> Any:
        number = NUMBER[self.types[name]](value)
        reference = byref(c_uint(self.refs[name]))
        return self.call(f"Set{self.types[name]}", component, reference, c_size_t(1), byref(number))

    def get(self, component: Any, name: Any) -> Any:
        number = NUMBER[self.types[name]]()
        reference = byref(c_uint(self.refs[name]))
        status = self.call(f"Get{self.types[name]}", component, reference, c_size_t(1), byref(number))
        assert status == OK, self.messages
        return number.value

    def number(self, component: Any, reference: Any) -> Any:
        """Return a real value, alone."""
        number = c_double()
        assert self.call("GetReal", component, byref(c_uint(reference)), c_size_t(1), byref(number)) == OK
        return number.value

    def outputs(self, component: Any) -> Any:
        return [self.get(component, v.name) for v in self.description.modelVariables if v.causality == "output"]

    def step(self, component: Any, time: Any, size: Any = 0.01) -> Any:
        return self.call("DoStep", component, c_double(time), c_double(size), 1)

    def free(self, component: Any) -> None:
        self.dll.fmi2FreeInstance(c_void_p(component))


def array(kind: Any, *values: Any) -> Any:
    """Return a C array of ``kind``."""
    return (kind * len(values))(*values)


def state_pointer() -> Any:
    """Return an empty fmi2FMUstate."""
    return c_void_p(None)
