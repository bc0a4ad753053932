"""``apa replay``: one row of a study's table again, as an ordinary run with its full log."""

import argparse
import json
from pathlib import Path
from typing import Any

import yaml

from orchestrator.commands import run as run_command
from orchestrator.cosim.fmu_files import KINDS, sources_hash
from orchestrator.text.console import console
from orchestrator.text.errors import BAD_INPUT, BadInput

EXAMPLES = """examples:
  apa replay runs/my-study/my-study.parquet --row 4711
  apa replay my-study.parquet --row 4711 --fmus native --out /tmp/again

writes DIR/scenario.yaml, a scenario of its own, and what `apa run` writes; says whether the bits are the row's
"""
COMPARED = ("x", "y", "heading", "lateral_error", "longitudinal_error", "heading_error", "steering_wheel_angle")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("table", type=Path, metavar="TABLE", help="table of a study, a .parquet file")
    parser.add_argument("--row", type=int, required=True, metavar="N", help="number of the run, from 0")
    parser.add_argument(
        "--fmus", choices=(*KINDS, "none"), default="none", help="kind of FMU (default: none, in process)"
    )
    parser.add_argument("--out", type=Path, metavar="DIR", help="where results go (default: row-N beside the table)")
    parser.add_argument("--json", action="store_true", help="print summary.json instead of the table")
    parser.add_argument("--no-figure", action="store_true", help="write neither overview.png nor report.html")


def run(arguments: argparse.Namespace) -> int:
    """Run the row; returns what ``apa run`` would, or 2 if the results are not the row's."""
    try:
        from orchestrator.sweep.job import chunk_scenario
        from orchestrator.sweep.store import Table
    except ModuleNotFoundError as error:
        raise BadInput(f"{error.name} is not installed; run: pip install 'apa-cosim[sweep]'") from error
    table = Table(arguments.table)
    scenario = chunk_scenario(table.job, table.chunk(arguments.row), 0)
    name = f"{table.about['study']['name']}-row-{arguments.row}"
    out: Path = arguments.out or table.path.parent / f"row-{arguments.row}"
    out.mkdir(parents=True, exist_ok=True)
    content = scenario.model_dump(mode="python", exclude={"file", "base", "car"}, by_alias=True, exclude_none=True)
    text = yaml.safe_dump({**content, "name": name}, sort_keys=False, allow_unicode=True)
    (out / "scenario.yaml").write_text(text, encoding="utf-8")
    code = run_command.run(
        argparse.Namespace(**{**vars(arguments), "scenario": str(out / "scenario.yaml"), "set": [], "out": out})
    )
    row = table.row(arguments.row)
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    different = _differences(row, summary)
    if arguments.json:
        return BAD_INPUT if different else code
    if not different:
        console().print("same bits as in the table")
        return code
    changed = "" if table.about["sources"] == sources_hash() else " (the models have changed since)"
    console().print(f"differs from the table{changed}: {', '.join(different)}", markup=False)
    return BAD_INPUT


def _differences(row: dict[str, Any], summary: dict[str, Any]) -> list[str]:
    """Return the names of the numbers that are not the same to the last bit."""
    pairs = {name: (row[name], summary[name]) for name in ("outcome", "reason", "duration", "shifts", "max_speed")}
    pairs |= {f"final.{name}": (row[f"final.{name}"], summary["final"][name]) for name in COMPARED}
    return [name for name, (told, found) in pairs.items() if told != found and not (told != told and found is None)]
