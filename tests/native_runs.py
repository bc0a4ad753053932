"""Shipped scenarios, and runs of them that tests look at and do not change: native FMUs, a tenth of CPython's time."""

from functools import cache

import pytest

from orchestrator.inputs.scenario.load_scenario import load_scenario, scenario_names
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.session.session import SimulationResult, run_scenario
from orchestrator.simulation.cosim.fmu_files import can_compile, fmu_files
from orchestrator.simulation.cosim.recording import Recording


@cache
def shipped_scenarios() -> dict[str, Scenario]:
    """Return name -> shipped scenario, read once in this process."""
    return {name: load_scenario(name) for name in scenario_names()}


def drive_natively(scenario: Scenario) -> SimulationResult:
    """Return a run of a scenario by native FMUs; in process without a C compiler."""
    if not can_compile():
        return run_scenario(scenario)
    return run_scenario(scenario, fmu_files("native"), kind="native")


@cache
def native_recording(name: str, *sets: str) -> Recording:
    """Return a run of a scenario with ``sets``, driven once in this process; without a C compiler a skipped test."""
    if not can_compile():
        pytest.skip("FMUs without Python need a C compiler: pip install ziglang")
    return run_scenario(load_scenario(name, list(sets)), fmu_files("native"), kind="native").recording
