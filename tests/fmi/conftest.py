from pathlib import Path
from typing import Any

import pytest
import toy_model

from controller_fmu import MODEL as CONTROLLER
from controller_fmu import VALET
from fmus.native import fmu as native_fmu
from fmus.native.libraries import python_front
from fmus.native.platforms import host
from fmus.python.fmu import build
from vehicle_fmu import MODEL as VEHICLE

MODELS = {model.name: model for model in (toy_model.MODEL, VEHICLE, CONTROLLER)}
ALL_MODELS = {**MODELS, VALET.name: VALET}


@pytest.fixture(scope="session")
def python_fmus(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Paths of the PythonFMUs of all models, by name."""
    folder, front = tmp_path_factory.mktemp("python_fmus"), python_front()
    return {name: build(model, folder, front) for name, model in MODELS.items()}


class NativeFmus(dict[str, Path]):
    """Path of each model's native FMU for this machine, built when it is first asked for."""

    def __init__(self, folder: Any, fmi: Any = 2) -> None:
        self.folder, self.fmi = folder, fmi

    def __missing__(self, name: str) -> Path:
        self[name] = native_fmu.build(ALL_MODELS[name], self.folder, [host()], fmi=self.fmi)
        return self[name]


@pytest.fixture(scope="session")
def native_fmus(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Paths of the native FMUs of all models for this machine, by name."""
    return NativeFmus(tmp_path_factory.mktemp("native_fmus"))


@pytest.fixture(scope="session")
def fmi3_fmus(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Paths of the FMI 3.0 FMUs of all models for this machine, by name."""
    return NativeFmus(tmp_path_factory.mktemp("fmi3_fmus"), fmi=3)


@pytest.fixture(params=list(MODELS))
def model(request: pytest.FixtureRequest) -> Any:
    return MODELS[request.param]


@pytest.fixture(params=list(ALL_MODELS))
def any_model(request: pytest.FixtureRequest) -> Any:
    """One of all models, the controller apart too."""
    return ALL_MODELS[request.param]
