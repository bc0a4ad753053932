"""Where each flat variable of a model is in its C structs."""

import re
from typing import Any, NamedTuple

from fmus.compiler.target.names import member_name
from modelkit.model import Model
from modelkit.variables import variables

GROUPS = ("params", "inputs", "outputs")


class Member(NamedTuple):
    """A scalar of a model: its flat name in Python's types, its place in C's."""

    group: str
    """params, inputs, outputs or state."""
    name: str
    """As in ``modelkit.variables``: ``scene.boxes[3].length``."""
    path: str
    """Below the struct of an instance: ``params.scene.boxes[2].length``."""
    kind: type
    """float, int or bool."""


def members(model: Model, groups: tuple[str, ...] = GROUPS) -> list[Member]:
    """Return the scalars of params, inputs and outputs, or of the ``groups`` asked for, in that order."""
    classes: dict[str, Any] = {group: getattr(model, group) for group in groups}
    return [
        Member(group, variable.name, member_path(group, variable.name), variable.kind)
        for group, cls in classes.items()
        for variable in variables(cls)
    ]


def member_path(group: str, name: str) -> str:
    """Return the C member of a flat variable: Python's indices begin with 1, C's with 0."""
    parts = []
    for part in name.split("."):
        field, *indices = re.split(r"[\[\]]+", part.rstrip("]"))
        parts.append(member_name(field) + "".join(f"[{int(index) - 1}]" for index in indices))
    return ".".join([group, *parts])
