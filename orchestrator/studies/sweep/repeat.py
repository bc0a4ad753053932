"""One row of a table run again as an ordinary scenario, and compared with the row to the last bit."""

from pathlib import Path
from typing import Any, NamedTuple

import yaml

from fmus.files import write_whole
from orchestrator.evaluation.verdict.summary import Summary, summarize
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.locked_folder import lock_folder
from orchestrator.presentation.report.results import LOG, is_shown, write_page, write_picture, write_summary
from orchestrator.session.drive import drive
from orchestrator.session.foreign import ImportedFmus, load_bound_scenario
from orchestrator.session.session import SimulationResult
from orchestrator.simulation.cosim.fmu_files import sources_hash
from orchestrator.studies.sweep.job import chunk_scenario
from orchestrator.studies.sweep.table import UNREADABLE, Table

COMPARED = ("x", "y", "heading", "lateral_error", "longitudinal_error", "heading_error", "steering_wheel_angle")

NEEDED = ("outcome", "reason", "duration", "manoeuvres", "max_speed", *(f"final.{name}" for name in COMPARED))
"""Columns of a table with which a run is compared."""


class ReplayedRow(NamedTuple):
    """A row as it ran this time."""

    scenario: Scenario
    ran: SimulationResult
    summary: Summary
    different: list[str]
    """Names of the numbers that are not the row's to the last bit."""
    same_sources: bool
    """The models are those that the table was made with."""


def folder_of_row(table: Path, number: int) -> Path:
    """Return where the results of a repeated row are found: beside its table."""
    return table.parent / f"row-{number}"


def repeat_row(table: Table, number: int, out: Path, kind: str, *, pages: bool = True) -> ReplayedRow:
    """Run row ``number`` again, with its results in ``out``. Raises ``BadInput`` if there is none."""
    with lock_folder(out):
        scenario = write_scenario(table, number, out / "scenario.yaml")
        ran = drive(scenario, kind, out / LOG)
        summary = summarize(ran.recording, scenario, ran.wall_time)
        write_summary(out, summary)
        if pages and is_shown(ran.recording):
            write_picture(out, ran.recording, summary, scenario)
            write_page(out, ran.recording, summary, ran.lines)
    different = _differences(table.row(number), summary.as_json())
    return ReplayedRow(scenario, ran, summary, different, table.about["sources"] == sources_hash())


def write_scenario(table: Table, number: int, file: Path) -> Scenario:
    """Write row ``number`` as a scenario that stands on its own; return it as it is read back."""
    lacks = [name for name in NEEDED if name not in table.names()]
    if lacks:
        raise BadInput(f"has no column {lacks[0]}", file=table.path)
    chunk = table.chunk(number)
    try:
        scenario = chunk_scenario(table.job, chunk, 0)
        content = scenario.as_written()
    except BadInput:
        raise
    except UNREADABLE as error:
        raise table.unusable(number, error) from error
    if scenario.system is not None:
        content["system"] = scenario.system.model_dump(mode="python", by_alias=True, exclude_defaults=True)
    name = f"{table.about['study']['name']}-row-{number}"
    write_whole(file, yaml.safe_dump({**content, "name": name}, sort_keys=False, allow_unicode=True))
    return load_bound_scenario(str(file), [], ImportedFmus(), table.path).scenario


def _differences(row: dict[str, Any], summary: dict[str, Any]) -> list[str]:
    pairs = {name: (row[name], summary[name]) for name in NEEDED[: -len(COMPARED)]}
    pairs |= {f"final.{name}": (row[f"final.{name}"], summary["final"][name]) for name in COMPARED}
    return [name for name, (old, new) in pairs.items() if old != new and not (old != old and new is None)]
