"""``apa new``: a controller or a vehicle of your own as a package that runs at once, and its pipeline."""

import argparse
import shutil
import sys
from pathlib import Path
from string import Template

from fmus.files import write_whole
from orchestrator.text.errors import BadInput

EXAMPLES = """examples:
  apa new controller my_controller          a folder my_controller: law, scenario, tests, README
  apa run my_controller/scenario.yaml       compiles it and drives it
  apa run guo2015-case3 --controller my_controller:MODEL
  apa new vehicle my_car
  apa new ci my_controller                  pipelines of GitHub and GitLab that test and ship it
"""
KINDS = ("controller", "vehicle", "ci")
PIPELINES = {"github.yml": ".github/workflows/{name}.yml", "gitlab.yml": ".gitlab-ci.yml"}
"""Template -> where the server looks for it."""
TEMPLATES = Path(__file__).parent / "templates"
SUFFIX = ".txt"
RESERVED = ("apa_cosim", "fmus", "modelkit", "orchestrator", "pythonfmu", "vehicle_fmu", "controller_fmu")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("kind", choices=KINDS, metavar="KIND", help="controller, vehicle or ci")
    parser.add_argument("name", metavar="NAME", help="of the package and of its folder: letters, digits and _")
    parser.add_argument(
        "--out", type=Path, default=Path(), metavar="DIR", help="output folder (default: current folder)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the package and say what to do with it. Returns 0."""
    name: str = arguments.name
    if not (name.isidentifier() and name.isascii()) or name in RESERVED or name in sys.stdlib_module_names:
        raise BadInput(
            "is no name for a package: write letters, digits and _, and nothing that Python or apa has", key=name
        )
    return _pipelines(arguments.out, name) if arguments.kind == "ci" else _package(arguments.kind, arguments.out, name)


def _package(kind: str, out: Path, name: str) -> int:
    """Write a package: law, scenario, tests."""
    folder = out / name
    if folder.exists():
        raise BadInput("is there already", file=folder)
    try:
        for template in sorted((TEMPLATES / kind).glob(f"*{SUFFIX}")):
            _write(template, folder / template.name.removesuffix(SUFFIX), name)
    except OSError:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    print(f"{folder}: law, scenario, tests, README\nnext: apa run {folder}/scenario.yaml")
    return 0


def _pipelines(out: Path, name: str) -> int:
    """Write what a server runs at every push: tests the package, ships it."""
    files = {template: out / place.format(name=name) for template, place in PIPELINES.items()}
    for file in files.values():
        if file.exists():
            raise BadInput("is there already", file=file)
    for template, file in files.items():
        _write(TEMPLATES / "ci" / f"{template}{SUFFIX}", file, name)
    print(f"{', '.join(map(str, files.values()))}\nnext: write into them where apa-cosim is installed from")
    return 0


def _write(template: Path, file: Path, name: str) -> None:
    words = {"name": name, "title": "".join(part[:1].upper() + part[1:] for part in name.split("_"))}
    write_whole(file, Template(template.read_text(encoding="utf-8")).substitute(words))
