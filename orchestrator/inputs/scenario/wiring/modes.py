"""A mode of a third-party FMU as listed by the user, for the coverage of tests: its states and its transitions."""

import re

from pydantic import BaseModel, ConfigDict, model_validator

from orchestrator.inputs.text.errors import BadInput, suggestion
from orchestrator.inputs.text.quantities import Whole

ARROW = re.compile(r"\s*->\s*")
ANY = "any state"
"""Written as the source of a transition that leaves every state."""


class ModeList(BaseModel):
    """What there is of a mode; what is not listed is known once it was seen."""

    model_config = ConfigDict(extra="forbid")

    states: dict[str, Whole] = {}
    """Name -> value; those that its FMU, or the role ``mode``, names by default."""
    transitions: list[str] = []
    """``idle -> first arc``, and ``any state -> lost``: all that there are."""

    @model_validator(mode="after")
    def _fits(self) -> "ModeList":
        for text, ends in zip(self.transitions, self.pairs, strict=True):
            if len(ends) != 2:
                raise BadInput(f"{text!r} is no transition; expected the like of idle -> driving")
            known = [word(name) for name in self.states]
            for name in ends:
                if known and name != ANY and name not in known:
                    raise BadInput(f"{name!r} is none of the states{suggestion(name, known)}")
        return self

    @property
    def pairs(self) -> list[tuple[str, ...]]:
        """The transitions as (source, target)."""
        return [tuple(word(name) for name in ARROW.split(text.strip())) for text in self.transitions]


def word(name: object) -> str:
    """Return the name of a state as it is compared and shown."""
    return str(name).strip().lower().replace("_", " ")
