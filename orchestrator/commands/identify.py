"""``apa identify``: parameters of the vehicle and its odometry from a log."""

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

from fmus.files import write_whole
from orchestrator.inputs.text.console import console, result_table, say, working
from orchestrator.inputs.text.errors import NOT_PARKED, PARKED, BadInput
from orchestrator.inputs.text.locked_folder import lock_folder
from orchestrator.inputs.text.quantities import number

if TYPE_CHECKING:
    from orchestrator.studies.identification.result import Identification

EXAMPLES = """examples:
  apa identify runs/guo2015-case4                             a log of apa
  apa identify drive.csv --column pose.x=x --column "pose.heading=yaw" --unit yaw=deg
  apa identify drive.mf4 --fit car.steering.ratio,steering.lag --set car.wheelbase=2.62
  apa identify drive.csv --car zhang2022 --out runs/my-car --json

The log has a pose, and either requests (steering_wheel_request, speed_request) or measurements that the model
follows (steering_wheel_angle, measured_speed). Columns that have the vehicle's names (pose.x, speed, ...) need no
--column; units of headers are read. Writes identification.json, report.html with the residuals, and car.yaml for
`car:` of a scenario.

exit codes: 0 all parameters identified, 1 some are not (they are named, without a value), 2 bad input
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("log", type=Path, metavar="LOG", help=".csv, .mf4 or .mcap, or the folder of a run")
    parser.add_argument(
        "--column",
        action="append",
        default=[],
        metavar="SIGNAL=COLUMN",
        help="column of a signal, such as pose.x=easting",
    )
    parser.add_argument(
        "--unit", action="append", default=[], metavar="COLUMN=UNIT", help="unit that the log does not state"
    )
    parser.add_argument("--fit", metavar="A,B", help="parameters to identify (default: chosen by the signals)")
    parser.add_argument(
        "--car", default="", metavar="CAR", help="shipped car, or file: start values and known parameters"
    )
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="known parameter, such as car.wheelbase=2.62"
    )
    parser.add_argument("--from", dest="begin", metavar="S", help="use the log from this time on")
    parser.add_argument("--to", dest="end", metavar="S", help="use the log up to this time")
    parser.add_argument("--out", type=Path, metavar="DIR", help="output folder (default: runs/identify-LOG)")
    parser.add_argument("--json", action="store_true", help="print identification.json instead of the table")
    parser.add_argument("--no-page", action="store_true", help="write no page")


def run(arguments: argparse.Namespace) -> int:
    """Identify, write, print. Returns 0 if all parameters are identified, else 1."""
    from orchestrator.presentation.log.read_log import log_file, log_name
    from orchestrator.studies.identification.car_file import base_car, write_car
    from orchestrator.studies.identification.identify import identify, usual_parameters
    from orchestrator.studies.identification.logs import Columns, read_drive
    from orchestrator.studies.identification.page import write_identification_page
    from orchestrator.studies.identification.result import as_json
    from orchestrator.studies.identification.signals import check_signal

    log = log_file(str(arguments.log))
    name = log_name(log)
    columns = {check_signal(key): value for key, value in _pairs(arguments.column, "--column").items()}
    span = _seconds(arguments.begin, "--from", float("-inf")), _seconds(arguments.end, "--to", float("inf"))
    settings = _pairs(arguments.set, "--set")
    base = base_car(arguments.car, settings)
    drive = read_drive(log, Columns(columns, _pairs(arguments.unit, "--unit"), span))
    given = [key.removeprefix("vehicle.") for key in settings]
    names = arguments.fit.split(",") if arguments.fit else usual_parameters(drive, base.values, given)
    with working("identifying"):
        found = identify(drive, base.values, [item.strip() for item in names])
    out: Path = arguments.out or Path("runs") / f"identify-{name}"
    content = {"log": str(log), **as_json(found)}
    with lock_folder(out):
        write_whole(out / "identification.json", json.dumps(content, indent=2) + "\n")
        if found.values:
            write_car(out / "car.yaml", base, found.values, f"apa identify {log.name}")
        if not arguments.no_page:
            write_identification_page(out / "report.html", found, name)
    if arguments.json:
        print(json.dumps(content, indent=2))
    else:
        _print(found, out)
    return PARKED if len(found.values) == len(found.parameters) else NOT_PARKED


def _print(found: "Identification", out: Path) -> None:
    from orchestrator.studies.identification.result import interval_text, notes, sentence, value_text

    screen = console()
    titles = ("parameter", "value", "95 % interval", "unit", "")
    table = result_table(screen, titles, ("parameter", "unit", ""))
    for item in found.parameters:
        cells = (value_text(item), interval_text(item)) if item.identified else ("", "")
        verdict = "[green]identified[/]" if item.identified else "[yellow]not identified[/]"
        table.add_row(item.candidate.name, *cells, item.unit, verdict)
    screen.print(table)
    values = " ".join(f"{value:.3g}" for value in found.identifiability.singular_values)
    screen.print(f"singular values (1 / useful accuracy): {values}")
    for group in found.identifiability.undetermined:
        screen.print(f"not identified: {sentence(group)}", markup=False)
    for line in notes(found):
        screen.print(f"note: {line}", markup=False)
    if not found.values:
        say("no car.yaml: the log identifies no parameter")
    screen.print(str(out), markup=False)


def _pairs(texts: list[str], key: str) -> dict[str, str]:
    """Return the pairs of ``A=B`` options. Raises ``BadInput``."""
    pairs = {}
    for text in texts:
        name, mark, value = text.partition("=")
        if not mark or not name.strip() or not value.strip():
            raise BadInput(f"{text!r}: expected NAME=VALUE", key=key)
        pairs[name.strip()] = value.strip()
    return pairs


def _seconds(text: str | None, key: str, default: float) -> float:
    return default if text is None else number(text, "s", key=key)
