"""TEST.yaml with ``model:``, ``inputs:`` and ``expect:``: a test of one model without the plant."""

from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.quantities import NS_PER_SECOND, Seconds
from orchestrator.inputs.text.yaml_file import explain, read_mapping
from orchestrator.testing.steptest.expectation import Expectation

MARK = "model"
"""The key that a scenario does not have."""


WITHIN_NS = 1.0
"""A stop time so near [ns] to a whole number of steps is one."""


class BackToBack(BaseModel):
    """Another implementation, or an earlier run, that the outputs are held against: back-to-back."""

    model_config = ConfigDict(extra="forbid", populate_by_name=True)

    model: str = ""
    """As ``model`` of the test: given the same inputs."""
    log: str = ""
    """Or a log whose signals of the model are the reference."""
    signals: list[str] = ["*"]
    """Patterns of outputs."""
    absolute: float = Field(default=1e-9, alias="abs")
    relative: float = Field(default=1e-9, alias="rel")
    time: Seconds = 0.0


class StepTest(BaseModel):
    """One step test."""

    model_config = ConfigDict(extra="forbid", populate_by_name=True)

    name: str
    """Name in tables and of the folder of its results; the file's by default."""
    title: str = ""
    model: str
    """``controller`` or ``vehicle``, an FMU file, or a model of one's own: ``my_model.py:MODEL``."""
    step: Seconds = 0.01
    """Communication step [s]."""
    stop_time: Seconds = Field(gt=0.0)
    """[s]"""
    parameters: dict[str, Any] = {}
    """Nested or flat, as in a scenario."""
    inputs: dict[str, Any] = {}
    """Input -> a value, or ``{step: ..}``, ``ramp``, ``pulse``, ``sine``, ``table``, ``csv``."""
    replay: str = ""
    """A log whose inputs of the same model are played; what ``inputs`` names is changed on top."""
    expect: list[Expectation] = []
    contact_allowed: bool = False
    """Whether the test may pass though the car touches something in its scene."""
    reference: BackToBack | None = None
    file: Path = Path()

    @field_validator("inputs", mode="before")
    @classmethod
    def _default_empty(cls, data: Any) -> Any:
        return data or {}

    @property
    def step_ns(self) -> int:
        """Communication step [ns]."""
        return round(self.step * NS_PER_SECOND)

    @property
    def stop_ns(self) -> int:
        """End of the test [ns]; the last step is shorter if it is no whole number of steps."""
        stop_ns = self.stop_time * NS_PER_SECOND
        whole = int(stop_ns / self.step_ns + 0.5) * self.step_ns
        return whole if abs(whole - stop_ns) <= WITHIN_NS else round(stop_ns)

    def near(self, path: str) -> Path:
        """Return a file that the test names, beside the test."""
        return self.file.parent / path


def is_step_test(name: str) -> bool:
    """Return whether ``name`` is the file of a step test; anything else is a scenario's affair."""
    path = Path(name)
    if path.suffix not in (".yaml", ".yml") or not path.is_file():
        return False
    try:
        content = read_mapping(path)
    except BadInput:
        return False
    return MARK in content


def declares_step_test(path: Path) -> bool:
    """Return whether a YAML file declares itself as a step test, so that a test runner of any project may collect it.

    ``model:`` names something that can be tested here (``controller``, ``vehicle``, an FMU, ``FILE.py:NAME``) and at
    least one further key of a step test is there; ``model: resnet50`` of an unrelated file is not.
    """
    try:
        content = read_mapping(path)
    except BadInput:
        return False
    model = content.get(MARK)
    if not isinstance(model, str) or not content.keys() & {"stop_time", "inputs", "replay", "expect", "reference"}:
        return False
    return model in MODELS or model.lower().endswith(".fmu") or ".py:" in model


def load_step_test(path: Path) -> StepTest:
    """Return the test in a file. Raises ``BadInput`` with file, key, value and what would be right."""
    content = {"name": path.stem, **read_mapping(path)}
    try:
        test = StepTest(**{**content, "file": path})
    except ValidationError as error:
        raise explain(error, path, StepTest) from None
    if not test.expect and test.reference is None:
        raise BadInput("nothing is expected; write expect: or reference:", file=path)
    if test.step_ns < 1 or test.step > test.stop_time:
        raise BadInput(f"{test.step:g} s: expected a step above 0 and not above stop_time", file=path, key="step")
    return test
