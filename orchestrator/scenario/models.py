"""The model packages a parking run is made of, by the name of their place in it."""

import controller_fmu
import vehicle_fmu
from modelkit.model import Model

MODELS: dict[str, Model] = {"vehicle": vehicle_fmu.MODEL, "controller": controller_fmu.MODEL}
