"""``apa build``: make the FMUs."""

import argparse
import json
from pathlib import Path

from orchestrator.cosim.fmu_files import KINDS, build, build_into
from orchestrator.text.errors import BadInput

EXAMPLES = """examples:
  apa build                                       both kinds, for apa's own runs
  apa build --fmus native --out build             build/native/Controller.fmu and Vehicle.fmu
  apa build --fmus native --out build --platform win64 --platform linux64
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("--fmus", choices=KINDS, action="append", help="which kind (default: all that can be built)")
    parser.add_argument("--kind", choices=KINDS, action="append", dest="fmus", help=argparse.SUPPRESS)
    parser.add_argument("--out", type=Path, metavar="DIR", help="where to (default: where apa's own runs look)")
    parser.add_argument(
        "--platform", action="append", metavar="NAME", help="native FMUs for these, or all (default: this one)"
    )
    parser.add_argument("--json", action="store_true", help="print the list as JSON")


def run(arguments: argparse.Namespace) -> int:
    """Build and print one line per FMU. Returns 0."""
    from fmus.build import BUILDERS

    kinds = arguments.fmus or [kind for kind in KINDS if kind in BUILDERS]
    if arguments.platform and (arguments.out is None or "native" not in kinds):
        raise BadInput("is for native FMUs in a place of their own: give --fmus native and --out", key="--platform")
    rows = []
    for kind in kinds:
        platforms = arguments.platform or () if kind == "native" else ()
        made = build(kind) if arguments.out is None else build_into(arguments.out, kind, platforms)
        for item in made:
            size = item.path.stat().st_size
            rows.append({**item._asdict(), "path": str(item.path), "size": size})
            if not arguments.json:
                print(f"{item.path}  {size / 1024:.0f} KiB  {item.guid}{'' if item.changed else '  unchanged'}")
    if arguments.json:
        print(json.dumps(rows, indent=2))
    return 0
