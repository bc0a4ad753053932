"""``apa export container``: the system of a scenario as one FMU."""

import argparse
from pathlib import Path

from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.text.console import working
from orchestrator.inputs.text.errors import BadInput
from orchestrator.presentation.export.ssp import add_system_arguments
from orchestrator.simulation.cosim.fmu_files import select_platforms

EXAMPLES = """examples:
  apa export container guo2015-case4
  apa export container apa-parallel --platform win64,linux64 --fmi 3 --out Parking.fmu
  apa export container guo2015-case4 --parameter "vehicle.driver.*" --input "vehicle.prompt" --output "*.pose.*"
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the format takes."""
    add_system_arguments(parser, ".fmu")
    parser.add_argument("--fmi", type=int, choices=(2, 3), default=2, help="FMI version (default: 2)")
    parser.add_argument("--cc", metavar="CC", help="C compiler (default: the variable CC, else ziglang)")
    for name, what in (("parameter", "parameters of the FMU"), ("output", "outputs of the FMU")):
        parser.add_argument(f"--{name}", action="append", metavar="PATTERN", help=f"{what} (default: all)")
    text = "further inputs of the FMU, beside those that neither vehicle nor controller provides"
    parser.add_argument("--input", action="append", default=[], metavar="PATTERN", help=text)


def run(arguments: argparse.Namespace) -> int:
    """Write the file. Returns 0."""
    from fmus.files import folder_for_a_while, write_whole
    from fmus.native.compilers import find_compiler
    from fmus.native.fmu import build
    from fmus.native.platforms import host
    from orchestrator.presentation.export.system_of import one_model

    scenario = load_scenario(arguments.scenario, arguments.set)
    platforms = select_platforms(arguments.platform)
    model = one_model(scenario, arguments.parameter, arguments.input, arguments.output)
    out: Path = arguments.out or Path(f"{scenario.name}.fmu")
    try:
        with working(f"building {out.name}"), folder_for_a_while("container") as folder:
            made = build(model, folder, platforms or [host()], find_compiler(arguments.cc), arguments.fmi)
            write_whole(out, made.read_bytes())
    except RuntimeError as error:
        raise BadInput(str(error)) from error
    print(out)
    return 0
