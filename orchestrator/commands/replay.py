"""``apa replay``: one row of a study's table again, as an ordinary run with its full log."""

import argparse
import json
from pathlib import Path

from fmus.installation import missing_package
from orchestrator.inputs.text.console import console
from orchestrator.inputs.text.errors import BAD_INPUT, INTERRUPTED, NOT_PARKED, PARKED, BadInput
from orchestrator.session.terminal import print_summary
from orchestrator.simulation.cosim.kinds import KINDS, fastest_kind

EXAMPLES = """examples:
  apa replay runs/my-study/my-study.parquet --row 17
  apa replay my-study.parquet --row 17 --fmus none --out /tmp/again

writes DIR/scenario.yaml with all values of the row, and the files of `apa run`; reports whether the run is identical
to the row
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("table", type=Path, metavar="TABLE", help="table of a study, a .parquet file")
    parser.add_argument("--row", type=int, required=True, metavar="N", help="number of the run, from 0")
    parser.add_argument(
        "--fmus",
        choices=(*KINDS, "none"),
        default=fastest_kind(),
        help="kind of FMU (default: native where it can be built, else none)",
    )
    parser.add_argument("--out", type=Path, metavar="DIR", help="output folder (default: row-N beside the table)")
    parser.add_argument("--json", action="store_true", help="print summary.json instead of the table")
    parser.add_argument("--no-page", action="store_true", help="write neither overview.png nor report.html")


def run(arguments: argparse.Namespace) -> int:
    """Run the row; returns what ``apa run`` would, or 2 if the results are not the row's."""
    try:
        from orchestrator.studies.sweep.repeat import folder_of_row, repeat_row
        from orchestrator.studies.sweep.table import Table
    except ModuleNotFoundError as error:
        raise BadInput(missing_package(error.name or "", "sweep")) from error
    out: Path = arguments.out or folder_of_row(arguments.table, arguments.row)
    again = repeat_row(Table(arguments.table), arguments.row, out, arguments.fmus, pages=not arguments.no_page)
    if arguments.json:
        print(json.dumps(again.summary.as_json(), indent=2, allow_nan=False))
    else:
        print_summary(again.summary, again.scenario.title, again.scenario.expected_outcome)
        print(f"results in {out}")
        changed = "" if again.same_sources else " (the models have changed since)"
        differs = f"differs from the table{changed}: {', '.join(again.different)}"
        console().print(differs if again.different else "same bits as in the table", markup=False)
    if again.ran.end.reason == "interrupted":
        return INTERRUPTED
    if again.different:
        return BAD_INPUT
    return PARKED if again.summary.is_done else NOT_PARKED
