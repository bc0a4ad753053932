from typing import Any

import pytest

from fmus.native import fmu as native_fmu
from fmus.native.libraries import python_front
from fmus.native.platforms import host
from fmus.python import fmu as python_fmu
from orchestrator.scenario.models import MODELS

BUILD = {
    "python": lambda model, folder: python_fmu.build(model, folder, python_front()),
    "native": lambda model, folder: native_fmu.build(model, folder, [host()]),
    "fmi3": lambda model, folder: native_fmu.build(model, folder, [host()], fmi=3),
}


@pytest.fixture(scope="session")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Kind -> slave name -> path of its FMU."""
    folder = tmp_path_factory.mktemp("fmus")
    return {
        kind: {name: build(model, folder / kind) for name, model in MODELS.items()} for kind, build in BUILD.items()
    }
