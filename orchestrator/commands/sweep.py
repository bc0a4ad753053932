"""``apa sweep``: a study of many runs, to a table and a page."""

import argparse
import importlib
import inspect
import json
from pathlib import Path
from typing import TYPE_CHECKING

from fmus.installation import missing_package
from orchestrator.commands import STUDIES
from orchestrator.inputs.text.console import console, result_table, resuming_command
from orchestrator.inputs.text.errors import INTERRUPTED, PARKED, BadInput, format_value, suggestion_or_choices
from orchestrator.inputs.text.failures import verdict_stands
from orchestrator.inputs.text.locked_folder import lock_folder
from orchestrator.presentation.drawing.save import check_picture
from orchestrator.simulation.cosim.kinds import KINDS, fastest_kind

if TYPE_CHECKING:
    from rich.table import Table as RichTable

    from orchestrator.studies.sweep.study.space import Factor
    from orchestrator.studies.sweep.study.study import Study
    from orchestrator.studies.sweep.sweep import Swept

EXAMPLES = """examples:
  apa sweep guo2015-speed-rate                 compiled, on all cores; table and page in runs/guo2015-speed-rate
  apa sweep guo2015-trial --set vehicle.body=single_track --json
  apa sweep apa-grid --stride 20               each 20th run of the parking system's grid
  apa sweep my-study.yaml --resume             continue after Ctrl-C, a kill or a power cut
  apa sweep my-study.yaml --fmus native        the same table from FMUs, slower
  apa sweep my-study.yaml --dask               on a Dask cluster on this machine
  apa sweep my-study.yaml --dask tcp://10.0.0.5:8786
  apa sweep parking-world --set mild=1 --set overhang=hitch --set kind=parallel --runs 150
  apa sweep guo2015-speed-rate --explain       parts of the models that the compiled study omits
  apa replay runs/my-study/my-study.parquet --row 17

A study names a scenario and the parameters to vary: grid, monte_carlo, latin_hypercube; see docs/studies.md.
`apa list` lists the shipped studies; some print a table of results.
"""
MAX_OUTCOMES = 10
"""Rows of the table of outcomes that is printed; the page has twice as many."""
COUNTS = ("runs", "drivers")
"""Arguments of studies that are numbers of runs."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("study", metavar="NAME|FILE", help="a shipped study, or a YAML file")
    parser.add_argument("--out", type=Path, metavar="DIR", help="output folder of table and page (default: runs/NAME)")
    parser.add_argument("--resume", action="store_true", help="continue an unfinished study")
    parser.add_argument("--restart", action="store_true", help="discard the runs of an unfinished study")
    parser.add_argument(
        "--fmus", choices=(*KINDS, "none"), help="FMUs of this kind, or none, instead of the compiled batch"
    )
    parser.add_argument(
        "--dask", nargs="?", const="local", metavar="ADDRESS", help="use Dask: local workers, or those of a scheduler"
    )
    parser.add_argument("-j", "--jobs", type=int, metavar="N", help="threads or processes (default: all cores)")
    parser.add_argument(
        "--chunk", type=int, metavar="N", help="runs per chunk; a killed study loses at most the current chunks"
    )
    parser.add_argument("--figure", type=Path, metavar="FILE", help="also write the success map as a PNG")
    parser.add_argument("--replays", type=int, default=3, metavar="N", help="replay the N worst runs for the page (3)")
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="as in apa run, for all runs; also the seed, the arguments and the factors of the study",
    )
    parser.add_argument("--runs", type=int, metavar="N", help="number of samples of the study")
    parser.add_argument("--seed", type=int, metavar="S", help="random seed of the study")
    parser.add_argument("--offset", type=int, default=0, metavar="N", help="start at run N of the study")
    parser.add_argument("--stride", type=int, default=1, metavar="N", help="run only each N-th run of the study")
    parser.add_argument(
        "--explain",
        action="store_true",
        help="print the parts of the models that the compiled study omits; run nothing",
    )
    parser.add_argument("--json", action="store_true", help="print the result as JSON")
    parser.add_argument("--no-page", action="store_true", help="write no result page")


def run(arguments: argparse.Namespace) -> int:
    """Run what is missing, write table and page, print the outcome. Returns 0, or what the study makes of its table;
    130 if interrupted."""
    for name, least in {"jobs": 1, "chunk": 1, "stride": 1, "runs": 1, "seed": 0, "offset": 0}.items():
        value = getattr(arguments, name)
        if value is not None and value < least:
            raise BadInput(f"{value}: expected {least} or more", key=f"--{name}")
    try:
        from orchestrator.studies.sweep.sweep import Options, sweep
    except ModuleNotFoundError as error:
        raise BadInput(missing_package(error.name or "", "native,sweep")) from error
    if arguments.figure is not None:
        check_picture(arguments.figure)
    own = [f"{key}={getattr(arguments, key)}" for key in ("runs", "seed") if getattr(arguments, key) is not None]
    study = select_study(arguments.study, [*arguments.set, *own])
    study = study._replace(design=study.design.part(arguments.offset, arguments.stride))
    if not len(study.design.seeds):
        raise BadInput(f"{arguments.offset}: the study has fewer runs", key="--offset")
    if arguments.explain:
        return _explain(study)
    out: Path = arguments.out or Path("runs") / study.name
    names = ("fmus", "dask", "chunk", "resume", "restart")
    with lock_folder(out):
        swept = sweep(study, out, Options(workers=arguments.jobs, **{name: getattr(arguments, name) for name in names}))
        written = {} if swept.table is None else _write(swept.table, arguments)
        _tell(swept, written, arguments)
        if swept.not_run is not None:
            raise BadInput(_not_run(swept, study.name))
        if swept.table is None:
            return INTERRUPTED
        return _report(arguments.study, swept.table, quiet=arguments.json)


def _explain(study: "Study") -> int:
    """Print what the code of a study omits, and from which number of runs a study has code of its own."""
    from orchestrator.studies.sweep.batch import explain
    from orchestrator.studies.sweep.engines import choose_task
    from orchestrator.studies.sweep.job import Chunk, make_job
    from orchestrator.studies.sweep.study_code import STUDY_CODE_FROM

    task, job, design = choose_task(study.scenario, None), make_job(study), study.design
    if not task.is_compiled:
        raise BadInput(f"nothing is compiled: {task.note}", key="--explain")
    print(explain(job, Chunk(0, 0, design.values, design.seeds)))
    use = "has" if job.runs >= STUDY_CODE_FROM else "does not have"
    print(f"a study of {job.runs:,} runs {use} code of its own (from {STUDY_CODE_FROM:,} runs)")
    return PARKED


def _not_run(swept: "Swept", name: str) -> str:
    """Return how many runs could not take place, and why."""
    assert swept.not_run is not None
    count, kept = len(swept.not_run.args), f"{swept.done} of {swept.count} runs are kept"
    why = str(swept.not_run) if count > 1 else f"1 run {swept.not_run}"
    return f"{name}: {why}; {kept}, --resume makes the others"


def _tell(swept: "Swept", written: dict[str, Path], arguments: argparse.Namespace) -> None:
    if arguments.json:
        not_run = len(swept.not_run.args) if swept.not_run else 0
        numbers = {"count": swept.count, "done": swept.done, "made": swept.made, "seconds": swept.seconds}
        numbers |= {"not_run": not_run, "aborted": swept.aborted}
        files = {name: str(path) for name, path in written.items()}
        print(json.dumps({**numbers, "engine": swept.engine, "note": swept.note, **files}, indent=2))
    else:
        _print(swept, written)


def select_study(name: str, sets: list[str]) -> "Study":
    """Return the study that a word on the command line means, changed by ``KEY=VALUE``. Raises ``BadInput``."""
    from orchestrator.studies.sweep.study.read_study import read_study

    for text in sets:
        if "=" not in text:
            raise BadInput(f"{format_value(text)}: expected KEY=VALUE", file="--set")
    pairs = dict(text.split("=", 1) for text in sets)
    if name not in STUDIES:
        return read_study(name, pairs, STUDIES)
    made: Study = importlib.import_module(STUDIES[name]).study(**_study_arguments(name, pairs))
    return made


def _study_arguments(name: str, pairs: dict[str, str]) -> dict[str, float]:
    """Return the arguments of a study that a function makes: those that its signature names, and values of factors."""
    module = importlib.import_module(STUDIES[name])
    parameters = inspect.signature(module.study).parameters
    named = [key for key, item in parameters.items() if item.kind is not inspect.Parameter.VAR_KEYWORD]
    factors = {factor.name: factor for factor in module.FACTORS} if len(named) < len(parameters) else {}
    for key in pairs:
        if key not in named and key not in factors:
            hint = suggestion_or_choices(key, [*named, *factors])
            place = f"--{key}" if key in ("runs", "seed") else f"--set: {key}"
            raise BadInput(f"{name} has no such key{hint}", key=place)
    return {
        key: _value_of_factor(factors[key], value) if key in factors else _argument(parameters[key], value)
        for key, value in pairs.items()
    }


def _argument(parameter: inspect.Parameter, text: str) -> float:
    """Return the value of an argument of a study: a number of runs from 1, another number from 0, true or false."""
    from modelkit.signal import Signal
    from modelkit.variables import Variable
    from orchestrator.inputs.text.quantities import MOST_WHOLE, scalar
    from orchestrator.studies.sweep.study.study_file import MOST_RUNS

    low, high = (1, MOST_RUNS) if parameter.name in COUNTS else (0, MOST_WHOLE - 1)
    variable = Variable(parameter.name, parameter.annotation, Signal("1", "", low, high), parameter.default)
    return scalar(text, variable, file="--set")


def _value_of_factor(factor: "Factor", text: str) -> float:
    """Return the value that a text means: one of the range of a factor, or the number of one of its choices."""
    from modelkit.variables import Variable
    from orchestrator.inputs.text.quantities import scalar

    if text in factor.choices:
        return float(factor.choices.index(text))
    if not factor.choices:
        return float(scalar(text, Variable(factor.name, float, factor.signal, factor.nominal), file="--set"))
    are_numbers = any(name.isdigit() for name in factor.choices)
    if are_numbers or not (text.isascii() and text.isdigit() and int(text) < len(factor.choices)):
        expected = f"expected one of {', '.join(dict.fromkeys(factor.choices))}"
        places = "" if are_numbers else f", or 0 to {len(factor.choices) - 1}"
        raise BadInput(f"{format_value(text)}: {expected}{places}", file="--set", key=factor.name)
    return float(text)


def _report(name: str, table: Path, *, quiet: bool) -> int:
    """Let a study say what it makes of its table; return its exit code."""
    from orchestrator.studies.sweep.table import Table

    if name not in STUDIES or quiet:
        return PARKED
    return int(importlib.import_module(STUDIES[name]).report(Table(table), table.parent))


def _write(table: Path, arguments: argparse.Namespace) -> dict[str, Path]:
    """Write picture and page, as far as they are asked for; return what there is now."""
    written = {"table": table}
    if arguments.figure is not None:
        from orchestrator.studies.sweep.page.picture import draw_maps
        from orchestrator.studies.sweep.table import Table

        with verdict_stands(str(arguments.figure)):
            draw_maps(Table(table), arguments.figure)
            written["picture"] = arguments.figure
    if not arguments.no_page:
        from orchestrator.studies.sweep.page.page import write_page

        with verdict_stands("the result page"):
            _replay_worst(table, arguments.replays)
            written["page"] = write_page(table, _write_live_page(table))
    return written


def _write_live_page(path: Path) -> str:
    """Write the page that replays runs beside the table; return its name, empty where it cannot be made."""
    from fmus.native.web import can_build
    from orchestrator.studies.sweep.page.explorer import live_scenario
    from orchestrator.studies.sweep.store import LIVE_SUFFIX
    from orchestrator.studies.sweep.table import Table

    page = path.with_name(f"{path.stem}{LIVE_SUFFIX}")
    scenario = live_scenario(Table(path)) if can_build() else None
    if scenario is None:
        page.unlink(missing_ok=True)
        return ""
    from orchestrator.studies.live.page import write_live

    with verdict_stands(str(page)):
        write_live(page, [scenario])
        return page.name
    return ""


def _print(swept: "Swept", written: dict[str, Path]) -> None:
    screen = console()
    if swept.note:
        screen.print(f"not compiled: {swept.note}", markup=False)
    if swept.made:
        rate = swept.made / swept.seconds
        screen.print(f"{swept.made} runs in {swept.seconds:.1f} s, {rate:.0f} a second ({swept.engine})", markup=False)
    if swept.aborted:
        screen.print(f"{swept.aborted} of {swept.made} runs were aborted by a model", markup=False)
    if swept.table is None and swept.not_run is None:
        screen.print(f"{swept.done} of {swept.count} runs are kept; go on with: {resuming_command()}", markup=False)
    if swept.table is not None:
        screen.print(_outcome_table(swept.table))
    for name, path in written.items():
        screen.print(f"{name} in {path}", markup=False)


def _outcome_table(path: Path) -> "RichTable":
    """Return the outcomes of a study as a table: how many runs end how, with Wilson's 95 % interval."""
    from rich.markup import escape

    from orchestrator.studies.sweep.page.statistics import outcome_counts
    from orchestrator.studies.sweep.table import Table

    shown = result_table(console(), ("outcome", "reason", "runs", "share", "95 % interval"), ("outcome", "reason"))
    for item in outcome_counts(Table(path), most=MAX_OUTCOMES):
        interval = f"{100.0 * item.low:.2f} to {100.0 * item.high:.2f} %"
        shown.add_row(item.outcome, escape(item.reason), str(item.runs), f"{100.0 * item.share:.2f} %", interval)
    return shown


def _replay_worst(path: Path, count: int) -> None:
    """Run the worst rows again with log and replay page, so that the result page can link to them."""
    from orchestrator.studies.sweep.page.statistics import worst
    from orchestrator.studies.sweep.repeat import folder_of_row, repeat_row
    from orchestrator.studies.sweep.table import Table

    table = Table(path)
    for number in worst(table, count):
        repeat_row(table, number, folder_of_row(path, number), fastest_kind())
