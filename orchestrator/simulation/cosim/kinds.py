"""The kinds of FMU that our models are driven as; imports little, for commands that only offer them."""

from fmus.native.compilers import can_compile

KINDS = ("python", "native")


def default_kind() -> str:
    """Return ``native``, the faster kind, where it can be built."""
    return "native" if can_compile() else "python"


def fastest_kind() -> str:
    """Return what computes a run soonest: ``native`` where it can be built, else the models in process."""
    return "native" if can_compile() else "none"
