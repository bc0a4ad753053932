"""``apa build``: make the FMUs, of the parking pair or of a model of one's own."""

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

from orchestrator.inputs.text.console import working
from orchestrator.inputs.text.errors import BadInput, suggestion
from orchestrator.simulation.cosim.fmu_files import build, build_into, select_platforms
from orchestrator.simulation.cosim.kinds import KINDS

if TYPE_CHECKING:
    from fmus.build import Built

EXAMPLES = """examples:
  apa build                                       both kinds, into the cache of apa run
  apa build --fmus native --out build             build/native/Controller.fmu and Vehicle.fmu
  apa build --fmus native --out build --platform win64,linux64
  apa build --fmi 3 --out build --platform all    build/fmi3/...: FMI 3.0
  apa build --system apa --out build              build/native/Controller_apa.fmu...: one controller
  apa build --fmus native --cc gcc                with the C compiler of this machine
  apa build --model my_model.py:MODEL --out build     your own model: PythonFMU, native FMUs, C library
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("--fmus", choices=KINDS, action="append", help="kind of FMU (default: all that can be built)")
    parser.add_argument("--fmi", type=int, choices=(2, 3), help="FMI version; 3: native only (default: 2)")
    parser.add_argument("--out", type=Path, metavar="DIR", help="output folder (default: the cache that apa run uses)")
    parser.add_argument(
        "--platform", action="append", metavar="NAME,...", help="platforms of native FMUs, or all (default: this one)"
    )
    parser.add_argument(
        "--system",
        action="append",
        metavar="NAME,...",
        help="build one FMU per named controller, with its variables only; or all (apa list controllers)",
    )
    parser.add_argument("--cc", metavar="CC", help="C compiler (default: the variable CC, else ziglang)")
    parser.add_argument("--model", metavar="FILE.py:NAME", help="your own model, in a file or in a package")
    parser.add_argument("--json", action="store_true", help="print the list as JSON")


def run(arguments: argparse.Namespace) -> int:
    """Build and print one line per FMU. Returns 0."""
    made = _own_model(arguments) if arguments.model else _parking_pair(arguments)
    rows = [{**item._asdict(), "path": str(item.path), "size": item.path.stat().st_size} for item in made]
    if arguments.json:
        print(json.dumps(rows, indent=2))
        return 0
    for row in rows:
        print(f"{row['path']}  {row['size'] / 1024:.0f} KiB  {row['guid']}{'' if row['changed'] else '  unchanged'}")
    return 0


def _parking_pair(arguments: argparse.Namespace) -> list["Built"]:
    kinds = _kinds(arguments)
    if arguments.platform and (arguments.out is None or kinds == ["python"]):
        raise BadInput("is for native FMUs in a place of their own: give --fmus native and --out", key="--platform")
    if arguments.system:
        return _systems(arguments, kinds)
    made = []
    for kind in kinds:
        platforms = arguments.platform or () if kind != "python" else ()
        cc = arguments.cc
        made += build(kind, cc) if arguments.out is None else build_into(arguments.out, kind, platforms, cc)
    return made


def _systems(arguments: argparse.Namespace, kinds: list[str]) -> list["Built"]:
    from controller_fmu import APART, SYSTEM_MODELS
    from fmus.cache_paths import DIST

    known = {system.name.lower(): model for system, model in {**SYSTEM_MODELS, **APART}.items()}
    asked = [name.lower() for item in arguments.system for name in item.split(",")]
    for name in asked:
        if name not in ("all", *known):
            raise BadInput(
                f"no system {name!r}: expected all or {', '.join(known)}{suggestion(name, known)}", key="--system"
            )
    models = [model for name, model in known.items() if name in asked or "all" in asked]
    folder, platforms = arguments.out or DIST, arguments.platform or ()
    return [made for kind in kinds for made in build_into(folder, kind, platforms, arguments.cc, models)]


def _own_model(arguments: argparse.Namespace) -> list["Built"]:
    from fmus.build import kinds_here
    from fmus.user_model import BadModel, build_own, own_model

    if arguments.out is None:
        raise BadInput("a model of your own needs a place: give --out", key="--model")
    asked = arguments.fmus or arguments.fmi
    kinds = _kinds(arguments) if asked else [*kinds_here(), "c"]
    platforms = select_platforms(arguments.platform or ())
    try:
        model = own_model(arguments.model)
        with working(f"building {model.name}"):
            return build_own(model, arguments.out, kinds, platforms, arguments.cc)
    except (BadModel, RuntimeError) as error:
        raise BadInput(str(error)) from error


def _kinds(arguments: argparse.Namespace) -> list[str]:
    from fmus.build import kinds_here

    if arguments.fmi == 3:
        if arguments.fmus and "python" in arguments.fmus:
            raise BadInput("PythonFMUs are FMI 2.0; leave out --fmus python", key="--fmi")
        return ["fmi3"]
    return arguments.fmus or [kind for kind in KINDS if kind in kinds_here()]
