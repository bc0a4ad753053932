import pytest
import toy_model

from controller_fmu import MODEL as CONTROLLER
from fmus.python_fmu import build
from vehicle_fmu import MODEL as VEHICLE

MODELS = {model.name: model for model in (toy_model.MODEL, VEHICLE, CONTROLLER)}


@pytest.fixture(scope="session")
def python_fmus(tmp_path_factory):
    """Paths of the PythonFMUs of all models, by name."""
    folder = tmp_path_factory.mktemp("python_fmus")
    return {name: build(model, folder) for name, model in MODELS.items()}


@pytest.fixture(params=list(MODELS))
def model(request):
    return MODELS[request.param]
