"""``apa sweep``: a study of thousands of runs, from YAML to a table and a page."""

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

from orchestrator.cosim.fmu_files import KINDS
from orchestrator.text.console import console
from orchestrator.text.errors import INTERRUPTED, PARKED, BadInput

if TYPE_CHECKING:
    from orchestrator.sweep.study import Study
    from orchestrator.sweep.sweep import Swept

EXAMPLES = """examples:
  apa sweep guo2015-speed-rate                 compiled, on all cores; table and page in runs/guo2015-speed-rate
  apa sweep guo2015-trial --set vehicle.body=single_track --json
  apa sweep my-study.yaml --resume             go on after Ctrl-C, a kill or a power cut
  apa sweep my-study.yaml --fmus native        the same table from FMUs, only slower
  apa sweep my-study.yaml --dask               on a Dask cluster of this machine's own
  apa sweep my-study.yaml --dask tcp://10.0.0.5:8786
  apa replay runs/my-study/my-study.parquet --row 17

A study is made of a scenario and of what is varied: grid, monte_carlo, latin_hypercube; see docs/sweeps.md.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("study", metavar="NAME|FILE", help="a shipped study, or a YAML file")
    parser.add_argument("--out", type=Path, metavar="DIR", help="where table and page go (default: runs/NAME)")
    parser.add_argument("--resume", action="store_true", help="go on with an unfinished study")
    parser.add_argument("--restart", action="store_true", help="throw the runs of an unfinished study away")
    parser.add_argument("--fmus", choices=KINDS, help="run FMUs of this kind instead of the compiled batch")
    parser.add_argument(
        "--dask", nargs="?", const="local", metavar="ADDRESS", help="use Dask: its own local workers, or a scheduler's"
    )
    parser.add_argument("--workers", type=int, metavar="N", help="threads or processes (default: all cores)")
    parser.add_argument("--chunk", type=int, metavar="N", help="runs per part, at most these are lost by a kill")
    parser.add_argument("--picture", type=Path, metavar="FILE", help="write the success map as a PNG, too")
    parser.add_argument("--replays", type=int, default=3, metavar="N", help="replay the N worst runs for the page (3)")
    parser.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="as in apa run, for all runs of the study"
    )
    parser.add_argument("--json", action="store_true", help="print what came of it as JSON")
    parser.add_argument("--no-page", action="store_true", help="write no result page")


def run(arguments: argparse.Namespace) -> int:
    """Run what is missing, write table and page, print the outcome. Returns 0, 130 if interrupted."""
    from orchestrator.sweep.study import load_study

    for name in ("workers", "chunk"):
        if getattr(arguments, name) is not None and getattr(arguments, name) < 1:
            raise BadInput(f"{getattr(arguments, name)}: expected 1 or more", key=f"--{name}")
    try:
        from orchestrator.sweep.sweep import Options, sweep
    except ModuleNotFoundError as error:
        raise BadInput(f"{error.name} is not installed; run: pip install 'apa-cosim[native,sweep]'") from error
    study = _with(load_study(arguments.study), arguments.set)
    out: Path = arguments.out or Path("runs") / study.name
    out.mkdir(parents=True, exist_ok=True)
    names = ("fmus", "dask", "workers", "chunk", "resume", "restart")
    swept = sweep(study, out, Options(**{name: getattr(arguments, name) for name in names}))
    written = {} if swept.table is None else _write(swept.table, arguments)
    if arguments.json:
        numbers = {"count": swept.count, "done": swept.done, "made": swept.made, "seconds": swept.seconds}
        files = {name: str(path) for name, path in written.items()}
        print(json.dumps({**numbers, "engine": swept.engine, "note": swept.note, **files}, indent=2))
    else:
        _print(swept, written, arguments.study)
    return INTERRUPTED if swept.table is None else PARKED


def _with(study: "Study", sets: list[str]) -> "Study":
    """Return the study with further changes of its scenario."""
    for text in sets:
        if "=" not in text:
            raise BadInput(f"{text!r}: expected KEY=VALUE", file="--set")
    return study.model_copy(update={"set": {**study.set, **dict(text.split("=", 1) for text in sets)}})


def _write(table: Path, arguments: argparse.Namespace) -> dict[str, Path]:
    """Write picture and page, as far as they are asked for; return what there is now."""
    written = {"table": table}
    if arguments.picture is not None:
        from orchestrator.sweep.picture import draw_maps
        from orchestrator.sweep.store import Table

        draw_maps(Table(table), arguments.picture)
        written["picture"] = arguments.picture
    if not arguments.no_page:
        from orchestrator.sweep.page import write_page

        _replay_worst(table, arguments.replays)
        written["page"] = write_page(table)
    return written


def _print(swept: "Swept", written: dict[str, Path], study: str) -> None:
    screen = console()
    if swept.note:
        screen.print(f"not compiled: {swept.note}", markup=False)
    if swept.made:
        rate = swept.made / swept.seconds
        screen.print(f"{swept.made} runs in {swept.seconds:.1f} s, {rate:.0f} a second ({swept.engine})", markup=False)
    if swept.table is None:
        screen.print(f"{swept.done} of {swept.count} runs are kept; go on with: apa sweep {study} --resume")
    for name, path in written.items():
        screen.print(f"{name} in {path}", markup=False)


def _replay_worst(path: Path, count: int) -> None:
    """Run the worst rows again with log and replay page, so that the result page can link to them."""
    from orchestrator.sweep.repeat import folder_of_row, repeat_row
    from orchestrator.sweep.statistics import worst
    from orchestrator.sweep.store import Table

    table = Table(path)
    for number in worst(table, count):
        repeat_row(table, number, folder_of_row(path, number))
