"""The numbers that somebody chose: parameters' defaults and constants of model code, beside what they were.

A number changed shows as a difference of ``numbers.json``: ``pytest tests/golden --update``, then ``git diff``.
Scenarios do not tell all of them: many are limits that a drive without trouble never comes near.
"""

import ast
import inspect
import json
from importlib import import_module
from pathlib import Path
from pkgutil import walk_packages
from types import ModuleType
from typing import Any

import pytest

import controller_fmu
import vehicle_fmu
from modelkit.variables import variables

FILE = Path(__file__).parent / "numbers.json"
MODELS = (vehicle_fmu.MODEL, controller_fmu.MODEL, controller_fmu.APA)
Number = float | int


def numbers() -> dict[str, Any]:
    """Return model or module -> name -> number, or list of numbers."""
    found = {model.name: {item.name: plain(item.start) for item in variables(model.params)} for model in MODELS}
    for module in modules():
        constants = {item: plain(vars(module)[item]) for item in assigned(inspect.getsource(module))}
        kept = {item: value for item, value in constants.items() if value is not None}
        if kept:
            found[module.__name__] = kept
    return found


def modules() -> list[ModuleType]:
    """Return all files of the models, whoever imports them."""
    packages = (vehicle_fmu, controller_fmu)
    names = [item.name for package in packages for item in walk_packages(package.__path__, f"{package.__name__}.")]
    return [import_module(name) for name in sorted([*(package.__name__ for package in packages), *names])]


def assigned(text: str) -> list[str]:
    """Return the names of the constants that a module assigns."""
    targets = [
        target
        for node in ast.parse(text).body
        for target in (node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)])
    ]
    return [target.id for target in targets if isinstance(target, ast.Name) and target.id.isupper()]


def plain(value: Any) -> Any:
    """Return numbers, and tuples of nothing else, as JSON writes them; None for anything else."""
    if isinstance(value, int | float):
        return int(value) if isinstance(value, int) else round(value, 12)
    if isinstance(value, tuple) and not hasattr(value, "_fields"):
        items = [plain(item) for item in value]
        return None if None in items else items
    return None


def written(group: str, items: dict[str, Any]) -> str:
    """Return a group as JSON, a line for each name."""
    lines = ",\n".join(f"  {json.dumps(name)}: {json.dumps(value)}" for name, value in items.items())
    return f"{json.dumps(group)}: {{\n{lines}\n}}"


@pytest.fixture(scope="module")
def kept(request: pytest.FixtureRequest) -> dict[str, Any]:
    if request.config.getoption("--update"):
        FILE.write_text("{\n" + ",\n".join(written(*item) for item in numbers().items()) + "\n}\n", encoding="utf-8")
    return json.loads(FILE.read_text(encoding="utf-8"))


def changes(kept: dict[str, Any]) -> dict[str, tuple[Any, Any]]:
    """Return name -> (what it was, what it is) of the numbers that are another; one that is new has not changed."""
    found, was = flat(numbers()), flat(kept)
    return {name: (was[name], found[name]) for name in found.keys() & was.keys() if found[name] != was[name]}


def flat(groups: dict[str, Any]) -> dict[str, Any]:
    return {f"{group}: {name}": value for group, items in groups.items() for name, value in items.items()}


def test_numbers_are_what_they_were(kept: dict[str, Any]) -> None:
    changed = changes(kept)
    assert not changed, "\n".join(f"{name}: {new}, was {old}" for name, (old, new) in sorted(changed.items()))


def test_the_record_knows_nearly_all_of_them(kept: dict[str, Any]) -> None:
    assert len(flat(numbers()).keys() & flat(kept).keys()) > 0.95 * len(flat(numbers()))


def test_they_are_many() -> None:
    found = numbers()
    assert sum(map(len, found.values())) > 500
    assert found["controller_fmu.guo2015.prompts"]["MOVING_SPEED"] == 0.05
    assert found["Controller"]["guo2015.k4"] == 4.0
