"""``apa export``: a run, or the system, in formats of other tools (``orchestrator/presentation/export``)."""

import argparse

FORMATS = {
    "c": "the models as C libraries, without FMI",
    "container": "the system as one FMU, for any importer",
    "csv": "a table of all signals",
    "mf4": "ASAM MDF 4",
    "rerun": "Rerun recording (.rrd)",
    "ros2": "a bag for ROS 2, Foxglove and PlotJuggler (MCAP)",
    "ssp": "the system as .ssp, for libcosim, OMSimulator, Ecos",
}
"""Format -> what it is. Its module has ``EXAMPLES``, ``add_arguments(parser)`` and ``run(arguments) -> exit code``."""
EXAMPLES = """examples:
  apa export csv runs/guo2015-case4/run.mcap
  apa export mf4 runs/guo2015-case4/run.mcap --out case4.mf4
  apa export rerun runs/guo2015-case4/run.mcap
  apa export ros2 runs/guo2015-case4/run.mcap
  apa export ssp guo2015-case4
  apa export c build/c
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add one sub-command for each format."""
    formats = parser.add_subparsers(title="formats", metavar="FORMAT", required=True)
    for name, text in FORMATS.items():
        formats.add_parser(name, help=text, description=text, module=f"orchestrator.presentation.export.{name}")
