"""``apa build``: make the FMUs."""

import argparse
import json
from pathlib import Path

from orchestrator.cosim.fmu_files import KINDS, build, build_into
from orchestrator.text.errors import BadInput

EXAMPLES = """examples:
  apa build                                       both kinds, for apa's own runs
  apa build --fmus native --out build             build/native/Controller.fmu and Vehicle.fmu
  apa build --fmus native --out build --platform win64,linux64
  apa build --fmi 3 --out build --platform all    build/fmi3/...: FMI 3.0
  apa build --fmus native --cc gcc                with this machine's own C compiler
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("--fmus", choices=KINDS, action="append", help="which kind (default: all that can be built)")
    parser.add_argument("--kind", choices=KINDS, action="append", dest="fmus", help=argparse.SUPPRESS)
    parser.add_argument("--fmi", type=int, choices=(2, 3), default=2, help="version; 3: native only (default: 2)")
    parser.add_argument("--out", type=Path, metavar="DIR", help="where to (default: where apa's own runs look)")
    parser.add_argument(
        "--platform", action="append", metavar="NAME,...", help="native FMUs for these, or all (default: this one)"
    )
    parser.add_argument("--cc", metavar="CC", help="C compiler (default: the variable CC, else ziglang)")
    parser.add_argument("--json", action="store_true", help="print the list as JSON")


def run(arguments: argparse.Namespace) -> int:
    """Build and print one line per FMU. Returns 0."""
    kinds = _kinds(arguments)
    if arguments.platform and (arguments.out is None or kinds == ["python"]):
        raise BadInput("is for native FMUs in a place of their own: give --fmus native and --out", key="--platform")
    rows = []
    for kind in kinds:
        platforms = arguments.platform or () if kind != "python" else ()
        cc = arguments.cc
        made = build(kind, cc) if arguments.out is None else build_into(arguments.out, kind, platforms, cc)
        for item in made:
            size = item.path.stat().st_size
            rows.append({**item._asdict(), "path": str(item.path), "size": size})
            if not arguments.json:
                print(f"{item.path}  {size / 1024:.0f} KiB  {item.guid}{'' if item.changed else '  unchanged'}")
    if arguments.json:
        print(json.dumps(rows, indent=2))
    return 0


def _kinds(arguments: argparse.Namespace) -> list[str]:
    from fmus.build import kinds_here

    if arguments.fmi == 3:
        if arguments.fmus and "python" in arguments.fmus:
            raise BadInput("PythonFMUs are FMI 2.0; leave out --fmus python", key="--fmi")
        return ["fmi3"]
    return arguments.fmus or [kind for kind in KINDS if kind in kinds_here()]
