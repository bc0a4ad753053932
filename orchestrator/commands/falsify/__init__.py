"""``apa falsify``: falsification: search a study's ranges for violations of a requirement."""

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

from fmus.installation import missing_package
from orchestrator.commands.sweep import select_study
from orchestrator.inputs.text.console import console, resuming_command
from orchestrator.inputs.text.errors import INTERRUPTED, NOT_PARKED, PARKED, BadInput, NotRunError
from orchestrator.inputs.text.locked_folder import lock_folder
from orchestrator.simulation.cosim.kinds import KINDS

if TYPE_CHECKING:
    from orchestrator.studies.falsification.falsify import FalsificationResult
    from orchestrator.studies.falsification.subject import Subject

EXAMPLES = """examples:
  apa falsify apa-world                              search for contact of the parking system
  apa falsify apa-world --requirement claim --budget 5000 --seed 2
  apa falsify my-study.yaml --requirement "final heading"
  apa falsify my-study.yaml --controller their.fmu --budget 300
  apa falsify apa-world --resume                     continue after Ctrl-C
  apa falsify --regression runs/falsify-apa-world/counterexamples     run known counterexamples again

exit codes: 0 no violation, 1 a run violates the requirement, 2 bad input, 130 interrupted; see docs/falsification.md
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument(
        "study", nargs="?", metavar="STUDY", help="study whose ranges are searched: a shipped one, or a YAML file"
    )
    parser.add_argument(
        "--budget", type=int, default=2000, metavar="N", help="approximate number of runs (default: 2000)"
    )
    parser.add_argument(
        "--requirement", metavar="LIMIT", help="objective, requirement or set of requirements (default: contact)"
    )
    parser.add_argument("--seed", type=int, default=1, metavar="S", help="random seed (1)")
    parser.add_argument("--out", type=Path, metavar="DIR", help="output folder (default: runs/falsify-STUDY)")
    parser.add_argument("--resume", action="store_true", help="continue an interrupted search")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="as in apa sweep")
    parser.add_argument("--controller", type=Path, metavar="FMU", help="search with a third-party controller FMU")
    parser.add_argument("--fmus", choices=(*KINDS, "none"), help="FMUs of this kind instead of the compiled batch")
    parser.add_argument("-j", "--jobs", type=int, metavar="N", help="threads or processes (default: all cores)")
    parser.add_argument(
        "--regression", type=Path, metavar="DIR", help="only run the counterexamples of this folder again"
    )
    parser.add_argument("--json", action="store_true", help="print the result as JSON")


def run(arguments: argparse.Namespace) -> int:
    """Search, write counterexamples and page, print the result. Returns 1 if a run breaks the requirement, else 0."""
    try:
        import cma  # noqa: F401
        import pyarrow  # noqa: F401
    except ModuleNotFoundError as error:
        raise BadInput(missing_package(error.name or "", "native,sweep")) from error
    except AttributeError as error:
        raise BadInput("the package cma needs docstrings: run Python without -OO (PYTHONOPTIMIZE=2)") from error
    if arguments.regression is not None:
        return _corpus(arguments.regression, as_json=arguments.json)
    if arguments.study is None:
        raise BadInput("expected a study, or --regression DIR", key="STUDY")
    for name, least in (("budget", 50), ("seed", 0), ("jobs", 1)):
        value = getattr(arguments, name)
        if value is not None and not least <= value < 10**9:
            raise BadInput(f"{value}: expected a number from {least}", key=f"--{name}")
    return _hunt(arguments)


def _hunt(arguments: argparse.Namespace) -> int:
    from orchestrator.studies.falsification.begin import begin
    from orchestrator.studies.falsification.falsify import falsify
    from orchestrator.studies.falsification.page import as_json, write_page
    from orchestrator.studies.falsification.subject import Stopped

    study = select_study(arguments.study, arguments.set)
    out: Path = arguments.out or Path("runs") / f"falsify-{study.name}"
    with lock_folder(out):
        subject = begin(study, arguments, out)
        try:
            result = falsify(subject, arguments.budget, arguments.seed, out / "counterexamples")
        except Stopped:
            console().print(f"{subject.runs} runs are kept; go on with: {resuming_command()}", markup=False)
            return INTERRUPTED
        except NotRunError as error:
            count = "1 run " if len(error.args) == 1 else ""
            kept = f"{subject.runs} runs are kept, --resume goes on"
            raise BadInput(f"{study.name}: no result, for {count}{error}; {kept}") from error
        reported = as_json(subject, result)
        page = write_page(subject, result, out)
    if arguments.json:
        print(json.dumps({**reported, "page": str(page)}, indent=2))
    else:
        _print(subject, result, page)
    return NOT_PARKED if result.broken else PARKED


def _print(subject: "Subject", result: "FalsificationResult", page: Path) -> None:
    from orchestrator.studies.falsification.page import bound_text, counterexamples_text

    screen = console()
    screen.print(f"{result.runs} runs, {result.broken} violate: {subject.objective.text}", markup=False)
    for line in (*counterexamples_text(subject, result), *bound_text(result)):
        screen.print(line, markup=False, soft_wrap=True)
    screen.print(f"page in {page}", markup=False)


def _corpus(folder: Path, *, as_json: bool) -> int:
    from orchestrator.studies.falsification.counterexamples import rerun_counterexamples

    again = rerun_counterexamples(folder)
    if as_json:
        print(json.dumps([item._asdict() for item in again], indent=2))
    else:
        for item in again:
            bits = "same bits" if item.same else "another run than when it was found"
            console().print(f"{item.name}: {'breaks' if item.breaks else 'holds'} ({item.words}), {bits}", markup=False)
    return NOT_PARKED if any(item.breaks for item in again) else PARKED
