"""``apa export``: a run, or the system, in the formats of other tools: each module of ``orchestrator/export``."""

import argparse
import importlib
import pkgutil
from types import ModuleType
from typing import Any

from orchestrator import export

EXAMPLES = """examples:
  apa export csv runs/guo2015-case4/run.mcap
  apa export mf4 runs/guo2015-case4/run.mcap --out case4.mf4
  apa export rerun runs/guo2015-case4/run.mcap
  apa export ssp guo2015-case4
"""


def add_parser(subparsers: Any) -> argparse.ArgumentParser:
    """Add the command with one sub-command for each format."""
    parser: argparse.ArgumentParser = subparsers.add_parser("export", help="write other formats", epilog=EXAMPLES)
    formats = parser.add_subparsers(title="formats", metavar="FORMAT", required=True)
    for module in export_modules():
        subparser = module.add_parser(formats)
        subparser.formatter_class = argparse.RawDescriptionHelpFormatter
        subparser.set_defaults(export=module.run)
    return parser


def run(arguments: argparse.Namespace) -> int:
    """Run the exporter that was named and return its exit code."""
    return int(arguments.export(arguments))


def export_modules() -> list[ModuleType]:
    """Return the modules of all formats: each has ``add_parser(subparsers)`` and ``run(arguments) -> exit code``."""
    names = sorted(item.name for item in pkgutil.iter_modules(export.__path__))
    found = [importlib.import_module(f"{export.__name__}.{name}") for name in names]
    return [module for module in found if hasattr(module, "add_parser")]
