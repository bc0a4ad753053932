from typing import Any

import pytest

from fmus.native.libraries import python_front
from fmus.python import fmu as python_fmu
from orchestrator.inputs.scenario.models import MODELS
from tests.fmi.built import native_fmu_of

BUILD = {
    "python": lambda model, folder: python_fmu.build(model, folder, python_front()),
    "native": lambda model, _: native_fmu_of(model),
    "fmi3": lambda model, _: native_fmu_of(model, fmi=3),
}


@pytest.fixture(scope="session")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Kind -> slave name -> path of its FMU."""
    folder = tmp_path_factory.mktemp("fmus")
    return {
        kind: {name: build(model, folder / kind) for name, model in MODELS.items()} for kind, build in BUILD.items()
    }
