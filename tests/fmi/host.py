"""One FMU instance on FMPy, by variable name, with its log kept."""

import itertools
import random
import shutil
import sys
import tempfile
from ctypes import byref
from typing import Any

import fmpy
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.logging import addLoggerProxy

from fmus.contents.variables import limits
from orchestrator.simulation.cosim.local_instance import LOADING

OK, WARNING, DISCARD, ERROR, FATAL = range(5)


NUMBERS = itertools.count()


class Host:
    def __init__(self, path: Any, name: Any = None) -> None:
        self.name = name or f"instance {next(NUMBERS)}"
        self.folder = tempfile.mkdtemp(prefix="fmu_")
        fmpy.extract(str(path), self.folder)
        self.description = fmpy.read_model_description(self.folder)
        self.refs = {v.name: v.valueReference for v in self.description.modelVariables}
        self.types = {v.name: v.type for v in self.description.modelVariables}
        self.log: list[tuple[int, str, str]] = []
        self.callbacks = fmi2CallbackFunctions()
        self.callbacks.logger = fmi2CallbackLoggerTYPE(self._logger)
        self.callbacks.allocateMemory = defaultCallbacks.allocateMemory
        self.callbacks.freeMemory = defaultCallbacks.freeMemory
        addLoggerProxy(byref(self.callbacks))
        with LOADING:
            self.fmu = FMU2Slave(
                guid=self.description.guid,
                modelIdentifier=self.description.coSimulation.modelIdentifier,
                unzipDirectory=self.folder,
                instanceName=self.name,
            )
        self.fmu.instantiate(callbacks=self.callbacks, loggingOn=True)

    def _logger(self, environment: Any, name: Any, status: Any, category: Any, message: Any) -> None:
        self.log.append((status, (category or b"").decode(), message.decode()))

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: Any) -> None:
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)

    def initialize(self, start: Any = 0.0, stop: Any = None, **params: Any) -> None:
        self.fmu.setupExperiment(startTime=start, stopTime=stop)
        self.set(params)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def set(self, values: Any) -> None:
        for fmi_type in ("Real", "Integer", "Boolean"):
            names = [name for name in values if self.types[name] == fmi_type]
            if names:
                setter = getattr(self.fmu, f"set{fmi_type}")
                setter([self.refs[name] for name in names], [values[name] for name in names])

    def get(self, names: Any) -> Any:
        found: dict[str, Any] = {}
        for fmi_type in ("Real", "Integer", "Boolean"):
            chosen = [name for name in names if self.types[name] == fmi_type]
            if chosen:
                values = getattr(self.fmu, f"get{fmi_type}")([self.refs[name] for name in chosen])
                found.update(zip(chosen, map(bool, values) if fmi_type == "Boolean" else values, strict=True))
        return [found[name] for name in names]

    def outputs(self) -> Any:
        """Return the values of all outputs and local variables, in the order of the model."""
        return self.get(calculated(self.description))

    def step(self, time: Any, size: Any) -> Any:
        """Return the status of fmi2DoStep."""
        status = []
        call = self.fmu.fmi2DoStep
        try:
            call(self.fmu.component, time, size, 1)
        except Exception as error:
            status.append(getattr(error, "status", error))
        return status[0] if status else OK


def calculated(description: Any) -> Any:
    """Return the names of outputs and local variables in the order of their value references."""
    found = [v for v in description.modelVariables if v.causality in ("output", "local")]
    return [v.name for v in sorted(found, key=lambda v: v.valueReference)]


def slaves(host: Any) -> Any:
    """Return the Python objects behind a host's instance: after a reset the last of them is in use."""
    modules = [module for name, module in sys.modules.items() if name.startswith("fmu_") and name.endswith(".binary")]
    return [slave for module in modules for slave in module.KEPT if slave.instance_name == host.name]


def random_inputs(known: Any, seed: Any, count: Any) -> Any:
    """Return ``count`` dicts of input values inside their limits; the same for the same seed."""
    source = random.Random(seed)
    chosen = [variable for variable in known if variable.causality == "input"]
    return [{variable.name: _random_value(source, variable) for variable in chosen} for _ in range(count)]


def _random_value(source: Any, variable: Any) -> Any:
    if variable.kind is bool:
        return source.random() < 0.2
    low, high = limits(variable)
    low, high = -2.0 if low is None else low, 2.0 if high is None else high
    return source.randint(int(low), int(high)) if variable.kind is int else source.uniform(low, high)
