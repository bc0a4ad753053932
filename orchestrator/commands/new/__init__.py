"""``apa new``: a controller or a vehicle of your own as a package that runs at once."""

import argparse
import sys
from pathlib import Path
from string import Template

from orchestrator.text.errors import BadInput

EXAMPLES = """examples:
  apa new controller my_controller          a folder my_controller: law, scenario, tests, README
  apa run my_controller/scenario.yaml       compiles it and drives it
  apa run guo2015-case3 --controller my_controller:MODEL
  apa new vehicle my_car
"""
KINDS = ("controller", "vehicle")
TEMPLATES = Path(__file__).parent / "templates"
SUFFIX = ".txt"
RESERVED = ("apa_cosim", "fmus", "modelkit", "orchestrator", "pythonfmu", "vehicle_fmu", "controller_fmu")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("kind", choices=KINDS, metavar="KIND", help=" or ".join(KINDS))
    parser.add_argument("name", metavar="NAME", help="of the package and of its folder: letters, digits and _")
    parser.add_argument("--out", type=Path, default=Path(), metavar="DIR", help="where the folder goes (here)")


def run(arguments: argparse.Namespace) -> int:
    """Write the package and say what to do with it. Returns 0."""
    name: str = arguments.name
    if not (name.isidentifier() and name.isascii()) or name in RESERVED or name in sys.stdlib_module_names:
        raise BadInput(
            "is no name for a package: write letters, digits and _, and nothing that Python or apa has", key=name
        )
    folder: Path = arguments.out / name
    if folder.exists():
        raise BadInput("is there already", file=folder)
    words = {"name": name, "title": "".join(part[:1].upper() + part[1:] for part in name.split("_"))}
    folder.mkdir(parents=True)
    for template in sorted((TEMPLATES / arguments.kind).glob(f"*{SUFFIX}")):
        text = Template(template.read_text(encoding="utf-8")).substitute(words)
        (folder / template.name.removesuffix(SUFFIX)).write_text(text, encoding="utf-8")
    print(f"{folder}: law, scenario, tests, README\nnext: apa run {folder}/scenario.yaml")
    return 0
