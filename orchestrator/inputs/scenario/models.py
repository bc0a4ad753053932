"""The model packages a parking run is made of, by the name of their place in it."""

from collections.abc import Mapping

import controller_fmu
import vehicle_fmu
from modelkit.model import Model
from orchestrator.inputs.text.errors import MIGRATE, BadInput
from orchestrator.inputs.text.renamed_names import VALUES

MODELS: dict[str, Model] = {"vehicle": vehicle_fmu.MODEL, "controller": controller_fmu.MODEL}
"""Those of a run whose scenario asks for nothing else."""
APART = {choice.name.lower(): choice for choice in controller_fmu.APART}
"""Values of ``controller.system`` for which the controller is a model of its own, by name."""


def apart_models() -> dict[str, Model]:
    """Return name -> model of the controllers of their own; imports all of them.

    Those that are the code of another one with longer arrays are left out: they have nothing of their own to show.
    """
    found = {name: controller_fmu.APART[choice] for name, choice in APART.items()}
    return {name: model for name, model in found.items() if not model.substitutes}


def models_for(controller: Mapping[str, object]) -> dict[str, Model]:
    """Return the models of a run, by the system that the controller's parameters choose: a name or a number.

    Raises ``BadInput`` for a name of an earlier version.
    """
    asked = controller.get("system")
    now = VALUES["system"].get(asked.lower()) if isinstance(asked, str) else None
    if now:
        raise BadInput(f"{asked!r} is called {now} now{MIGRATE}", key="controller.system")
    for name, choice in APART.items():
        if asked == int(choice) or (isinstance(asked, str) and asked.lower() == name):
            return {**MODELS, "controller": controller_fmu.APART[choice]}
    return MODELS
