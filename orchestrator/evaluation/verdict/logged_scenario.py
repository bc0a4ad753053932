"""The scenario that a run was driven by, read back from its recording: what was true, and what it is judged by."""

from typing import NamedTuple

from pydantic import ValidationError

from orchestrator.evaluation.verdict.frame import pose_of
from orchestrator.inputs.scenario.scenario import Scenario, Target
from orchestrator.inputs.text.yaml_file import explain
from orchestrator.simulation.cosim.recording import Recording

NO_TARGET_IN_LOG = (
    "no target of the scenario is in this log; the errors are taken from the target given to the controller"
)
NO_TARGET = "no target is in this log: where the car should stand is not known"


class LoggedRun(NamedTuple):
    """The scenario of a recording."""

    scenario: Scenario
    note: str
    """What the log does not tell and was taken from elsewhere; empty if it tells all."""


def read_logged_run(recording: Recording, file: str = "", name: str = "unnamed") -> LoggedRun:
    """Return the scenario of ``recording``, which was read from ``file``. Raises ``BadInput`` if it has no meaning.

    Logs of old versions, and of other tools, carry no target or no scenario at all: the target that the controller
    has, if it has parameters ``target.x``, ``target.y``, ``target.heading``, is the target then,
    and the vehicle's own parameters for what stands around it.
    """
    carried = recording.info.get("scenario") or {}
    try:
        scenario = Scenario(**{"name": name, **carried, "file": file})
    except ValidationError as error:
        raise explain(error, file or None, list(Scenario.model_fields)) from None
    if "target" in carried:
        return LoggedRun(scenario, "")
    reported = pose_of(recording.parameters_of("controller"), "target")
    if "vehicle" not in carried:
        scenario = scenario.model_copy(update={"vehicle": recording.parameters_of("vehicle")})
    if reported is None:
        return LoggedRun(scenario, NO_TARGET)
    target = Target(**dict(zip(Target.model_fields, reported, strict=True)))
    return LoggedRun(scenario.model_copy(update={"target": target}), NO_TARGET_IN_LOG)
