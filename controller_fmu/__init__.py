"""The controller: planner, tracking laws and charts of automated parking. Knows nothing of FMI."""

from controller_fmu.parking import MODEL as PARKING
from controller_fmu.registry import APART, MODEL, SYSTEM_MODELS, SYSTEMS, System
from controller_fmu.valet import MODEL as VALET

__all__ = ["APART", "MODEL", "PARKING", "SYSTEMS", "SYSTEM_MODELS", "VALET", "System"]

globals().update({choice.name: model for choice, model in SYSTEM_MODELS.items()})
# A Python FMU of one system finds its model under this name.
