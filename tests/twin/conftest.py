import pytest

from fmus import native_fmu, python_fmu
from fmus.platforms import host
from orchestrator.models import MODELS

BUILD = {
    "python": python_fmu.build,
    "native": lambda model, folder: native_fmu.build(model, folder, [host()]),
}


@pytest.fixture(scope="session")
def fmus(tmp_path_factory):
    """Kind -> slave name -> path of its FMU."""
    folder = tmp_path_factory.mktemp("fmus")
    return {
        kind: {name: build(model, folder / kind) for name, model in MODELS.items()} for kind, build in BUILD.items()
    }
