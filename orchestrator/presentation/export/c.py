"""``apa export c``: the models as C libraries, without FMI."""

import argparse
from pathlib import Path

from orchestrator.inputs.scenario.models import MODELS
from orchestrator.inputs.text.errors import BadInput

EXAMPLES = """examples:
  apa export c build/c                 build/c/Vehicle and build/c/Controller: .h, .c, main.c, Makefile
  make -C build/c/Vehicle && build/c/Vehicle/example
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the format takes."""
    parser.add_argument("folder", type=Path, metavar="DIR", help="where to; each model gets a folder in it")


def run(arguments: argparse.Namespace) -> int:
    """Write the files and print their paths. Returns 0."""
    from fmus.native.c_library import write_c_library

    for model in MODELS.values():
        try:
            written = write_c_library(model, arguments.folder / model.name)
        except TypeError as error:
            raise BadInput(str(error)) from error
        for path in written:
            print(path)
    return 0
