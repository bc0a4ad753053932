"""The scenario that a run was driven by, read back from its recording: what was true, and what it is judged by."""

from pydantic import ValidationError

from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.console import say
from orchestrator.inputs.text.yaml_file import explain
from orchestrator.simulation.cosim.recording import Recording


def read_logged_scenario(recording: Recording, file: str = "", name: str = "unnamed") -> Scenario:
    """Return the scenario of ``recording``, which was read from ``file``. Raises ``BadInput`` if it has no meaning.

    Logs of other tools carry none: it has no target then, and around it stands what the vehicle's parameters say.
    """
    carried = recording.info.get("scenario") or {}
    if file and "target" not in carried:
        say(f"apa: warning: {file}: no target is in this log: where the car should stand is not known")
    try:
        return Scenario(**{"name": name, "vehicle": recording.parameters_of("vehicle"), **carried, "file": file})
    except ValidationError as error:
        raise explain(error, file or None, Scenario) from None
