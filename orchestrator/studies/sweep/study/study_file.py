"""STUDY.yaml: which scenario, what is varied and how, and what the result page shows."""

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, ValidationError, model_validator

from orchestrator.inputs.scenario.files import LIBRARY, find_file
from orchestrator.inputs.scenario.scenario import Name
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.yaml_file import explain, read_mapping

MOST_RUNS = 100_000_000


class _StudyPart(BaseModel):
    model_config = ConfigDict(extra="forbid", populate_by_name=True)


class _OneOf(_StudyPart):
    """What is given by exactly one of its keys."""

    @model_validator(mode="after")
    def _one(self) -> Self:
        if len(self.model_dump(exclude_none=True)) != 1:
            raise BadInput(f"expected exactly one of {', '.join(type(self).model_fields)}")
        return self


class Range(_StudyPart):
    """Equally spaced values, both ends included."""

    first: float | str = Field(alias="from")
    last: float | str = Field(alias="to")
    steps: int = Field(ge=1, le=1_000_000)
    """Number of values."""

    @model_validator(mode="after")
    def _both_ends(self) -> "Range":
        if self.steps == 1 and self.first != self.last:
            raise BadInput("1 value is not both ends; expected 2 or more", key="steps")
        return self


Values = Annotated[
    Annotated[list[Any], Tag("<list>")] | Annotated[Range, Tag("<range>")],
    Discriminator(lambda value: "<range>" if isinstance(value, dict | Range) else "<list>"),
]
"""Values of a parameter of a grid."""


class Distribution(_OneOf):
    """A distribution: exactly one of the three."""

    uniform: tuple[float | str, float | str] | None = None
    """Lower and upper end."""
    normal: tuple[float | str, float | str] | None = None
    """Mean and standard deviation; cut off where the parameter's range ends."""
    choice: list[Any] | None = Field(default=None, min_length=1)
    """Any of these, equally likely."""


class Samples(_StudyPart):
    """``n`` samples of some parameters: ``{n: 100, vehicle.start.y: {uniform: [-0.1, 0.1]}, ...}``."""

    n: int = Field(ge=1, le=MOST_RUNS)
    spreads: dict[str, Distribution] = Field(default={}, validation_alias="<spreads>")

    @model_validator(mode="before")
    @classmethod
    def _beside(cls, data: Any) -> Any:
        if not isinstance(data, dict) or "spreads" in data:
            return data
        number = {"n": data["n"]} if "n" in data else {}
        return {**number, "<spreads>": {key: value for key, value in data.items() if key != "n"}}


class Runs(_StudyPart):
    """Every grid point is run with every sample; samples of both kinds are joined side by side."""

    grid: dict[str, Values] = {}
    monte_carlo: Samples | None = None
    latin_hypercube: Samples | None = None

    @model_validator(mode="after")
    def _same_n(self) -> "Runs":
        if self.monte_carlo and self.latin_hypercube and self.monte_carlo.n != self.latin_hypercube.n:
            raise BadInput("monte_carlo and latin_hypercube are joined side by side: expected the same n", key="runs")
        return self


class Axes(_StudyPart):
    """What the map of the result page shows."""

    x: str
    y: str
    split: str | None = None
    """One map for each value of this parameter."""


class MeasureOf(_OneOf):
    """One number of one signal over a run: exactly one of these, with the name of the signal."""

    last: str | None = None
    first: str | None = None
    largest: str | None = None
    """Of the absolute values, with its sign."""
    greatest: str | None = None
    smallest: str | None = None
    travel: str | None = None
    """Sum of the absolute changes."""


class StudyFile(_StudyPart):
    """One study as it is written. A key ``a, b`` gives the same value to both parameters.

    ``car.x`` is the car's as it is and as the controller knows it: ``vehicle.car.x, controller.car.x``.
    """

    name: Name
    title: str = ""
    description: str = ""
    scenario: str
    """Name of a shipped scenario, or a file relative to the study's."""
    set: dict[str, Any] = {}
    """Changes of the scenario that hold for every run, as with ``apa run --set``."""
    seed: int = Field(default=1, ge=0, le=2**31 - 1)
    """Seed of the samples and of the runs' own seeds."""
    runs: Runs
    measures: dict[str, MeasureOf] = {}
    """Further columns of the table: ``{largest offset: {largest: controller.lateral_error}}``."""
    within: dict[str, list[Any]] = {}
    """Sets of limits that do not decide about the outcome, as a scenario's ``limits``: a column each."""
    map: Axes | None = None


def load_study(name: str, others: Iterable[str] = ()) -> tuple[StudyFile, Path]:
    """Return the study called ``name`` or written in the file ``name``, and that file.

    Raises ``BadInput``, which suggests names of ``others`` too.
    """
    path = find_file(name, "studies", "study", Path(), others=others)
    content = read_mapping(path)
    content.setdefault("name", path.stem)
    try:
        study = StudyFile(**content)
    except ValidationError as error:
        raise explain(error, path, StudyFile) from None
    scenario = find_file(study.scenario, "scenarios", "scenario", path.parent, file=path, key="scenario")
    if not scenario.is_relative_to(LIBRARY):
        study = study.model_copy(update={"scenario": str(scenario)})
    return study, path
