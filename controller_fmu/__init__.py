"""The controller: planner, tracking laws and charts of automated parking. Knows nothing of FMI."""

from typing import TYPE_CHECKING, Any

from controller_fmu.registry import APART, MODEL, SYSTEM_MODELS, SYSTEMS, System

if TYPE_CHECKING:
    from controller_fmu.parking.standalone import MODEL as APA
    from controller_fmu.policy.standalone import MODEL as POLICY

__all__ = ["APA", "APART", "MODEL", "POLICY", "SYSTEMS", "SYSTEM_MODELS", "System"]

globals().update({choice.name: model for choice, model in SYSTEM_MODELS.items()})
# A Python FMU of one system finds its model under this name.


def __getattr__(name: str) -> Any:
    """Return the model of a standalone system, which is imported when it is first used."""
    found = next((choice for choice in APART if choice.name == name), None)
    if found is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return APART[found]
