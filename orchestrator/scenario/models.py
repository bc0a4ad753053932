"""The model packages a parking run is made of, by the name of their place in it."""

from collections.abc import Mapping

import controller_fmu
import vehicle_fmu
from modelkit.model import Model

MODELS: dict[str, Model] = {"vehicle": vehicle_fmu.MODEL, "controller": controller_fmu.MODEL}
"""Those of a run whose scenario asks for nothing else."""
APART: dict[str, tuple[int, Model]] = {
    choice.name.lower(): (int(choice), model) for choice, model in controller_fmu.APART.items()
}
"""Values of ``controller.system`` for which the controller is a model of its own."""


def models_for(controller: Mapping[str, object]) -> dict[str, Model]:
    """Return the models of a run, by the system that the controller's parameters choose: a name or a number."""
    asked = controller.get("system")
    for name, (number, model) in APART.items():
        if asked == number or (isinstance(asked, str) and asked.lower() == name):
            return {**MODELS, "controller": model}
    return MODELS
