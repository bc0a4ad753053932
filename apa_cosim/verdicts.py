"""Runs judged by requirements, and held against each other."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from apa_cosim.runs import Run
from orchestrator.evaluation.comparison.compare import Comparison
from orchestrator.evaluation.comparison.compare import compare as compare_recordings
from orchestrator.evaluation.comparison.tolerance import Tolerance, Tolerances
from orchestrator.evaluation.verdict.judge import Check
from orchestrator.evaluation.verdict.judge import judge as judge_recording
from orchestrator.evaluation.verdict.numbers import facts_of
from orchestrator.inputs.scenario.files import find_file
from orchestrator.inputs.scenario.requirements import Requirement, read_requirements
from orchestrator.inputs.text.yaml_file import explain


def judge(run: Run, *requirements: str | Path | Requirement | Mapping[str, Any]) -> list[Check]:
    """Return a check for each requirement: a shipped set's name, a YAML file, a ``Requirement``, or one as in YAML.

    One more, last, is that of contact, if there is anything in the scene. Raises ``BadInput`` for a signal that the run
    does not have.
    """
    asked: list[Requirement] = []
    for item in requirements:
        if isinstance(item, Requirement):
            asked.append(item)
        elif isinstance(item, Mapping):
            asked.append(_requirement(item))
        else:
            asked += read_requirements(find_file(str(item), "requirements", "set of requirements", Path.cwd()))
    asked.append(run.scenario.contact_rule)
    return judge_recording(asked, run.recording, facts_of(run.recording, run.scenario), "judge")


def _requirement(written: Mapping[str, Any]) -> Requirement:
    try:
        return Requirement.model_validate({"source": "asked here", **written})
    except ValidationError as error:
        raise explain(error, None, Requirement) from None


def compare(
    a: Run,
    b: Run,
    *,
    absolute: float = 1e-9,
    relative: float = 1e-9,
    time: float = 0.0,
    signals: Iterable[str] | None = None,
) -> Comparison:
    """Return where run ``b`` leaves the reference ``a``: by more than max(absolute, relative * |a|) at every moment
    of ``a`` within ``time`` [s]. ``signals``: patterns such as ``vehicle.pose.*``.
    """
    tolerances = Tolerances(Tolerance(absolute, relative, time))
    return compare_recordings(a.recording, b.recording, tolerances, signals)
