"""``apa run``: one scenario, from YAML to log, figure, summary and exit code."""

import argparse
import sys
from contextlib import nullcontext

from orchestrator.presentation.drawing.picture_process import PictureBeside
from orchestrator.session.options import add_fmus_argument, add_foreign_arguments, add_output_arguments

DEFAULT_PORT = 8765
"""Default port of Foxglove's streams."""
EXAMPLES = """examples:
  apa run guo2015-case4
  apa run guo2015-case4 --set vehicle.body=double_track --set "vehicle.driver.reaction_delay=300 ms" --out runs/late
  apa run guo2015-case4 --controller their.fmu --set controller.their_gain=2
  apa run guo2015-case4 --realtime --live
  apa run guo2015-case4 --set stop_time=30 --fmus none --out /tmp/trial --json

writes DIR/run.mcap, DIR/summary.json, DIR/overview.png, DIR/report.html (replay page) and DIR/live.html (page to drive
the models); an interrupted run writes run.mcap and summary.json only
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("scenario", metavar="NAME|FILE", help="a shipped scenario, or a YAML file")
    parser.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="vehicle.KEY, controller.KEY or a scenario key"
    )
    add_fmus_argument(parser)
    add_foreign_arguments(parser)
    parser.add_argument("--realtime", action="store_true", help="run in real time; report lateness")
    parser.add_argument(
        "--live",
        nargs="?",
        type=int,
        const=DEFAULT_PORT,
        metavar="PORT",
        help=f"stream the run live at this WebSocket ({DEFAULT_PORT}), to Foxglove or Lichtblick; includes --realtime",
    )
    add_output_arguments(parser, "runs/NAME, the next free runs/NAME-2, ... if there is a run")


def run(arguments: argparse.Namespace) -> int:
    """Run, write, print. Returns 0 parked or finished, 1 not, 130 interrupted.

    The picture's process is begun before anything else is imported, so that it is ready when the run is over. Where
    matplotlib has been imported, this process draws.
    """
    with nullcontext() if arguments.no_page or "matplotlib" in sys.modules else PictureBeside() as beside:
        from orchestrator.commands.run.once import run_once

        return run_once(arguments, beside)
