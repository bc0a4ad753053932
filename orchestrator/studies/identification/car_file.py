"""The car of a scenario with identified parameters: ``car: FILE.yaml``."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from fmus.files import write_whole
from orchestrator.inputs.scenario.car import vehicle_definition
from orchestrator.inputs.scenario.flat_names import flatten_section
from orchestrator.inputs.text.errors import BadInput, suggestion_or_choices
from orchestrator.inputs.text.quantities import scalar
from orchestrator.studies.identification.compiled_vehicle import PARAMETERS

CAR = "car."
ELEMENT = re.compile(r"([^\[\]]+)\[(\d+)\]")


class BaseCar(NamedTuple):
    """The vehicle as far as it is known before the log."""

    name: str
    """Of the car; empty: the defaults."""
    values: dict[str, float]
    """Parameters of the vehicle that the car, or the user, sets."""


def base_car(name: str, settings: Mapping[str, str]) -> BaseCar:
    """Return a car, shipped or of a file, with ``settings`` (``car.wheelbase``: ``2.62``). Raises ``BadInput``."""
    values: dict[str, float] = {}
    if name:
        car = vehicle_definition([(name, None)], Path())
        for section, file in car.layers("vehicle"):
            flat = flatten_section(section.get("vehicle") or {}, PARAMETERS, file=file, key="vehicle")
            values |= {key: float(scalar(value, PARAMETERS[key], file=file)) for key, value in flat.items()}
    for key, text in settings.items():
        short = key.removeprefix("vehicle.")
        if short not in PARAMETERS:
            raise BadInput(
                f"{key}: no such parameter of the vehicle{suggestion_or_choices(short, PARAMETERS)}", key="--set"
            )
        values[short] = float(scalar(text, PARAMETERS[short]._replace(name=f"--set {key}")))
    return BaseCar(name, values)


def write_car(path: Path, base: BaseCar, identified: Mapping[str, float], source: str) -> None:
    """Write the car with the identified parameters."""
    values = {**base.values, **identified}
    if any(name.startswith("odometry.") for name in identified):
        values["odometry.ideal"] = 0.0
    shown = {name: _yaml_value(name, value) for name, value in values.items()}
    content: dict[str, Any] = {"title": f"{base.name or 'car'}, identified", "source": source}
    own = {name.removeprefix(CAR): value for name, value in shown.items() if name.startswith(CAR)}
    content |= {"car": _sections(own)} if own else {}
    plant = {name: value for name, value in shown.items() if not name.startswith(CAR)}
    content |= {"vehicle": _sections(plant)} if plant else {}
    write_whole(path, yaml.safe_dump(content, sort_keys=False, default_flow_style=None, width=120))


def _yaml_value(name: str, value: float) -> Any:
    variable = PARAMETERS[name]
    states = variable.signal.states
    return states(int(value)).name.lower() if states is not None else variable.kind(value)


def _sections(flat: Mapping[str, Any]) -> dict[str, Any]:
    """Return sections of flat names; entries of an array become a list as far as it is complete from the first on."""
    tree: dict[str, Any] = {}
    for name, value in flat.items():
        place = tree
        *sections, last = name.split(".")
        for section in sections:
            place = place.setdefault(section, {})
        place[last] = value
    return _with_lists(tree)


def _with_lists(tree: Mapping[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, value in tree.items():
        match = ELEMENT.fullmatch(key)
        inner = _with_lists(value) if isinstance(value, dict) else value
        entries = [] if match is None else found.get(match[1], [])
        if match is not None and int(match[2]) == len(entries) + 1:
            found[match[1]] = [*entries, inner]
        else:
            found[key] = inner
    return found
