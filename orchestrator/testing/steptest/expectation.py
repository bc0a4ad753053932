"""What is expected of one output: a limit with a temporal operator, or a number of its step response."""

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from orchestrator.inputs.scenario.requirements import ConditionLimit
from orchestrator.inputs.text.errors import BadInput, format_value
from orchestrator.testing.steptest.response import RESPONSES

Number = float | str | bool
OPERATORS = ("always", "eventually", "until", "response")


class _StepTestPart(BaseModel):
    model_config = ConfigDict(extra="forbid", populate_by_name=True)


class Limit(_StepTestPart, ConditionLimit):
    """A limit on a signal at one instant: exactly one of ``max``, ``min``, ``max_abs``, ``equals``."""

    signal: str = ""
    """Name of the input or output; by default that of the expectation."""
    max: Number | None = None
    min: Number | None = None
    max_abs: Number | None = None
    equals: Number | None = None

    @model_validator(mode="after")
    def _one(self) -> "Limit":
        _ = self.condition
        return self


class Reaction(_StepTestPart):
    """A number of the response to a step: ``{rise_time: {max: 0.3 s}, to: 5 deg, at: 1 s}``."""

    measure: Literal["rise_time", "settling_time", "overshoot", "steady_state_error"]
    to: Number
    """Where the signal shall go."""
    at: Number = 0.0
    """When the step comes [s]."""
    end: Number | None = None
    """When the response is over [s]; by default the end of the test."""
    band: Number = 0.02
    """Share of the way within which it is settled."""
    limit: Limit


class Expectation(_StepTestPart):
    """One expectation; exactly one of ``always``, ``eventually``, ``until`` and ``response`` is given."""

    id: str
    """Name in tables and reports."""
    signal: str
    """An input or output of the model."""
    always: Limit | None = None
    """Holds at every instant: of the whole test, from ``from`` to ``to``, or for ``within`` after each ``after``."""
    eventually: Limit | None = None
    """Holds once, ``within`` a time from the start, or from each rise of ``after``."""
    until: Limit | None = None
    """``hold`` holds until this does, which has to come ``within`` the time."""
    hold: Limit | None = None
    """What holds until ``until``."""
    response: Reaction | None = None
    """A number of its step response."""
    after: Limit | None = None
    """The window opens each time this begins to hold."""
    within: Number | None = None
    """Length of the window [s]; by default to the end."""
    from_: Number | None = Field(default=None, alias="from")
    """First instant [s]."""
    to: Number | None = None
    """Last instant [s]."""
    if_never: Literal["fail", "pass"] = "fail"
    """The verdict if ``after`` never comes."""
    source: str = "step test"
    """Who asks for it."""

    @model_validator(mode="before")
    @classmethod
    def _measure(cls, data: Any) -> Any:
        """Take ``response: {rise_time: {max: ..}, to: ..}``, with the number's name as key, as it is written."""
        given = data.get("response") if isinstance(data, dict) else None
        if not isinstance(given, dict) or "measure" in given:
            return data
        words = [key for key in given if key in RESPONSES]
        if len(words) != 1:
            raise BadInput(f"{format_value(given)}: expected exactly one of {', '.join(RESPONSES)}", key="response")
        rest = {key: value for key, value in given.items() if key != words[0]}
        return {**data, "response": {**rest, "measure": words[0], "limit": given[words[0]]}}

    @model_validator(mode="after")
    def _one(self) -> "Expectation":
        given = [name for name in OPERATORS if getattr(self, name) is not None]
        if len(given) != 1:
            raise BadInput(f"expected exactly one of {', '.join(OPERATORS)}", key=self.id)
        if (self.until is None) != (self.hold is None):
            raise BadInput("until and hold belong together", key=self.id)
        return self
