"""Model files import what both CPython and C have; all else about them the translator itself says."""

import ast
import re
from pathlib import Path
from typing import Any

import pytest

from fmus.native.sources import translate_model
from orchestrator.inputs.scenario.models import MODELS

ROOT = Path(__file__).parents[1]
ROOMS = ("modelkit", "vehicle_fmu", "controller_fmu")
NO_MODEL_CODE = (
    *("modelkit/model.py", "modelkit/variables.py", "modelkit/connections.py", "modelkit/terminals.py"),
    *("modelkit/store.py", "modelkit/assembly.py", "modelkit/states.py"),
    *("modelkit/composition.py", "controller_fmu/registry.py"),
    *("controller_fmu/parking/standalone.py", "controller_fmu/parking/large_map.py"),
    "controller_fmu/policy/standalone.py",
)
STANDARD = {"math", "typing", "enum"}
KIT = {
    "modelkit.car",
    "modelkit.store",
    "modelkit.signal",
    "modelkit.states",
    "modelkit.maths",
    "modelkit.random",
    "modelkit.vocabulary",
    "modelkit.geometry",
}


def model_files() -> Any:
    files = (path for room in ROOMS for path in sorted((ROOT / room).rglob("*.py")))
    names = (path.relative_to(ROOT).as_posix() for path in files if path.name != "__init__.py")
    return [name for name in names if name not in NO_MODEL_CODE]


def faults(source: Any, room: Any) -> Any:
    """Return 'line: import' of everything that a model file in ``room`` may not import."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found += [f"{node.lineno}: {alias.name}" for alias in node.names if alias.name not in STANDARD]
        if isinstance(node, ast.ImportFrom):
            module = node.module or ""
            own = module.split(".")[0] == room and room != "modelkit"
            if node.level or not (own or module in STANDARD | KIT) or any(item.name == "*" for item in node.names):
                found.append(f"{node.lineno}: {'.' * node.level}{module}")
    return found


@pytest.mark.parametrize("name", model_files())
def test_model_file_imports_model_files(name: Any) -> None:
    assert faults((ROOT / name).read_text(), name.split("/")[0]) == []


UNIT_OR_SIGN = re.compile(r"\[[^\]]+\]|\b1(\.0)?\b")
"""A unit in brackets, or the values of a sign or side."""


def functions_without_unit(source: str) -> list[str]:
    """Return the public functions with float arguments or result whose docstring states neither unit nor sign."""
    public = [item for item in ast.parse(source).body if isinstance(item, ast.FunctionDef) and item.name[0] != "_"]
    return [
        item.name
        for item in public
        if any(
            isinstance(of, ast.Name) and of.id == "float"
            for of in (*(a.annotation for a in item.args.args), item.returns)
        )
        and not UNIT_OR_SIGN.search(ast.get_docstring(item) or "")
    ]


@pytest.mark.parametrize("name", [name for name in model_files() if name.startswith("controller_fmu/parking/")])
def test_public_functions_of_the_parking_system_state_their_units(name: str) -> None:
    assert functions_without_unit((ROOT / name).read_text(encoding="utf-8")) == []


def test_a_function_without_a_unit_is_found() -> None:
    source = 'def speed(x: float) -> float:\n    """Return the speed{}."""\n    return x\n'
    assert functions_without_unit(source.format("")) == ["speed"]
    assert functions_without_unit(source.format(" [m/s]")) == []


@pytest.mark.parametrize("name", MODELS)
def test_model_translates(name: Any) -> None:
    assert f"void {MODELS[name].name}_step(" in translate_model(MODELS[name]).source


@pytest.mark.parametrize(
    "line",
    [
        "import numpy",
        "import os.path",
        "from vehicle_fmu.bodies.body import slip",
        "from modelkit.variables import flatten",
        "from . import path",
        "from math import *",
        "def f() -> None:\n    import random",
    ],
)
def test_the_rule_finds_what_it_should(line: str) -> None:
    assert len(faults(f"import math\nfrom enum import IntEnum\n{line}\n", "controller_fmu")) == 1
