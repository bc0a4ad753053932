"""Drives one scenario and sums it up: what every reproduction stands on."""

from collections.abc import Mapping
from pathlib import Path

from orchestrator.evaluation.verdict.summary import summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.session.session import run_scenario
from orchestrator.studies.papers.result import Driven


def drive(name: str, files: Mapping[str, Path] | None = None, kind: str = "none") -> Driven:
    """Return the scenario ``name`` driven with the FMUs in ``files``, or in process."""
    scenario = load_scenario(name)
    ran = run_scenario(scenario, files, kind=kind)
    return Driven(scenario, ran.recording, summarize(ran.recording, scenario, ran.wall_time))
