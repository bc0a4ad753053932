"""Parking system: ultrasonic echoes to a map of landmarks, slots in it, a path into one, and a monitor over all."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from controller_fmu.parking.standalone import MODEL

__all__ = ["MODEL"]


def __getattr__(name: str) -> Any:
    """Return the model, which is imported when it is first used."""
    if name == "MODEL":
        from controller_fmu.parking.standalone import MODEL

        return MODEL
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
