"""The catalogue as data: what standards ask of parking, what tests it, and how sure that is."""

from fnmatch import fnmatchcase
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from orchestrator.inputs.scenario.files import LIBRARY, library_names
from orchestrator.inputs.scenario.load_scenario import scenario_names
from orchestrator.inputs.scenario.requirements import Requirement, library_requirements
from orchestrator.inputs.scenario.scenario import Outcome
from orchestrator.inputs.text.errors import BadInput, suggestion, suggestion_or_choices
from orchestrator.inputs.text.yaml_file import explain, read_mapping

CATALOGUE_FOLDER = LIBRARY / "catalogue"
STEP_TESTS = CATALOGUE_FOLDER / "steptests"
NAME = "catalogue"
"""What the catalogue is called where scenarios are named; ``catalogue/gbt*`` are some of its standards."""
Sure = Literal["text", "secondary", "unverified"]


class _CataloguePart(BaseModel):
    model_config = ConfigDict(extra="forbid")


class Clause(_CataloguePart):
    """One requirement of a standard: met if every run comes out as asked and keeps the limits."""

    id: str
    """Name in tables and reports."""
    clause: str = ""
    """Where it stands; empty: not known."""
    text: str
    """What is asked, in our words."""
    sure: Sure
    """``text``: as published (text, contents, abstract); ``secondary``: as others tell it; ``unverified``: a guess."""
    scenarios: list[str] = []
    """Scenarios that have to be run."""
    step_tests: list[str] = []
    """Step tests of this room that have to pass."""
    outcome: list[Outcome] = []
    """What the runs may come to; empty: anything."""
    requirements: dict[str, list[str] | Literal["all"]] = {}
    """Shipped set of limits -> ids in it; the numbers stand there alone."""
    not_tested: str = ""
    """Why nothing here tests it."""

    @model_validator(mode="after")
    def _whole(self) -> "Clause":
        if bool(self.scenarios or self.step_tests) == bool(self.not_tested):
            raise BadInput("expected either what tests it, or not_tested: why nothing does", key=self.id)
        if self.scenarios and not (self.outcome or self.requirements):
            raise BadInput("expected an outcome or limits of its scenarios", key=self.id)
        _check_names(self.id, self.scenarios, scenario_names(), "scenario")
        _check_names(self.id, self.step_tests, [path.stem for path in STEP_TESTS.glob("*.yaml")], "step test")
        _check_names(self.id, list(self.requirements), library_names("requirements"), "set of requirements")
        for name, ids in self.requirements.items():
            if isinstance(ids, list):
                _check_names(self.id, ids, [item.id for item in library_requirements(name)], f"limit of {name}")
        return self

    def limits_to_keep(self) -> list[Requirement]:
        """Return the limits that its runs have to keep."""
        named = {name: ids if isinstance(ids, list) else [] for name, ids in self.requirements.items()}
        return [item for name, ids in named.items() for item in library_requirements(name, *ids)]


class Standard(_CataloguePart):
    """One standard and what of it is in the catalogue."""

    key: str
    """Name of its file."""
    standard: str
    """What it is called."""
    title: str
    """What it is of."""
    source: str
    """Where the facts here come from."""
    entries: list[Clause] = Field(min_length=1)

    @model_validator(mode="after")
    def _check_unique_ids(self) -> "Standard":
        names = [entry.id for entry in self.entries]
        for name in names:
            if names.count(name) > 1:
                raise BadInput("two entries of this name", key=name)
        return self


def is_catalogue(word: str) -> bool:
    """Return whether a word where scenarios are named means the catalogue, or some of its standards."""
    return word == NAME or word.startswith(f"{NAME}/")


def select_standards(words: list[str]) -> list[Standard]:
    """Return the standards that words such as ``catalogue`` and ``catalogue/gbt*`` mean. Raises ``BadInput``."""
    patterns = [word.removeprefix(NAME).removeprefix("/") or "*" for word in words]
    found: dict[str, Standard] = {}
    for pattern in patterns:
        fitting = [path for path in sorted(CATALOGUE_FOLDER.glob("*.yaml")) if fnmatchcase(path.stem, pattern)]
        if not fitting:
            known = [path.stem for path in sorted(CATALOGUE_FOLDER.glob("*.yaml"))]
            hint = suggestion_or_choices(pattern, known)
            raise BadInput(f"the catalogue has no standard of this name{hint}", key=pattern)
        found |= {path.stem: read_standard(path) for path in fitting}
    return list(found.values())


def read_standard(path: Path) -> Standard:
    """Return the standard in a file. Raises ``BadInput`` with the place of a mistake."""
    try:
        return Standard.model_validate({"key": path.stem, **read_mapping(path)})
    except ValidationError as error:
        raise explain(error, path, Standard) from None


def _check_names(entry: str, names: list[str], known: list[str], what: str) -> None:
    for name in names:
        if name not in known:
            raise BadInput(f"no {what} {name!r}{suggestion(name, known)}", key=entry)
