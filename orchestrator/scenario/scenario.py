"""A scenario: what is parked where, by what, for how long, with which faults, judged by which limits."""

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from orchestrator.scenario.fault import Fault
from orchestrator.scenario.requirements import Requirement
from orchestrator.text.errors import BadInput
from orchestrator.text.quantities import Seconds, number

Outcome = Literal["parked", "not_parked", "failed", "aborted"]
NANOSECONDS = 1_000_000_000


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid")


class Slot(_Strict):
    """The slot as a rectangle, for pictures only; x and y are its middle."""

    x: float
    y: float
    heading: float = 0.0
    length: float = Field(gt=0.0)
    width: float = Field(gt=0.0)

    @field_validator("x", "y", "length", "width", mode="before")
    @classmethod
    def _metres(cls, value: object) -> float:
        return number(value, "m")

    @field_validator("heading", mode="before")
    @classmethod
    def _radians(cls, value: object) -> float:
        return number(value, "rad")


class Scenario(_Strict):
    """A scenario with its base, car and ``--set`` values merged in; parameters by flat name, in SI units."""

    name: str = Field(pattern=r"^[A-Za-z0-9._-]+$")
    title: str = ""
    description: str = ""
    source: str = ""
    base: str | None = None
    car: str | None = None
    stop_time: Seconds = 60.0
    step: Seconds = 0.01
    """Communication step [s], a whole number of nanoseconds."""
    every: dict[str, int] = {}
    """Decimation: the slave is stepped every n-th communication step."""
    seed: int = Field(default=1, ge=0)
    vehicle: dict[str, float | int | bool] = {}
    controller: dict[str, float | int | bool] = {}
    slot: Slot | None = None
    faults: list[Fault] = []
    limits: list[Requirement] = []
    expect: Outcome = "parked"
    """The outcome this scenario is meant to have."""
    file: str = ""
    """Where it came from."""
    changed: dict[str, str] = {}
    """What ``--set`` changed for one run, as it was written."""

    @property
    def step_ns(self) -> int:
        """Communication step [ns]."""
        return round(self.step * NANOSECONDS)

    @property
    def stop_ns(self) -> int:
        """Stop time [ns], a whole number of steps."""
        return round(self.stop_time * NANOSECONDS) // self.step_ns * self.step_ns

    @model_validator(mode="after")
    def _times(self) -> "Scenario":
        exact = self.step * NANOSECONDS
        if exact < 1.0 or abs(exact - round(exact)) > 1e-6 * exact:
            raise BadInput(f"{self.step:g} s is not a whole positive number of nanoseconds", key="step")
        if not self.step <= self.stop_time <= 1e6:
            raise BadInput(f"{self.stop_time:g} s is not between one step and 1e6 s", key="stop_time")
        for name, every in self.every.items():
            if name not in ("vehicle", "controller"):
                raise BadInput("unknown; known are vehicle, controller", key=f"every.{name}")
            if every < 1:
                raise BadInput(f"{every} is not a whole number of at least 1", key=f"every.{name}")
        return self
