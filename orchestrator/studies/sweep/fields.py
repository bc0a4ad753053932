"""What a study can vary: any parameter of a model, some fields of the scenario, the numbers of a fault."""

import re
from collections.abc import Sequence
from typing import Any, NamedTuple

from modelkit.signal import Signal
from modelkit.variables import Variable, variables
from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.scenario.scenario import LONGEST_STEP, Scenario
from orchestrator.inputs.text.errors import BadInput, suggestion
from orchestrator.studies.sweep.study.imported_fmu import parameters_known

TIME = Signal("s", "", 0.0, 1e6)
SCENARIO_FIELDS: dict[str, Variable] = {
    "stop_time": Variable("stop_time", float, Signal("s", "largest length of a run", 0.0, 1e6), 60.0),
    "step": Variable("step", float, Signal("s", "communication step", 1e-9, LONGEST_STEP), 0.01),
    "seed": Variable("seed", int, Signal("1", "random seed of the run", 0, 2**31 - 1), 1),
    **{
        f"decimation.{name}": Variable(f"decimation.{name}", int, Signal("1", f"decimation of the {name}", 1, 1e6), 1)
        for name in MODELS
    },
}
TRUE_OWNERS = ("target", "slot")
"""Parts of a scenario that are true whatever the models have as parameters."""
TRUE_FIELDS: dict[str, Variable] = {
    key: Variable(key, float, Signal(unit, text), 0.0)
    for key, unit, text in (
        ("target.x", "m", "where the car shall stand: x of its rear-axle midpoint"),
        ("target.y", "m", "where the car shall stand: y of its rear-axle midpoint"),
        ("target.heading", "rad", "where the car shall stand: its heading"),
        ("slot.x", "m", "x of the slot's middle"),
        ("slot.y", "m", "y of the slot's middle"),
        ("slot.heading", "rad", "direction of the slot's length"),
        ("slot.length", "m", "the slot's length"),
        ("slot.width", "m", "the slot's width"),
    )
}
FAULT_FIELDS = {"start": TIME, "stop": TIME, "delay": TIME, "probability": Signal("1", "", 0.0, 1.0)}
SIGNAL_FIELDS = ("value", "sigma")
FAULT_KEY = re.compile(r"^faults\[(\d+)\]\.(\w+)$")


class Field(NamedTuple):
    """One number that may differ from run to run; ``key`` names its column."""

    key: str
    owner: str
    """An instance's name, ``scenario``, ``target``, ``slot`` or ``faults``."""
    name: str
    place: int
    """Place among the parameters of the model, or FMU, or number of the fault from 0."""
    variable: Variable


def find_field(key: str, scenario: Scenario, file: object = None) -> Field:
    """Return the field called ``key``. Raises ``BadInput`` with close names if there is none."""
    owner, _, name = key.partition(".")
    if owner == "scene":
        owner, name = "vehicle", key
    if key in TRUE_FIELDS:
        return _true_field(key, owner, name, scenario, file)
    known_parameters = parameters_known(scenario)
    if owner in known_parameters:
        return _parameter(key, owner, name, known_parameters[owner], file)
    if key in SCENARIO_FIELDS:
        return Field(key, "scenario", key, -1, SCENARIO_FIELDS[key])
    fault = FAULT_KEY.match(key)
    if fault is not None:
        return _fault(key, int(fault[1]), fault[2], scenario, file)
    known = [
        *SCENARIO_FIELDS,
        *TRUE_FIELDS,
        *(f"{instance}.{item.name}" for instance, items in known_parameters.items() for item in items),
    ]
    hint = suggestion(key, known) or "; known are " + ", ".join(
        (*(f"{instance}.*" for instance in known_parameters), *SCENARIO_FIELDS)
    )
    raise BadInput(f"unknown{hint}", file=file, key=key)


def _parameter(key: str, owner: str, name: str, known: Sequence[Variable], file: object) -> Field:
    for place, variable in enumerate(known):
        if variable.name == name and variable.kind is str:
            raise BadInput("is a text; a study varies numbers. Set it for all runs: set", file=file, key=key)
        if variable.name == name:
            return Field(f"{owner}.{name}", owner, name, place, variable)
    raise BadInput(f"unknown{suggestion(name, [item.name for item in known], f'{owner}.')}", file=file, key=key)


def _true_field(key: str, owner: str, name: str, scenario: Scenario, file: object) -> Field:
    if getattr(scenario, owner) is None:
        raise BadInput(f"the scenario has no {owner}", file=file, key=key)
    return Field(key, owner, name, -1, TRUE_FIELDS[key])


def _fault(key: str, number: int, name: str, scenario: Scenario, file: object) -> Field:
    if not 1 <= number <= len(scenario.faults):
        raise BadInput(f"the scenario has {len(scenario.faults)} faults", file=file, key=key)
    if name in FAULT_FIELDS:
        signal = FAULT_FIELDS[name]
    elif name in SIGNAL_FIELDS:
        signal = Signal(_unit_of(scenario.faults[number - 1].signal, scenario), "")
    else:
        raise BadInput(f"expected one of {', '.join((*FAULT_FIELDS, *SIGNAL_FIELDS))}", file=file, key=key)
    return Field(key, "faults", name, number - 1, Variable(key, float, signal, 0.0))


def _unit_of(signal: str, scenario: Scenario) -> str:
    owner, _, name = signal.partition(".")
    model: Any = scenario.models.get(owner)
    known = [] if model is None else [*variables(model.outputs), *variables(model.inputs)]
    return next((item.signal.unit for item in known if item.name == name), "1")
