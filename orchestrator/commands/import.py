"""``apa import``: scenes of others as scenarios."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from fmus.files import write_whole
from orchestrator.inputs.scenario.tpcap import read_tpcap
from orchestrator.inputs.text.errors import BadInput
from orchestrator.studies.benchmark.parkbench import read_parkbench


class Format(NamedTuple):
    """A benchmark's format: the end of its files' names, and its reader, which gives a scenario as plain data."""

    suffix: str
    read: Callable[[Path], dict[str, Any]]


READERS = {"tpcap": Format(".csv", read_tpcap), "parkbench": Format(".json", read_parkbench)}
EXAMPLES = """examples:
  apa import tpcap Case7.csv
  apa import tpcap cases --out tpcap         every .csv of a folder
  apa import parkbench Constrained_Parking_Scenarios/rear_in --out parkbench
  apa run tpcap/Case7.yaml
  apa bench parking tpcap parkbench
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument(
        "format",
        choices=READERS,
        help="tpcap: a case of the competition TPCAP, in CSV; parkbench: a scene of ParkBench, in JSON",
    )
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE_OR_FOLDER", help="files or folders to import")
    parser.add_argument(
        "--out", type=Path, default=Path(), metavar="DIR", help="output folder (default: current folder)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Write a scenario for each file. Returns 0."""
    chosen = READERS[arguments.format]
    for file in [file for place in arguments.files for file in _files(place, chosen.suffix)]:
        content = chosen.read(file)
        path: Path = arguments.out / f"{content['name']}.yaml"
        text = yaml.safe_dump(content, sort_keys=False, default_flow_style=None, width=120)
        write_whole(path, text)
        print(path)
    return 0


def _files(place: Path, suffix: str) -> list[Path]:
    """Return a file, or the files of a folder that end with ``suffix``."""
    if place.is_dir():
        found = sorted(item for item in place.iterdir() if item.suffix == suffix)
        if not found:
            raise BadInput(f"no file *{suffix} in this folder", file=place)
        return found
    if not place.is_file():
        raise BadInput("no such file", file=place)
    return [place]
