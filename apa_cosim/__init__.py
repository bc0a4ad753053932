"""Automated parking from Python: scenarios, runs, studies and verdicts, with arrays in and out.

    import apa_cosim as apa

    run = apa.run("guo2015-case4", {"controller.guo2015.k4": 3.0})
    run.outcome                          # 'parked'
    run["vehicle.pose.x"]                # numpy array over run.t [s], SI units
    run.summary.final.lateral_error      # m
    run.plot()                           # in a notebook, `run` alone shows the replay

What is named here stays; everything is imported when it is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from apa_cosim.runs import Run, load_scenario, read_log, run, scenario_names
    from apa_cosim.studies import StudyTable, read_table, sweep
    from apa_cosim.verdicts import compare, judge
    from orchestrator.evaluation.comparison.compare import Comparison
    from orchestrator.evaluation.verdict.judge import Check
    from orchestrator.evaluation.verdict.summary import Summary
    from orchestrator.inputs.scenario.scenario import Scenario
    from orchestrator.inputs.text.errors import BadInput

__all__ = [
    "BadInput",
    "Check",
    "Comparison",
    "Run",
    "Scenario",
    "StudyTable",
    "Summary",
    "compare",
    "judge",
    "load_scenario",
    "read_log",
    "read_table",
    "run",
    "scenario_names",
    "sweep",
]

_HOMES = {
    "apa_cosim.runs": ("Run", "load_scenario", "read_log", "run", "scenario_names"),
    "apa_cosim.studies": ("StudyTable", "read_table", "sweep"),
    "apa_cosim.verdicts": ("compare", "judge"),
    "orchestrator.evaluation.comparison.compare": ("Comparison",),
    "orchestrator.inputs.scenario.scenario": ("Scenario",),
    "orchestrator.inputs.text.errors": ("BadInput",),
    "orchestrator.evaluation.verdict.judge": ("Check",),
    "orchestrator.evaluation.verdict.summary": ("Summary",),
}


def __getattr__(name: str) -> Any:
    """Return the requested name from the module that defines it."""
    home = next((module for module, names in _HOMES.items() if name in names), None)
    if home is None:
        raise AttributeError(f"module 'apa_cosim' has no attribute {name!r}")
    return getattr(import_module(home), name)


def __dir__() -> list[str]:
    return sorted(__all__)
