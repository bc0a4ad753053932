"""``apa reproduce``: the papers' numbers beside ours, with their pictures."""

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

from fmus.files import write_whole
from orchestrator.inputs.text.console import say
from orchestrator.inputs.text.errors import NOT_PARKED, PARKED
from orchestrator.inputs.text.locked_folder import lock_folder
from orchestrator.session.options import add_fmus_argument
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.studies.papers.papers import paper, papers

if TYPE_CHECKING:
    from orchestrator.studies.papers.result import Drive, Driven

EXAMPLES = """examples:
  apa reproduce guo2015                 the five cases at both steering rates, compared with the paper
  apa reproduce all --json > all.json   every paper, as JSON
  apa reproduce hsic --latex > hsic.tex the rows as a table for an article (also --csv, --bibtex)
  apa reproduce hsic --figures figures  the paper's figures as PNG, SVG, PDF and CSV

exit codes: 0 all checks of this project hold, 1 one does not, 2 bad input
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("paper", metavar="PAPER", help=f"{', '.join(papers())} or all")
    add_fmus_argument(parser)
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="output folder of figures (default: runs/reproduce/PAPER)"
    )
    kinds = parser.add_mutually_exclusive_group()
    kinds.add_argument("--json", action="store_true", help="print JSON instead of the table")
    kinds.add_argument("--csv", action="store_true", help="print the rows as CSV instead")
    kinds.add_argument("--latex", action="store_true", help="print LaTeX tables (booktabs) instead")
    kinds.add_argument("--bibtex", action="store_true", help="print BibTeX entries of the papers; nothing is simulated")
    parser.add_argument(
        "--figures",
        type=Path,
        metavar="DIR",
        help="write each figure as PNG, SVG and PDF with its data as CSV and the command, and figures.json",
    )
    parser.add_argument("--dpi", type=int, default=150, help="resolution of the PNGs of --figures (default: 150)")


def run(arguments: argparse.Namespace) -> int:
    """Reproduce, write pictures and result.json, print. Returns 0 if every check holds, else 1."""
    from orchestrator.studies.papers.figure_files import write_figures, write_pictures
    from orchestrator.studies.papers.table import print_reproduction
    from orchestrator.studies.papers.table_files import csv_text, latex_text, summary_lines

    names = papers() if arguments.paper == "all" else [arguments.paper]
    if arguments.bibtex:
        return _print_bibtex(names)
    functions = [(name, paper(name)) for name in names]
    drive = _driver(arguments.fmus)
    results, found = [], []
    for name, function in functions:
        out: Path = arguments.out or Path("runs/reproduce") / name
        if arguments.out is not None and len(names) > 1:
            out = arguments.out / name
        with lock_folder(out):
            result = function(drive)
            pictures = [str(picture) for picture in write_pictures(name, drive, out)]
            found.append({**result.as_json(), "figures": pictures})
            write_whole(out / "result.json", json.dumps(found[-1], indent=2) + "\n")
        results.append(result)
        if arguments.figures is not None:
            write_figures(name, drive, arguments.figures, arguments.dpi)
        if not (arguments.json or arguments.csv or arguments.latex):
            print_reproduction(result, out)
    if arguments.csv or arguments.latex:
        print((csv_text if arguments.csv else latex_text)(results), end="")
    elif arguments.json:
        print(json.dumps(found, indent=2))
    elif len(results) > 1:
        print("\n".join(summary_lines(results)))
    return PARKED if all(result.passed for result in results) else NOT_PARKED


def _print_bibtex(names: list[str]) -> int:
    from orchestrator.studies.papers.table_files import bibtex_entries

    for name in names:
        paper(name)
    entries = bibtex_entries()
    print("\n".join(entries[name] for name in names if name in entries), end="")
    return PARKED


def _driver(kind: str) -> "Drive":
    from orchestrator.studies.papers.drive import drive

    files = None if kind == "none" else fmu_files(kind, say)
    done: dict[str, Driven] = {}

    def drive_once(name: str) -> "Driven":
        if name not in done:
            say(f"driving {name}")
            done[name] = drive(name, files, kind)
        return done[name]

    return drive_once
