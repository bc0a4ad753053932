"""A valet: drives to a goal pose among the polygons of a map, on paths of the planner."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from controller_fmu.valet.standalone import MODEL

__all__ = ["MODEL"]


def __getattr__(name: str) -> Any:
    """Return the model, which is imported when it is first used."""
    if name == "MODEL":
        from controller_fmu.valet.standalone import MODEL

        return MODEL
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
