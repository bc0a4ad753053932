"""An FMI 2.0 co-simulation FMU behind the face of an instance. FMPy loads it; the arrays are allocated once.

Each exchange is at most one call per type and direction (``fmi2GetReal`` and so on), made straight
through ctypes on pointers that never change.
"""

import ctypes
from collections.abc import Callable, Mapping
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np
from fmpy import extract
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

from fmus.files import new_folder, remove_folder
from modelkit.model import Model
from orchestrator.inputs.text.errors import RESOURCES, NotRunError, RunError, excerpt
from orchestrator.simulation.cosim.fmu_instance import Ports
from orchestrator.simulation.cosim.model_description import (
    DESCRIPTION,
    has_variable_step,
    ports_of,
    read_description,
    text_parameters,
)
from orchestrator.simulation.cosim.python_fmu import instantiation_message

OK, WARNING, ERROR, FATAL = 0, 1, 3, 4
"""FMI statuses; from 2 (fmi2Discard) on a call did not do what it should."""
LOADING = Lock()
"""FMPy changes the working directory of the process while it loads a library: one thread at a time."""
LogCallback = Callable[[str, int, str], None]
"""Called with (instance name, FMI status, message)."""


class Transfer:
    """One direction of one type: value references, C array, and where its values sit in the ports."""

    def __init__(self, function: Any, component: Any, ports: Ports, kind: type, references: dict[str, int]) -> None:
        self.places = ports.indices(kind)
        names = [ports.names[place] for place in self.places]
        self.count = len(names)
        self.last = b""
        """What was sent last."""
        self.array: Any = ((ctypes.c_double if kind is float else ctypes.c_int32) * max(self.count, 1))()
        self.view: Any = np.ctypeslib.as_array(self.array)[: self.count]
        self.references = (ctypes.c_uint32 * max(self.count, 1))(*[references[name] for name in names])
        pointer = ctypes.c_void_p
        self.function = function
        self._arguments = (
            pointer(component),
            pointer(ctypes.addressof(self.references)),
            ctypes.c_size_t(self.count),
            pointer(ctypes.addressof(self.array)),
        )

    def __call__(self) -> int:
        """Make the call and return its FMI status."""
        return int(self.function(*self._arguments))


class LocalInstance:
    """One instance of one FMU."""

    def __init__(
        self, name: str, path: Path, parameters: Mapping[str, Any], log: LogCallback, model: Model | None = None
    ) -> None:
        self.name = name
        self._log = log
        self._last_message = ""
        self._worst = OK
        """The worst FMI status it gave."""
        self.path = path
        self._directory = ""
        self._instance: FMU2Slave | None = None
        self._description = read_description(path)
        self.identity = self._description.guid
        self.has_variable_step = has_variable_step(self._description)
        scalars = self._description.modelVariables
        self._references = {scalar.name: scalar.valueReference for scalar in scalars}
        self.inputs, self.outputs, self.parameters = (
            ports_of(self._description, causality, model, path) for causality in ("input", "output", "parameter")
        )
        known = {item.name for item in text_parameters(self._description)}
        self._texts = {key: str(value) for key, value in parameters.items() if key in known}
        parameters = {key: value for key, value in parameters.items() if key not in known}
        for key, value in parameters.items():
            if key not in self.parameters.index:
                raise RunError(f"{path.name} has no parameter {key}; is it outdated? run: apa build")
            self.parameters.values[self.parameters.index[key]] = float(value)
        self._changed = {key: self.parameters.variables[self.parameters.index[key]].kind for key in parameters}

    def initialize(self, stop_ns: int) -> None:
        """Extract, instantiate, set the parameters, enter Initialization Mode."""
        self._directory = str(new_folder("fmu"))
        co_simulation = self._description.coSimulation
        try:
            extract(str(self.path), unzipdir=self._directory, include=_is_needed)
            with LOADING:
                self._instance = FMU2Slave(
                    guid=self._description.guid,
                    unzipDirectory=self._directory,
                    modelIdentifier=co_simulation.modelIdentifier,
                    instanceName=self.name,
                )
        except RESOURCES:
            raise
        except Exception as error:
            raise NotRunError(f"{self.path.name} cannot be loaded here: {excerpt(error)}") from error
        self._callbacks = self._make_callbacks()
        try:
            self._instance.instantiate(callbacks=self._callbacks, loggingOn=True)
        except Exception as error:
            self._instance = None
            if isinstance(error, RESOURCES):
                raise
            refusal = str(self._status_error("cannot be instantiated", FATAL, str(error)))
            raise NotRunError(instantiation_message(refusal)) from error
        self._bind()
        self._set_parameters()
        try:
            self._instance.setupExperiment(startTime=0.0, stopTime=stop_ns / 1e9)
            self._instance.enterInitializationMode()
        except Exception as error:
            raise self._status_error("refuses to initialize", _status_of(error), str(error)) from error

    def start(self) -> None:
        """Exit Initialization Mode."""
        assert self._instance is not None
        try:
            self._instance.exitInitializationMode()
        except Exception as error:
            raise self._status_error("refuses to start", _status_of(error), str(error)) from error

    def fetch_outputs(self) -> None:
        """One get call per type that has outputs."""
        values = self.outputs.values
        for transfer in self.gets:
            status = transfer()
            if not OK <= status <= WARNING:
                raise self.no_outputs(status)
            values[transfer.places] = transfer.view

    def send_inputs(self) -> None:
        """One set call per type of whose inputs any has changed: an FMU holds its inputs."""
        values = self.inputs.values
        for transfer in self.sets:
            given = values[transfer.places]
            now = given.tobytes()
            if now == transfer.last:
                continue
            transfer.last = now
            transfer.view[:] = given
            status = transfer()
            if not OK <= status <= WARNING:
                raise self.no_inputs(status)

    def step(self, t_ns: int, dt_ns: int) -> None:
        """Call fmi2DoStep at ``t_ns / 1e9`` seconds, computed from the count, never accumulated."""
        status = self.do_step(self.component, t_ns / 1e9, dt_ns / 1e9, 1)
        if not OK <= status <= WARNING:
            raise self.no_step(t_ns, status)

    def no_outputs(self, status: int) -> RunError:
        """Return the error of a get call that failed with an FMI status."""
        return self._status_error("gives no outputs", status)

    def no_inputs(self, status: int) -> RunError:
        """Return the error of a set call that failed with an FMI status."""
        return self._status_error("refuses its inputs", status)

    def no_step(self, t_ns: int, status: int) -> RunError:
        """Return the error of a step that failed with an FMI status."""
        return self._status_error(f"failed at {t_ns / 1e9:g} s", status)

    def close(self) -> None:
        """Terminate, free the instance, remove the extracted files.

        After fmi2Error an instance may only be freed; after fmi2Fatal nothing may be called (FMI 2.0.4, 4.2.4).
        """
        if self._instance is not None:
            instance, self._instance = self._instance, None
            if self._worst < ERROR:
                try:
                    instance.terminate()
                except Exception as error:
                    self._status_error("terminate", _status_of(error))
                    self._log(self.name, WARNING, f"terminate: {error}")
            if self._worst < FATAL:
                instance.freeInstance()
        if self._directory:
            remove_folder(Path(self._directory))
            self._directory = ""

    def _status_error(self, what: str, status: int, text: str = "no message") -> RunError:
        """Note the status, which decides what may still be called, and return the error of it."""
        self._worst = max(self._worst, status)
        return RunError(f"{self.name} {what}: {self._last_message or text}")

    def _bind(self) -> None:
        assert self._instance is not None
        library, component = self._instance.dll, self._instance.component
        self.component = ctypes.c_void_p(component)

        def function(name: str) -> Any:
            found = library[name]
            found.restype = ctypes.c_int
            return found

        def transfers(verb: str, ports: Ports) -> list[Transfer]:
            pairs = (("Real", float), ("Integer", int), ("Boolean", bool))
            made = [
                Transfer(function(f"fmi2{verb}{word}"), component, ports, kind, self._references)
                for word, kind in pairs
            ]
            return [transfer for transfer in made if transfer.count]

        self.gets = transfers("Get", self.outputs)
        self.sets = transfers("Set", self.inputs)
        self.do_step = function("fmi2DoStep")
        self.do_step.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int]

    def tune(self, name: str, value: float) -> None:
        """Set a tunable parameter between two steps."""
        kind = self.parameters.variables[self.parameters.index[name]].kind
        self._set(kind, {name: kind(value)})

    def _set_parameters(self) -> None:
        for kind in (float, int, bool):
            names = [name for name, its_kind in self._changed.items() if its_kind is kind]
            values = {name: kind(self.parameters.values[self.parameters.index[name]]) for name in names}
            if values:
                self._set(kind, values)
        if self._texts:
            self._set(str, self._texts)

    def _set(self, kind: type, values: Mapping[str, Any]) -> None:
        """Set parameters of one type."""
        assert self._instance is not None
        setters = {
            float: self._instance.setReal,
            int: self._instance.setInteger,
            bool: self._instance.setBoolean,
            str: self._instance.setString,
        }
        try:
            setters[kind]([self._references[name] for name in values], list(values.values()))
        except Exception as error:
            raise self._status_error("refuses its parameters", _status_of(error), str(error)) from error

    def _make_callbacks(self) -> fmi2CallbackFunctions:
        def logger(_environment: Any, _instance: Any, status: int, category: Any, message: Any) -> None:
            text = (message or b"").decode(errors="replace").replace("%%", "%").strip()
            if status > WARNING:
                self._last_message = text
            self._log(self.name, int(status), text)

        callbacks = fmi2CallbackFunctions()
        callbacks.logger = fmi2CallbackLoggerTYPE(logger)
        callbacks.allocateMemory = defaultCallbacks.allocateMemory
        callbacks.freeMemory = defaultCallbacks.freeMemory
        return callbacks


def _status_of(error: Exception) -> int:
    """Return the FMI status of FMPy's exception."""
    return int(getattr(error, "status", ERROR))


def _is_needed(name: str) -> bool:
    """Return whether a file of an FMU is used when it runs: its description, libraries and resources."""
    return name == DESCRIPTION or name.startswith(("binaries/", "resources/"))
