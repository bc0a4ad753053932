"""``apa fmu``: what is to be known of an FMU before it is run."""

import argparse

ACTIONS = {"check": "what an FMU would be in a system: connected, unconnected, missing for a verdict"}
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
