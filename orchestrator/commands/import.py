"""``apa import``: scenes of others as scenarios."""

import argparse
from pathlib import Path

import yaml

from fmus.files import write_whole
from orchestrator.scenario.tpcap import read_tpcap
from orchestrator.text.errors import BadInput

READERS = {"tpcap": read_tpcap}
"""Format -> its reader, which gives a scenario as plain data."""
EXAMPLES = """examples:
  apa import tpcap Case7.csv
  apa import tpcap cases/*.csv --out tpcap
  apa run tpcap/Case7.yaml
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("format", choices=READERS, help="tpcap: a case of the competition TPCAP, in CSV")
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="files to import")
    parser.add_argument(
        "--out", type=Path, default=Path(), metavar="DIR", help="output folder (default: current folder)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Write a scenario for each file. Returns 0."""
    for file in arguments.files:
        if not file.is_file():
            raise BadInput("no such file", file=file)
        content = READERS[arguments.format](file)
        path: Path = arguments.out / f"{content['name']}.yaml"
        text = yaml.safe_dump(content, sort_keys=False, default_flow_style=None, width=120)
        write_whole(path, text)
        print(path)
    return 0
