"""What the master steps: something with named inputs and outputs in arrays allocated once.

One instance hosts an FMU (``fmu_instance``), another the same model in process (``in_process_instance``); the
master, the faults, the log and the checks cannot tell them apart.
"""

from collections.abc import Collection, Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from modelkit.variables import Variable

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


class Scale(NamedTuple):
    """A unit in SI base units: ``value * factor + offset``."""

    factor: float
    offset: float
    exponents: tuple[int, ...]
    """Of kg, m, s, A, K, mol, cd, rad."""


class Ports:
    """The inputs, or the outputs, of an instance: variables in order, and their values in one array.

    Integers and booleans are kept as doubles, which hold every 32-bit integer exactly, so that an
    exchange, a log row and a fault are one array operation.
    """

    def __init__(
        self,
        variables: list[Variable],
        unsaid: frozenset[str] = frozenset(),
        scales: Mapping[str, Scale] = MappingProxyType({}),
    ) -> None:
        self.variables = variables
        self.unsaid = unsaid
        """Names of those whose unit the FMU does not say, which FMI 2.0 allows."""
        self.scales = scales
        """Unit -> what it is in SI base units, as far as the FMU defines its units."""
        self.direct: Mapping[str, Collection[str]] = MappingProxyType({})
        """Output -> inputs it depends on directly, as far as the FMU declares it."""
        self.unsupported: list[str] = []
        """Variables of types that are not supported here, each with its type."""
        self.used: Indices = np.empty(0, dtype=np.intp)
        """Places of the outputs that something is made of: an input, a role, a verdict."""
        self.own = len(variables)
        """How many of the variables the model has; those after them are reported under its name only."""
        self.names = [variable.name for variable in variables]
        self.index = {name: place for place, name in enumerate(self.names)}
        self.values: Array = np.array([float(variable.start) for variable in variables], dtype=np.float64)

    def indices(self, kind: type) -> Indices:
        """Return the places of the model's variables of Python type ``kind``."""
        own = self.variables[: self.own]
        return np.array([place for place, item in enumerate(own) if item.kind is kind], dtype=np.intp)

    def add_told(self, variable: Variable) -> None:
        """Add a variable that observers see under the instance's name, but that its model never gets."""
        self.index[variable.name] = len(self.variables)
        self.variables.append(variable)
        self.names.append(variable.name)
        self.values = np.append(self.values, float(variable.start))


class FmuInstance(Protocol):
    """One model in the co-simulation. Calls come in the order of the methods, from one thread."""

    name: str
    inputs: Ports
    outputs: Ports
    parameters: Ports
    """Parameters with the values they have in this run."""
    identity: str
    """GUID of the FMU, or what says which model this is."""
    has_variable_step: bool
    """Whether its steps may differ in length (``canHandleVariableCommunicationStepSize``)."""

    def initialize(self, stop_ns: int) -> None:
        """Enter initialization; afterwards outputs can be fetched and inputs sent."""

    def start(self) -> None:
        """Leave initialization: time is zero and runs from here on."""

    def fetch_outputs(self) -> None:
        """Bring ``outputs.values`` up to date."""

    def send_inputs(self) -> None:
        """Hand ``inputs.values`` to the model."""

    def step(self, t_ns: int, dt_ns: int) -> None:
        """Move on from ``t_ns`` by ``dt_ns``. Raises ``RunError`` if the model refuses."""

    def close(self) -> None:
        """Terminate and free; may be called at any time, and twice."""


def all_values(instances: Sequence[FmuInstance]) -> Array:
    """Return one array of all inputs and outputs, instance by instance, of which each port's ``values`` are a part.

    Whoever looks at everything copies one row instead of one for each port. May be called again: an array
    already shared by just these instances is returned as it is.
    """
    ports = [ports for instance in instances for ports in (instance.inputs, instance.outputs)]
    size = sum(len(item.values) for item in ports)
    bases = {id(item.values.base) for item in ports}
    shared = ports[0].values.base if ports else None
    if len(bases) == 1 and shared is not None and len(shared) == size:
        return shared
    shared = np.concatenate([np.empty(0), *(item.values for item in ports)])
    for item, part in zip(ports, places_of(instances), strict=True):
        item.values = shared[part]
    return shared


def places_of(instances: Sequence[FmuInstance]) -> list[slice]:
    """Return where the inputs, then the outputs, of each instance are in :func:`all_values`."""
    found, at = [], 0
    for instance in instances:
        for ports in (instance.inputs, instance.outputs):
            found.append(slice(at, at + len(ports.values)))
            at += len(ports.values)
    return found
