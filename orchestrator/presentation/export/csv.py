"""``apa export csv``: a run as a table that any tool reads."""

import argparse
import csv
from pathlib import Path

from fmus.files import whole
from orchestrator.inputs.text.locked_folder import lock_with
from orchestrator.inputs.text.patterns import matching
from orchestrator.presentation.log.read_log import log_file, read_log
from orchestrator.simulation.cosim.recording import Recording

EXAMPLES = """examples:
  apa export csv runs/guo2015-case4/run.mcap
  apa export csv run.mcap --signals "vehicle.pose.*" --out pose.csv --names

The first row has the names of the signals, the second their units. Reading the numbers gives the same bits.
"""

ROWS_AT_ONCE = 1 << 12


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the format takes."""
    add_run_arguments(parser, ".csv")
    parser.add_argument("--names", action="store_true", help="names of states instead of numbers")


def add_run_arguments(parser: argparse.ArgumentParser, suffix: str) -> None:
    """Add what every export of a run takes."""
    parser.add_argument("log", type=log_file, metavar="RUN.mcap", help="log of a run, or its folder")
    parser.add_argument(
        "--out", type=Path, metavar="FILE", help=f"output file (default: name of the log with {suffix})"
    )
    parser.add_argument(
        "--signals", action="append", metavar="PATTERN", help="export only these signals, for example vehicle.pose.*"
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the table. Returns 0."""
    out: Path = arguments.out or arguments.log.with_suffix(".csv")
    with lock_with(arguments.log, out):
        recording = read_log(arguments.log)
        write_csv(out, recording, matching(recording.signals, arguments.signals), arguments.names)
    print(out)
    return 0


def write_csv(path: Path, recording: Recording, names: list[str], words: bool) -> None:
    """Write the signals ``names`` over time [s]; modes as numbers, or as ``words``."""
    units = [recording.variables[name].signal.unit for name in names]
    with whole(path) as part, part.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(["time", *names])
        writer.writerow(["s", *units])
        for first in range(0, recording.count, ROWS_AT_ONCE):
            rows = recording.between(first, min(first + ROWS_AT_ONCE, recording.count))
            columns = [[repr(t) for t in rows.t.tolist()], *(_texts(rows, name, words) for name in names)]
            writer.writerows(zip(*columns, strict=True))


def _texts(rows: Recording, name: str, words: bool) -> list[object]:
    """Return the values of a signal as they are written."""
    values = rows.signals[name].tolist()
    states = rows.states(name) if words else {}
    if states:
        return [states.get(value, value) for value in values]
    if rows.variables[name].kind is float:
        return [repr(value) for value in values]
    return [int(value) if value == value else value for value in values]
