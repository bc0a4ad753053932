"""What a learned policy drives through: its observation, its actions, and when the car counts as parked."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from controller_fmu.policy.standalone import MODEL

__all__ = ["MODEL"]


def __getattr__(name: str) -> Any:
    """Return the model, which is imported when it is first used."""
    if name == "MODEL":
        from controller_fmu.policy.standalone import MODEL

        return MODEL
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
