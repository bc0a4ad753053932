"""``apa fmu``: check an FMU before a run."""

import argparse

ACTIONS = {"check": "report connected and unconnected variables of an FMU, and outputs missing for an evaluation"}
"""Action -> what it does; each is a module of this folder."""
EXAMPLES = """examples:
  apa fmu check their.fmu
  apa fmu check their.fmu --as vehicle
  apa fmu check gps.fmu --as gps --scenario their-case4.yaml
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add one sub-command for each action."""
    actions = parser.add_subparsers(title="actions", metavar="ACTION", required=True)
    for name, text in ACTIONS.items():
        actions.add_parser(name, help=text, description=text, module=f"orchestrator.commands.fmu.{name}")
