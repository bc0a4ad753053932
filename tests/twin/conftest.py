from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from fmus.native.libraries import python_front
from fmus.python import fmu as python_fmu
from orchestrator.inputs.scenario.models import MODELS
from tests.fmi.built import native_fmu_of

BUILD: dict[str, Callable[[Any, Path], Path]] = {
    "python": lambda model, folder: python_fmu.build(model, folder, python_front()),
    "native": lambda model, _: native_fmu_of(model),
    "fmi3": lambda model, _: native_fmu_of(model, fmi=3),
}


class Built(dict[str, dict[str, Path]]):
    """Kind -> slave name -> path of its FMU, built when a test asks for the kind."""

    def __init__(self, folder: Path) -> None:
        super().__init__()
        self._folder = folder

    def __missing__(self, kind: str) -> dict[str, Path]:
        self[kind] = {name: BUILD[kind](model, self._folder / kind) for name, model in MODELS.items()}
        return self[kind]


@pytest.fixture(scope="session")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> Built:
    """Kind -> slave name -> path of its FMU."""
    return Built(tmp_path_factory.mktemp("fmus"))
