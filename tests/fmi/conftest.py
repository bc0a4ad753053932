from pathlib import Path
from typing import Any

import pytest
import toy_model

from controller_fmu import APA, APART
from controller_fmu import MODEL as CONTROLLER
from fmus.native.libraries import python_front
from fmus.python.fmu import build
from tests.fmi.built import native_fmu_of
from vehicle_fmu import MODEL as VEHICLE

MODELS = {model.name: model for model in (toy_model.MODEL, VEHICLE, CONTROLLER)}
ALL_MODELS = {**MODELS, **{model.name: model for model in map(APART.__getitem__, APART)}}
ON_EACH_CHANGE = {*MODELS, APA.name}
"""Of the standalone controllers one is enough."""


@pytest.fixture(scope="session")
def python_fmus(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Paths of the PythonFMUs of all models, by name."""
    folder, front = tmp_path_factory.mktemp("python_fmus"), python_front()
    return {name: build(model, folder, front) for name, model in MODELS.items()}


class NativeFmus(dict[str, Path]):
    """Path of each model's native FMU for this machine, built when it is first asked for."""

    def __init__(self, fmi: int = 2) -> None:
        self.fmi = fmi

    def __missing__(self, name: str) -> Path:
        self[name] = native_fmu_of(ALL_MODELS[name], self.fmi)
        return self[name]


@pytest.fixture(scope="session")
def native_fmus() -> Any:
    """Paths of the native FMUs of all models for this machine, by name."""
    return NativeFmus()


@pytest.fixture(scope="session")
def fmi3_fmus() -> Any:
    """Paths of the FMI 3.0 FMUs of all models for this machine, by name."""
    return NativeFmus(fmi=3)


@pytest.fixture(params=list(MODELS))
def model(request: pytest.FixtureRequest) -> Any:
    return MODELS[request.param]


def marked(name: str, *more: Any) -> Any:
    """Return the parameters of a test of a model, left to make release if others cover it on each change."""
    return pytest.param(name, *more, marks=[] if name in ON_EACH_CHANGE else pytest.mark.release)


@pytest.fixture(params=[marked(name) for name in ALL_MODELS])
def any_model(request: pytest.FixtureRequest) -> Any:
    """One of all models, the standalone controllers too."""
    return ALL_MODELS[request.param]
