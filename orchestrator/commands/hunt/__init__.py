"""``apa hunt``: falsification: search a study's ranges for violations of a requirement."""

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

from fmus.installation import missing_package
from orchestrator.commands.sweep import chosen_study
from orchestrator.cosim.kinds import KINDS
from orchestrator.text.console import console
from orchestrator.text.errors import INTERRUPTED, NOT_PARKED, PARKED, BadInput, NotRunError
from orchestrator.text.owned import owned

if TYPE_CHECKING:
    from orchestrator.hunt.hunt import Hunted
    from orchestrator.hunt.subject import Subject

EXAMPLES = """examples:
  apa hunt apa-world                              what makes the parking assist touch something?
  apa hunt apa-world --requirement claim --budget 5000 --seed 2
  apa hunt my-study.yaml --requirement "final heading"
  apa hunt my-study.yaml --controller their.fmu --budget 300
  apa hunt apa-world --resume                     go on after Ctrl-C
  apa hunt --corpus runs/hunt-apa-world/finds     run what was found before again

exit code: 0 nothing found, 1 a run breaks the requirement, 2 bad input, 130 interrupted; see docs/falsification.md.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("study", nargs="?", metavar="STUDY", help="a shipped study, or a YAML file: its ranges")
    parser.add_argument(
        "--budget", type=int, default=2000, metavar="N", help="approximate number of runs (default: 2000)"
    )
    parser.add_argument("--requirement", metavar="LIMIT", help="a limit or a set of limits (default: contact)")
    parser.add_argument("--seed", type=int, default=1, metavar="S", help="random seed (1)")
    parser.add_argument("--out", type=Path, metavar="DIR", help="output folder (default: runs/hunt-STUDY)")
    parser.add_argument("--resume", action="store_true", help="continue an interrupted search")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="as in apa sweep")
    parser.add_argument("--controller", type=Path, metavar="FMU", help="search with a third-party controller FMU")
    parser.add_argument("--fmus", choices=(*KINDS, "none"), help="FMUs of this kind instead of the compiled batch")
    parser.add_argument("--workers", type=int, metavar="N", help="threads or processes (default: all cores)")
    parser.add_argument("--corpus", type=Path, metavar="DIR", help="only run the counterexamples of this folder again")
    parser.add_argument("--json", action="store_true", help="print the result as JSON")


def run(arguments: argparse.Namespace) -> int:
    """Search, write finds and page, print what was found. Returns 1 if a run breaks the requirement, else 0."""
    try:
        import cma  # noqa: F401
        import pyarrow  # noqa: F401
    except ModuleNotFoundError as error:
        raise BadInput(missing_package(error.name or "", "native,sweep")) from error
    if arguments.corpus is not None:
        return _corpus(arguments.corpus, as_json=arguments.json)
    if arguments.study is None:
        raise BadInput("expected a study, or --corpus DIR", key="STUDY")
    for name, least in (("budget", 50), ("seed", 0), ("workers", 1)):
        value = getattr(arguments, name)
        if value is not None and not least <= value < 10**9:
            raise BadInput(f"{value}: expected a number from {least}", key=f"--{name}")
    return _hunt(arguments)


def _hunt(arguments: argparse.Namespace) -> int:
    from orchestrator.hunt.begin import begin
    from orchestrator.hunt.hunt import hunt
    from orchestrator.hunt.page import as_json, write_page
    from orchestrator.hunt.subject import Stopped

    study = chosen_study(arguments.study, arguments.set)
    out: Path = arguments.out or Path("runs") / f"hunt-{study.name}"
    with owned(out):
        subject = begin(study, arguments, out)
        try:
            hunted = hunt(subject, arguments.budget, arguments.seed, out / "finds")
        except Stopped:
            console().print(
                f"{subject.runs} runs are kept; go on with: apa hunt {arguments.study} --resume", markup=False
            )
            return INTERRUPTED
        except NotRunError as error:
            count = "1 run " if len(error.args) == 1 else ""
            kept = f"{subject.runs} runs are kept, --resume goes on"
            raise BadInput(f"{study.name}: no result, for {count}{error}; {kept}") from error
        told = as_json(subject, hunted)
        page = write_page(subject, hunted, out)
    if arguments.json:
        print(json.dumps({**told, "page": str(page)}, indent=2))
    else:
        _print(subject, hunted, page)
    return NOT_PARKED if hunted.broken else PARKED


def _print(subject: "Subject", hunted: "Hunted", page: Path) -> None:
    from orchestrator.hunt.page import bound_text, finds_text

    screen = console()
    screen.print(f"{hunted.runs} runs, {hunted.broken} break: {subject.goal.text}", markup=False)
    for line in (*finds_text(subject, hunted), *bound_text(hunted)):
        screen.print(line, markup=False, soft_wrap=True)
    screen.print(f"page in {page}", markup=False)


def _corpus(folder: Path, *, as_json: bool) -> int:
    from orchestrator.hunt.finds import check_corpus

    again = check_corpus(folder)
    if as_json:
        print(json.dumps([item._asdict() for item in again], indent=2))
    else:
        for item in again:
            bits = "same bits" if item.same else "another run than when it was found"
            console().print(f"{item.name}: {'breaks' if item.breaks else 'holds'} ({item.words}), {bits}", markup=False)
    return NOT_PARKED if any(item.breaks for item in again) else PARKED
