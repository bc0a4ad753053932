"""``apa check``: does a run meet requirements written as data."""

import argparse
import json
from pathlib import Path

from orchestrator.evaluation.verdict.judge import judge
from orchestrator.evaluation.verdict.logged_scenario import read_logged_scenario
from orchestrator.evaluation.verdict.numbers import facts_of
from orchestrator.inputs.scenario.files import find_file
from orchestrator.inputs.scenario.requirements import read_requirements
from orchestrator.inputs.text.console import console
from orchestrator.presentation.log.read_log import log_file, read_log
from orchestrator.session.terminal import checks_table
from orchestrator.testing.suite.junit import Suite, cases_of, write_junit

EXAMPLES = """examples:
  apa check runs/guo2015-case4/run.mcap gbt41630
  apa check run.mcap requirements.yaml project --junit checks.xml

REQUIREMENTS.yaml is a list; each entry has an id, a signal of the run or a metric of the summary, one of
max, min, max_abs and equals, a source, and optionally a window:
  - {id: crawl at Q1, signal: vehicle.speed, max_abs: 2 km/h, window: {phase: TO_Q1}, source: REQ-12}
  - {id: parked in time, signal: controller.phase, equals: PARKED, window: {at: end}, source: REQ-13}
  - {id: slow at first, signal: vehicle.speed, min: -1 m/s, window: {from: 0, to: 2 s}, source: REQ-14}

The requirement that the vehicle has no contact is always added; it is not required if the scenario has
contact_allowed: true.

exit codes: 0 all required requirements met, 1 one failed, 2 bad input
"""
MET, MISSED = 0, 1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    parser.add_argument("log", type=log_file, metavar="RUN.mcap", help="log of a run, or its folder")
    parser.add_argument("requirements", nargs="+", metavar="REQUIREMENTS", help="YAML files or names of shipped sets")
    parser.add_argument("--junit", type=Path, metavar="FILE", help="write the verdicts as JUnit XML")
    parser.add_argument("--json", action="store_true", help="print the checks as JSON")


def run(arguments: argparse.Namespace) -> int:
    """Judge and print. Returns 0 if every required requirement is met, 1 if not."""
    recording = read_log(arguments.log)
    scenario = read_logged_scenario(recording, str(arguments.log))
    facts = facts_of(recording, scenario)
    checks = []
    for name in arguments.requirements:
        file = find_file(name, "requirements", "set of requirements", Path.cwd())
        checks += judge(read_requirements(file), recording, facts, str(file))
    checks += judge([scenario.contact_rule], recording, facts, str(arguments.log))
    if arguments.junit:
        write_junit(arguments.junit, [Suite(str(arguments.log), cases_of(checks), facts.numbers["duration"])])
    missed = [check for check in checks if check.required and not check.passed]
    unknown = sum(not check.evaluated for check in checks)
    if arguments.json:
        data = [json.loads(check.model_dump_json()) for check in checks]
        print(json.dumps({"passed": not missed, "checks": data}, indent=2))
    else:
        out = console()
        out.print(checks_table(checks, out))
        met = sum(check.passed for check in checks)
        more = (f", {len(missed)} required failed" if missed else "") + (
            f", {unknown} not evaluated" if unknown else ""
        )
        out.print(f"{met} of {len(checks)} met{more}")
    return MISSED if missed else MET
