"""Writes two tables of docs/apa.md: the search in numbers, and how drives feel. ``python docs/search.py``."""

from pathlib import Path

import numpy as np
from marked import put

from orchestrator.cosim.fmu_files import fmu_files
from orchestrator.grid.search_kpis import HEADS, rows_of, study
from orchestrator.scenario.load_scenario import load_scenario, scenario_names
from orchestrator.scenario.scenario import DONE
from orchestrator.session.session import run_scenario
from orchestrator.sweep.in_memory import columns_in_memory
from orchestrator.verdict.numbers import facts_of

PAGE = Path(__file__).parent / "apa.md"
DRIVES = {
    "duration": "{:.0f} s",
    "shifts": "{:.0f}",
    "peak_jerk": "{:.1f} m/s3",
    "standstill_steering": "{:.0f}",
    "min_clearance": "{:.2f} m",
}


def searched() -> list[str]:
    """Return the table of the search."""
    columns = {name: np.asarray(values) for name, values in columns_in_memory(study()).items()}
    return table(["", *HEADS], rows_of(columns))


def felt() -> list[str]:
    """Return the table of the drives."""
    files, rows = fmu_files("native", print), []
    for name in scenario_names():
        scenario = load_scenario(name)
        if name.startswith(("apa-", "cicap-", "valet-")) and scenario.expect in DONE:
            numbers = facts_of(run_scenario(scenario, files, kind="native").recording, scenario).numbers
            rows.append([f"`{name}`", *(text.format(numbers[key]) for key, text in DRIVES.items())])
    return table(["", *(name.replace("_", " ") for name in DRIVES)], rows)


def table(heads: list[str], rows: list[list[str]]) -> list[str]:
    """Return a table, numbers to the right."""
    rule = "|---|" + "---:|" * (len(heads) - 1)
    return ["| " + " | ".join(heads) + " |", rule, *("| " + " | ".join(row) + " |" for row in rows)]


if __name__ == "__main__":
    put(PAGE, "search", searched())
    put(PAGE, "comfort", felt())
