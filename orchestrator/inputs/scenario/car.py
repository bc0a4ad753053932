"""The car of a scenario: given once, for the vehicle and for the controller's model of it.

``car: zhang2022`` is a shipped car, or a file, also a vehicle parameter file of CommonRoad.
``car: {extends: zhang2022, width: 1.9}`` is one with something changed,
``car: {width: 1.9}`` changes the car that the base scenario has. What ``vehicle`` and ``controller`` say of their
``car`` themselves stands above it: so a controller believes something else than is true.
"""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from modelkit.car import Car
from modelkit.variables import flatten, variables
from orchestrator.inputs.scenario.commonroad import commonroad_car, is_commonroad
from orchestrator.inputs.scenario.files import LIBRARY, find_file
from orchestrator.inputs.scenario.flat_names import FlatLayer, flatten_layer, merge_flat
from orchestrator.inputs.text.errors import BadInput, format_value, suggestion_or_choices
from orchestrator.inputs.text.quantities import scalar
from orchestrator.inputs.text.yaml_file import read_mapping

CAR = variables(Car)
FILE_KEYS = ("name", "title", "description", "source", "car", "vehicle")
BASE = "extends"
Layer = tuple[dict[str, Any], object]
"""What one file says, and the file."""


class VehicleDefinition(NamedTuple):
    """What a scenario says of its car."""

    name: str | None
    """Of the car it is made from."""
    reported: dict[str, object]
    """Parameter of ``Car`` -> value, for both models."""
    plant: tuple[Layer, ...] = ()
    """Parameters of the vehicle alone: masses, tyres, lags."""

    def layers(self, owner: str) -> list[Layer]:
        """Return the layers of the car's parameters for the model ``owner``, lowest first."""
        both: Layer = ({owner: {f"car.{name}": value for name, value in self.reported.items()}}, None)
        return [*(self.plant if owner == "vehicle" else ()), both]


def vehicle_definition(said: list[tuple[object, object]], folder: Path) -> VehicleDefinition:
    """Return the car after all layers of a scenario, each (what it says of the car, its file), lowest first.

    A relative path is beside the file that contains it; on the command line it is here, else in ``folder``.
    """
    car = VehicleDefinition(None, {})
    for given, file in said:
        if given is None:
            continue
        if not isinstance(given, str | Mapping):
            text = f"{format_value(given)}: expected the name of a car, a file, or a mapping of what is different"
            raise BadInput(text, file=file, key="car")
        changes = {BASE: given} if isinstance(given, str) else dict(given)
        base = changes.pop(BASE, None)
        if base is not None:
            is_here = isinstance(base, str) and Path(base).is_file()
            beside = file.parent if isinstance(file, Path) else Path() if is_here else folder
            if not isinstance(base, str):
                raise BadInput(
                    f"{format_value(base)}: expected the name of a car, or a file", file=file, key=f"car.{BASE}"
                )
            found = find_file(base, "cars", "car", beside, file=file, key="car")
            car = (_shipped_car if found.is_relative_to(LIBRARY) else _car_in)(found, base)
        new = _numbers(changes, file)
        car = car._replace(reported=merge_flat(car.reported, new.values, new.arrays))
    return car


def with_said(before: object, name: str, value: object) -> dict[str, object]:
    """Return what is said of a car with more: the car itself (no ``name``), or a parameter of it."""
    old = {BASE: before} if isinstance(before, str) else dict(before) if isinstance(before, Mapping) else {}
    new = value if not name and isinstance(value, Mapping) else {name or BASE: value}
    return {**old, **new}


def car_parameters(car: Car) -> dict[str, Any]:
    """Return the flat parameters that describe ``car`` to a model."""
    return {f"car.{item.name}": value for item, value in zip(CAR, flatten(car), strict=True)}


def _car_in(file: Path, name: str) -> VehicleDefinition:
    content = read_mapping(file)
    if is_commonroad(content):
        content = commonroad_car(content, file)
    for key in content:
        if key not in FILE_KEYS:
            hint = suggestion_or_choices(str(key), FILE_KEYS)
            raise BadInput(f"unknown{hint}", file=file, key=key)
    vehicle: Layer = ({"vehicle": content.get("vehicle")}, file)
    return VehicleDefinition(name, _numbers(content.get("car") or {}, file).values, (vehicle,))


_shipped_car = cache(_car_in)
"""Of a file that does not change while this process lives; nobody changes its layers."""


def _numbers(section: object, file: object) -> FlatLayer:
    """Return what is written of a car, in SI units."""
    if not isinstance(section, Mapping):
        raise BadInput(f"{format_value(section)}: expected a mapping of parameters", file=file, key="car")
    known = {item.name: item._replace(name=f"car.{item.name}") for item in CAR}
    flat = flatten_layer(section, known, file=file, key="car")
    return flat._replace(values={name: scalar(value, known[name], file=file) for name, value in flat.values.items()})
