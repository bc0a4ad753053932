"""``apa live``: a page that runs the models, driven by hand and changed by sliders, one HTML file for any browser."""

import argparse
from pathlib import Path

from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.console import say
from orchestrator.inputs.text.errors import BAD_INPUT, PARKED, BadInput
from orchestrator.studies.live.map_code import map_code
from orchestrator.studies.live.page import NAME, write_live
from orchestrator.studies.live.situation import page_scenarios, why_not
from orchestrator.testing.suite.suite import select_scenarios

EXAMPLES = """examples:
  apa live                                                writes live.html: all shipped scenarios
  apa live guo2015-case4 --out /tmp/drive.html            one scenario
  apa live guo2015-case4 --set controller.guo2015.k1=2
  apa live "valet-*"                                      several scenarios of the same controller FMU

Open the file in a browser; it needs no network. `apa run` writes one beside the replay page.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument(
        "scenario", nargs="*", metavar="SCENARIO", help="names, files, patterns (default: all of the common controller)"
    )
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="change the scenario")
    parser.add_argument("--out", type=Path, default=Path(NAME), metavar="FILE", help=f"the page (default: {NAME})")


def run(arguments: argparse.Namespace) -> int:
    """Write the page. Returns 0, or 2 where nothing can be compiled."""
    if arguments.set and not arguments.scenario:
        raise BadInput("needs a scenario to change: apa live SCENARIO --set ...", key="--set")
    names = select_scenarios(arguments.scenario)
    scenarios = [scenario for name in names if (scenario := _fitting(name, arguments))] if names else page_scenarios()
    if not scenarios:
        raise BadInput("nothing of this can be driven on a page", key=" ".join(arguments.scenario))
    try:
        write_live(arguments.out, scenarios, map_code(scenarios))
    except RuntimeError as error:
        say(f"apa: {error}")
        return BAD_INPUT
    print(arguments.out)
    return PARKED


def _fitting(name: str, arguments: argparse.Namespace) -> Scenario | None:
    """Return a scenario; None, which is said, for one that only a pattern means and that no page can run."""
    scenario = load_scenario(name, arguments.set)
    why = why_not(scenario)
    if not why or name in arguments.scenario:
        return scenario
    say(f"apa: {name} is left out: {why}")
    return None
