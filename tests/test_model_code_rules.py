"""Model files import what both CPython and C have; all else about them the translator itself says."""

import ast
from pathlib import Path
from typing import Any

import pytest

from fmus.compiler import translate
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


@pytest.mark.parametrize("name", MODELS)
def test_model_translates(name: Any) -> None:
    assert f"void {MODELS[name].name}_step(" in translate(MODELS[name]).source


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
