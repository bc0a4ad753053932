"""Requirements as data: a signal or a metric of the summary, a condition, a window, a limit, a source.

The limits of a scenario, the shipped sets in ``orchestrator/library/requirements`` and the files of ``apa check``
are all lists of these.
"""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, Literal, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from orchestrator.inputs.scenario.files import LIBRARY
from orchestrator.inputs.text.errors import BadInput, format_value
from orchestrator.inputs.text.quantities import Seconds, parse_quantity
from orchestrator.inputs.text.yaml_file import explain, place_in, read_yaml

Condition = Literal["max", "min", "max_abs", "equals"]
CONDITIONS: tuple[Condition, ...] = get_args(Condition)
Where = Literal["target", "slot", "kerb", "obstacles", "scene"]
"""What a scenario may have; a kerb counts where it bounds the slot, ``scene`` is anything to touch."""
REQUIREMENT_SETS = LIBRARY / "requirements"
"""Where the shipped sets are."""


class ConditionLimit(BaseModel):
    """What has exactly one of the conditions."""

    @property
    def condition(self) -> Condition:
        """Return which of the conditions is given."""
        return _condition_of(self.__dict__)

    @property
    def limit(self) -> float | str:
        """Return the limit [SI unit], or the name of a state."""
        value: float | str = getattr(self, self.condition)
        return value


class Occasion(ConditionLimit):
    """A condition on a signal at one instant: exactly one of ``max``, ``min``, ``max_abs`` and ``equals`` is given."""

    model_config = ConfigDict(extra="forbid")

    signal: str
    """Signal of the run, such as ``vehicle.driver_takeover``."""
    max: float | None = None
    """The value is at most this."""
    min: float | None = None
    """The value is at least this."""
    max_abs: float | None = None
    """The value without its sign is at most this."""
    equals: float | str | None = None
    """The value is this; a number, true, false or the name of a state."""
    unit: str | None = None
    """SI unit of the limit; taken from the limit's text if that has one."""

    @model_validator(mode="before")
    @classmethod
    def _quantities(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            raise BadInput(f"{format_value(data)}: expected a mapping with signal and one of {', '.join(CONDITIONS)}")
        return {**data, **_limit(data, _condition_of(data))}


class Window(BaseModel):
    """The part of a run in which a requirement applies: the intersection of the given conditions."""

    model_config = ConfigDict(extra="forbid", populate_by_name=True)

    from_: Seconds | None = Field(default=None, alias="from")
    """First instant [s]."""
    to: Seconds | None = None
    """Last instant [s]."""
    phase: list[str] = []
    """States of the controller (``controller.phase``) in which the requirement applies."""
    at: Literal["end"] | None = None
    """``end``: the last instant only."""
    after: Occasion | None = None
    """Condition; the window opens each time that it becomes true."""
    delay: Seconds = 0.0
    """Delay from ``after`` to the opening of the window [s]."""
    lasting: Seconds | None = None
    """Duration of the window [s]; by default to the end of the run."""
    if_never: Literal["fail", "pass"] = "fail"
    """Verdict of a run that has no instant in the window."""

    @model_validator(mode="before")
    @classmethod
    def _one_phase(cls, data: Any) -> Any:
        if isinstance(data, dict) and isinstance(data.get("phase"), str):
            return {**data, "phase": [data["phase"]]}
        return data

    @model_validator(mode="after")
    def _check_order(self) -> "Window":
        if self.from_ is not None and self.to is not None and self.from_ > self.to:
            raise BadInput(f"from {self.from_:g} s is after to {self.to:g} s", key="window")
        if self.after is None and (self.delay or self.lasting is not None):
            raise BadInput("delay and lasting count from after", key="window")
        return self


class Requirement(ConditionLimit):
    """One requirement on a run; exactly one of ``max``, ``min``, ``max_abs`` and ``equals`` is given.

    A limit is a number in SI units, text with a unit (``3 deg``, ``10 km/h``), or for ``equals``
    the name of a state (``PARKED``).
    """

    model_config = ConfigDict(extra="forbid")

    id: str
    """Name in tables and reports."""
    signal: str
    """Signal, such as ``vehicle.speed``, evaluated at every instant of the window; or metric of the summary, such as
    ``final.lateral_error``, ``manoeuvres``, ``duration``."""
    max: float | None = None
    """The value is at most this."""
    min: float | None = None
    """The value is at least this."""
    max_abs: float | None = None
    """The value without its sign is at most this."""
    equals: float | str | None = None
    """The value is this; a number, true, false or the name of a state."""
    unit: str | None = None
    """SI unit of the limit; taken from the limit's text if that has one."""
    window: Window | None = None
    """Part of the run in which the requirement applies; by default the whole run."""
    ever: bool = False
    """If true, one instant of the window must meet the limit; otherwise all must."""
    where: Where | None = None
    """The requirement applies only to scenarios that have this."""
    source: str
    """Origin of the requirement, such as a standard and clause."""
    required: bool = True
    """If true, a run that violates the requirement is neither `parked` nor `finished`."""

    @model_validator(mode="before")
    @classmethod
    def _quantities(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            raise BadInput(
                f"{format_value(data)}: expected the name of a set of limits or a mapping with id, signal, max, source"
            )
        has_unknown_key = not data.keys() <= cls.model_fields.keys()
        return data if has_unknown_key else {**data, **_limit(data, _condition_of(data))}


@cache
def library_requirements(name: str, *ids: str) -> tuple[Requirement, ...]:
    """Return the shipped set of requirements of this name, or those called ``ids``. Raises ``KeyError``."""
    found = {item.id: item for item in read_requirements(REQUIREMENT_SETS / f"{name}.yaml")}
    return tuple(found[wanted] for wanted in ids or found)


def read_requirements(path: Path) -> list[Requirement]:
    """Return the requirements in a YAML file. Raises ``BadInput`` with the place of a mistake."""
    content = read_yaml(path)
    if not isinstance(content, list) or not content:
        raise BadInput("expected a list of requirements, each with id, signal, a limit, source", file=path)
    found = []
    for number, entry in enumerate(content, start=1):
        try:
            found.append(Requirement.model_validate(entry))
        except ValidationError as error:
            mistake = explain(error, None, Requirement)
            at = f"[{number}].{place_in(error)}".rstrip(".")
            raise BadInput(f"requirement {number}: {mistake}", file=path, at=at) from None
    return found


def _condition_of(data: Mapping[str, Any]) -> Condition:
    given = [key for key in CONDITIONS if data.get(key) is not None]
    if len(given) != 1:
        raise BadInput(f"expected exactly one of {', '.join(CONDITIONS)}", key=str(data.get("id", "")))
    return given[0]


def _limit(data: dict[str, Any], key: str) -> dict[str, Any]:
    """Return the limit as a number in SI units and its unit. A word stays for ``equals`` (a state)."""
    value, unit = data[key], data.get("unit")
    where = f"{data.get('id', '')}: {key}".lstrip(": ")
    if isinstance(value, bool):
        return {key: float(value)}
    if key == "equals" and isinstance(value, str) and value.strip().replace("_", "").replace(" ", "").isalnum():
        if not value.strip()[0].isdigit():
            return {key: value.strip()}
    number, written = parse_quantity(value, key=where)
    if unit is not None and written is not None and written != unit:
        raise BadInput(f"{format_value(value)} is not in {unit}", key=where)
    return {key: number, "unit": written if unit is None else unit}
