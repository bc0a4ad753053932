"""The library of a native FMI 3.0 FMU called as C calls it, by ctypes: every status is seen, nothing is checked."""

import ctypes
import zipfile
from ctypes import CFUNCTYPE, byref, c_bool, c_char_p, c_double, c_int, c_int32, c_int64, c_size_t, c_uint32, c_void_p
from typing import Any

from fmpy import read_model_description

from tests.fmi.raw import ERROR, OK, array

LOGGER = CFUNCTYPE(None, c_void_p, c_int, c_char_p, c_char_p)
TYPES = {
    "Float64": ("Float64", c_double),
    "Int32": ("Int32", c_int32),
    "Enumeration": ("Int64", c_int64),
    "Boolean": ("Boolean", c_bool),
}
"""Type of a variable -> name of its functions, type in C."""

__all__ = ["ERROR", "OK", "TYPES", "Library3", "array"]


class Library3:
    """The shared library of one FMU and its description."""

    def __init__(self, path: Any, folder: Any, platform: str = "x86_64-linux") -> None:
        with zipfile.ZipFile(path) as archive:
            archive.extractall(folder)
        self.description = read_model_description(str(path))
        self.known = {v.name: v for v in self.description.modelVariables}
        (self.file,) = (folder / "binaries" / platform).iterdir()
        self.dll = ctypes.CDLL(str(self.file))
        for name in ("fmi3InstantiateCoSimulation", "fmi3InstantiateModelExchange"):
            getattr(self.dll, name).restype = c_void_p
        self.dll.fmi3GetVersion.restype = c_char_p
        self.messages: list[tuple[int, bytes, str]] = []
        self.logger = LOGGER(lambda _, status, category, text: self.messages.append((status, category, text.decode())))

    def instantiate(
        self,
        name: Any = b"toy",
        token: Any = None,
        logging: bool = True,
        event_mode: bool = False,
        intermediate: Any = 0,
    ) -> Any:
        token = self.description.guid.encode() if token is None else token
        flags = [c_bool(flag) for flag in (False, logging, event_mode, False)]
        more = (None, c_size_t(intermediate), None, self.logger, None)
        return self.dll.fmi3InstantiateCoSimulation(name, token or None, b"/tmp/", *flags, *more)

    def call(self, function: Any, component: Any, *arguments: Any) -> Any:
        """Return the status of fmi3<function>."""
        return getattr(self.dll, f"fmi3{function}")(c_void_p(component), *arguments)

    def enter(self, component: Any, start: Any = 0.0, stop: Any = None) -> Any:
        times = (c_double(start), c_bool(stop is not None), c_double(stop or 0.0))
        return self.call("EnterInitializationMode", component, c_bool(False), c_double(0.0), *times)

    def initialized(self, **values: Any) -> Any:
        """Return a new instance, ready to step."""
        component = self.instantiate()
        for name, value in values.items():
            assert self.set(component, name, value) == OK, self.messages
        assert self.enter(component) == OK
        assert self.call("ExitInitializationMode", component) == OK
        return component

    def size(self, name: Any) -> Any:
        count = 1
        for dimension in self.known[name].dimensions:
            count *= int(dimension.start)
        return count

    def set(self, component: Any, name: Any, value: Any, count: Any = None) -> Any:
        values = list(value) if isinstance(value, (tuple, list)) else [value]
        function, kind = TYPES[self.known[name].type]
        reference = byref(c_uint32(self.known[name].valueReference))
        many = c_size_t(len(values) if count is None else count)
        return self.call(f"Set{function}", component, reference, c_size_t(1), array(kind, *values), many)

    def get(self, component: Any, name: Any) -> Any:
        """Return the elements of a variable."""
        function, kind = TYPES[self.known[name].type]
        values = (kind * self.size(name))()
        reference = byref(c_uint32(self.known[name].valueReference))
        status = self.call(f"Get{function}", component, reference, c_size_t(1), values, c_size_t(len(values)))
        assert status == OK, self.messages
        return list(values)

    def outputs(self, component: Any) -> Any:
        return {v.name: self.get(component, v.name) for v in self.known.values() if v.causality in ("output", "local")}

    def step(self, component: Any, time: Any, size: Any = 0.01) -> Any:
        self.reported = (c_bool(True), c_bool(True), c_bool(True), c_double(-1.0))
        pointers = (byref(item) for item in self.reported)
        return self.call("DoStep", component, c_double(time), c_double(size), c_bool(True), *pointers)

    def free(self, component: Any) -> None:
        self.dll.fmi3FreeInstance(c_void_p(component))
