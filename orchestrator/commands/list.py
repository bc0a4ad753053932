"""``apa list``: the scenarios, cars and studies that are shipped."""

import argparse
import json
from typing import Any

from rich.table import Table

from orchestrator.scenario.load_scenario import car_names, load_scenario, scenario_names
from orchestrator.session.terminal import console
from orchestrator.sweep.study import study_names


def add_parser(subparsers: Any) -> argparse.ArgumentParser:
    """Add the command."""
    parser: argparse.ArgumentParser = subparsers.add_parser("list", help="list scenarios, cars and studies")
    parser.add_argument("--json", action="store_true", help="print JSON")
    return parser


def run(arguments: argparse.Namespace) -> int:
    """Print names, expected outcomes and titles. Returns 0."""
    scenarios = [load_scenario(name) for name in scenario_names()]
    if arguments.json:
        rows = [
            {"name": item.name, "title": item.title, "expect": item.expect, "file": item.file} for item in scenarios
        ]
        print(json.dumps({"scenarios": rows, "cars": car_names(), "studies": study_names()}, indent=2))
        return 0
    out = console()
    table = Table(box=None, pad_edge=False)
    for name in ("scenario", "expect", "title"):
        table.add_column(name, no_wrap=name != "title")
    for item in scenarios:
        table.add_row(item.name, item.expect, item.title)
    out.print(table)
    out.print(f"cars: {', '.join(car_names())}")
    out.print(f"studies (apa sweep NAME): {', '.join(study_names())}")
    return 0
