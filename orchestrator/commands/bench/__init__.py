"""``apa bench``: public benchmarks of parking, planned and driven."""

import argparse

ACTIONS = {
    "parking": "plan and drive every scene of a benchmark, as one table",
    "optimal": "compare a drive with the time-optimal motion at equal limits",
}
"""Action -> what it does; each is a module of this folder."""
EXAMPLES = """examples:
  apa bench parking
  apa bench parking tpcap parkbench --out results
  apa bench optimal valet-dead-end
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add one sub-command for each action."""
    actions = parser.add_subparsers(title="actions", metavar="ACTION", required=True)
    for name, text in ACTIONS.items():
        actions.add_parser(name, help=text, description=text, module=f"orchestrator.commands.bench.{name}")
