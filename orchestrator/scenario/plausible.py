"""What a car that parks may plausibly be given: beyond it a number is allowed, but said.

Each parameter has a hard range, outside which it is refused (``Signal.low``, ``Signal.high``). Beside that stands what
is plausible: by its unit, widened where the default itself is large.
"""

import math
from collections.abc import Iterator, Mapping

from modelkit.variables import Variable, variables
from orchestrator.scenario.models import MODELS
from orchestrator.scenario.scenario import Scenario
from orchestrator.text.errors import BadInput, shown
from orchestrator.text.quantities import number

LARGEST: Mapping[str, float] = {
    "m": 10e3,
    "rad": 100.0,
    "s": 36e3,
    "m/s": 60.0,
    "rad/s": 100.0,
    "m/s2": 100.0,
    "kg": 60e3,
    "N": 200e3,
}
"""Unit -> the largest size that anything here plausibly has."""
UNITS = {"x": "m", "y": "m", "length": "m", "width": "m", "heading": "rad"}
"""Of the numbers of target and slot."""


def plausible(variable: Variable) -> tuple[float, float]:
    """Return the plausible range of a parameter, in SI: within its hard one."""
    low, high = variable.signal.low, variable.signal.high
    most = LARGEST.get(variable.signal.unit, math.inf)
    if variable.kind is float and most < math.inf:
        most = max(most, 10.0 * abs(variable.start))
    return max(low, -most), min(high, most)


def implausible(scenario: Scenario) -> list[str]:
    """Return a sentence for each number of a scenario that is allowed but hardly meant."""
    return [*_parameters(scenario), *_places(scenario), *_faults(scenario)]


def is_implausible(value: float, variable: Variable) -> str:
    """Return what is said of a parameter's value, empty if it is plausible."""
    low, high = plausible(variable)
    if low <= value <= high or value == variable.start:
        return ""
    return _sentence(variable.name, value, low, high, variable.signal.unit)


def _parameters(scenario: Scenario) -> Iterator[str]:
    for owner, model in MODELS.items():
        given = getattr(scenario, owner)
        for variable in variables(model.params):
            if variable.name in given:
                text = is_implausible(float(given[variable.name]), variable)
                if text:
                    yield f"{owner}.{text}"


def _places(scenario: Scenario) -> Iterator[str]:
    for name in ("target", "slot"):
        part = getattr(scenario, name)
        for key, value in (part.model_dump() if part is not None else {}).items():
            unit = UNITS.get(key, "")
            if unit and abs(value) > LARGEST[unit]:
                yield _sentence(f"{name}.{key}", value, -LARGEST[unit], LARGEST[unit], unit)


def _faults(scenario: Scenario) -> Iterator[str]:
    for place, fault in enumerate(scenario.faults, start=1):
        unit = _unit_of(fault.signal)
        for key in ("value", "sigma"):
            given = getattr(fault, key)
            try:
                size = abs(number(given, unit, any_value=True)) if given is not None else 0.0
            except BadInput:
                continue
            if math.isfinite(size) and size > LARGEST.get(unit, math.inf):
                yield f"faults[{place}].{key} = {shown(given)} is beyond what is plausible for a signal in {unit}"


def _unit_of(signal: str) -> str:
    owner, _, name = signal.partition(".")
    if owner not in MODELS:
        return "1"
    known = [*variables(MODELS[owner].outputs), *variables(MODELS[owner].inputs)]
    return next((item.signal.unit for item in known if item.name.startswith(name)), "1")


def _sentence(name: str, value: float, low: float, high: float, unit: str) -> str:
    return f"{name} = {value:g} {unit} is beyond what is plausible, {low:g} to {high:g} {unit}"
