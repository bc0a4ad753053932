"""Drive scenarios and random runs with half of the body step and write which of them end differently.

    python -m benchmarks.half_step --out docs/tables/half-step.md

Alike: the same outcome and number of manoeuvres, final poses within 5 cm and 1 degree. Of each run that ends
differently the table states the first transition of the controller's state machine that differs. ``--runs 100`` takes
fewer random runs. With ``--folder`` their tables are kept, and those that are there are not made again.
"""

import argparse
import math
import sys
from collections import Counter
from collections.abc import Sequence
from itertools import zip_longest
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np

from orchestrator.evaluation.verdict.confidence import wilson
from orchestrator.evaluation.verdict.summary import Event, Summary, summarize
from orchestrator.inputs.scenario.load_scenario import load_scenario, scenario_names
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.session.session import run_scenario
from orchestrator.simulation.cosim.fmu_files import fmu_files
from orchestrator.studies.sweep.job import chunk_scenario
from orchestrator.studies.sweep.study.read_study import bind
from orchestrator.studies.sweep.study.study_file import StudyFile
from orchestrator.studies.sweep.sweep import Options, sweep
from orchestrator.studies.sweep.table import Table
from vehicle_fmu.interface import VehicleParams

MAX_POSITION_CHANGE = 0.05
MAX_HEADING_CHANGE = math.radians(1.0)
RANDOM_RUNS = 1_000
SEED = 46
MOST_ROWS = 12
"""Rows of random runs that are listed for one decision."""
RANDOM_BASES = {
    "guo2015-case4": ("double_track", 0.1),
    "zhang2022-double-track": ("double_track", 0.1),
    "hsic": ("double_track", 0.1),
    "preview": ("single_track", 0.01),
    "adaptive": ("double_track", 0.1),
    "apa-perpendicular-real": ("double_track", 0.1),
}
"""A scenario of each system -> the body with which it is varied, and the largest lateral offset of its starts [m]."""
PARTS = ("outcome", "manoeuvres", "pose")
INTRODUCTION = """# Half the body step

Runs with the body step of the scenario and with half of it. Alike: the same outcome and number of manoeuvres, final
poses within 5 cm and 1 deg. `python -m benchmarks.half_step --out docs/tables/half-step.md` writes this page. Random
starts are moved by up to 20 cm along and 10 cm across the road and turned by up to 1.1 deg (`preview`: 1 cm across).
Rows count from zero; a decision is the first transition of the controller's state machine that differs.
"""


class Ending(NamedTuple):
    """How a run ended, as far as it must not depend on the step."""

    outcome: str
    manoeuvres: float
    pose: tuple[float, float, float]


class RandomRuns(NamedTuple):
    """The same random runs of a scenario, with the whole and with half of the body step."""

    scenario: str
    tables: tuple[Table, Table]
    endings: list[tuple[Ending, Ending]]

    @property
    def different(self) -> list[int]:
        """Return the rows of the runs that end differently."""
        return [row for row, pair in enumerate(self.endings) if difference(*pair)]

    def decision(self, row: int) -> str:
        """Return what the controller decides differently in a run."""
        runs = [drive(chunk_scenario(table.job, table.chunk(row), 0)) for table in self.tables]
        return first_difference(*(run.events for run in runs))


def difference(one: Ending, other: Ending) -> str:
    """Return the first of ``PARTS`` by which two endings differ; empty if they are alike."""
    x, y, heading = (a - b for a, b in zip(one.pose, other.pose, strict=True))
    is_near = math.hypot(x, y) <= MAX_POSITION_CHANGE
    is_parallel = abs(math.remainder(heading, math.tau)) <= MAX_HEADING_CHANGE
    alike = (one.outcome == other.outcome, one.manoeuvres == other.manoeuvres, is_near and is_parallel)
    return next((part for part, is_alike in zip(PARTS, alike, strict=True) if not is_alike), "")


def first_difference(whole: Sequence[Event], half: Sequence[Event]) -> str:
    """Return the first transition that two runs do not share, or else the one whose times differ most."""
    for one, other in zip_longest(whole, half):
        if one is None or other is None or one.to != other.to:
            state = (one or other).from_
            return f"{state} to " + " or ".join("no other" if event is None else event.to for event in (one, other))
    if not whole:
        return "no transition differs"
    shift, event = max(((abs(a.t - b.t), a) for a, b in zip(whole, half, strict=True)), key=lambda item: item[0])
    return f"time of {event.from_} to {event.to}" if shift else "no transition differs"


def drive(scenario: Scenario) -> Summary:
    """Return how a scenario ends with the native FMUs."""
    ran = run_scenario(scenario, fmu_files("native", lambda text: None), kind="native")
    return summarize(ran.recording, scenario, ran.wall_time)


def ending_of(summary: Summary) -> Ending:
    """Return the ending of a run."""
    final = summary.final
    return Ending(summary.outcome, summary.manoeuvres or 0, (final.x, final.y, final.heading))


def has_body_step(name: str) -> bool:
    """Return whether the vehicle of a scenario has a body with mass, and with it a body step."""
    return bool(load_scenario(name, []).parameters_for("vehicle").get("body"))


def body_step(name: str) -> float:
    """Return the body step of a scenario [s]."""
    return float(load_scenario(name, []).parameters_for("vehicle").get("body_step", VehicleParams().body_step))


def with_half_step(name: str) -> Scenario:
    """Return a scenario with half of its body step."""
    return load_scenario(name, [f"vehicle.body_step={0.5 * body_step(name)}"])


def random_runs(name: str, folder: Path, count: int = RANDOM_RUNS) -> RandomRuns:
    """Return random runs of a scenario; the starts depend on the scenario alone."""
    whole, half = (_table(name, part * body_step(name), folder / str(part), count) for part in (1.0, 0.5))
    return RandomRuns(name, (whole, half), list(zip(_endings(whole), _endings(half), strict=True)))


def _table(name: str, step: float, folder: Path, count: int) -> Table:
    """Return the table of random starts with a body step [s]."""
    start = load_scenario(name, []).parameters_for("vehicle")
    body, offset = RANDOM_BASES[name]
    spread = {
        f"vehicle.start.{axis}": {"uniform": [start.get(f"start.{axis}", 0.0) + sign * half for sign in (-1, 1)]}
        for axis, half in (("x", 0.2), ("y", offset), ("heading", 0.2 * offset))
    }
    fixed = {"vehicle.body": body, "vehicle.body_step": step}
    runs = {"monte_carlo": {"n": count, **spread}}
    study = StudyFile.model_validate({"name": "half-step", "scenario": name, "set": fixed, "seed": SEED, "runs": runs})
    table = sweep(bind(study), folder, Options(resume=True)).table
    assert table is not None
    return Table(table)


def _endings(table: Table) -> list[Ending]:
    poses = np.column_stack([table.column(f"final.{axis}") for axis in ("x", "y", "heading")]).tolist()
    outcomes, manoeuvres = (table.column(key) for key in ("outcome", "manoeuvres"))
    return [
        Ending(str(outcome), float(moves), tuple(pose))
        for outcome, moves, pose in zip(outcomes, manoeuvres, poses, strict=True)
    ]


def scenario_lines() -> list[str]:
    """Return the table of the shipped scenarios that end differently."""
    names = scenario_names()
    with_mass = [name for name in names if has_body_step(name)]
    rows = []
    for name in with_mass:
        whole, half = drive(load_scenario(name, [])), drive(with_half_step(name))
        part = difference(ending_of(whole), ending_of(half))
        if part:
            rows.append(f"| `{name}` | {part} | {first_difference(whole.events, half.events)} |")
    return [
        f"{len(names) - len(rows)} of {len(names)} shipped scenarios end alike; {len(with_mass)} have a body step.",
        "",
        "| scenario | differs in | decision that changes |",
        "|---|---|---|",
        *rows,
    ]


def random_lines(count: int, folder: Path) -> list[str]:
    """Return the tables of the random runs: how many end alike, and what changes in the others."""
    shares = [
        "| random runs of | body | runs | alike | 95 % interval | outcome | manoeuvres | pose |",
        "|---|---|---:|---:|---:|---:|---:|---:|",
    ]
    decisions = ["| random runs of | decision that changes | runs | rows |", "|---|---|---:|---|"]
    for name, (body, _) in RANDOM_BASES.items():
        runs = random_runs(name, folder / name, count)
        different = runs.different
        alike = count - len(different)
        low, high = wilson(alike, count)
        parts = Counter(difference(*runs.endings[row]) for row in different)
        numbers = " | ".join(str(parts[part]) for part in PARTS)
        share = f"{100 * alike / count:.1f} % | {100 * low:.1f} to {100 * high:.1f} %"
        shares.append(f"| `{name}` | {body} | {count} | {share} | {numbers} |")
        decisions += _decision_lines(runs)
    return [*shares, "", *decisions]


def _decision_lines(runs: RandomRuns) -> list[str]:
    by_decision: dict[str, list[int]] = {}
    for row in runs.different:
        by_decision.setdefault(runs.decision(row), []).append(row)
    lines = []
    for decision, rows in sorted(by_decision.items(), key=lambda item: -len(item[1])):
        listed = ", ".join(map(str, rows[:MOST_ROWS])) + (", ..." if len(rows) > MOST_ROWS else "")
        lines.append(f"| `{runs.scenario}` | {decision} | {len(rows)} | {listed} |")
    return lines


def main(words: list[str]) -> int:
    """Write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.half_step", description=__doc__)
    parser.add_argument("--runs", type=int, default=RANDOM_RUNS, help="random runs of each scenario")
    parser.add_argument("--out", type=Path, required=True, help="page that is written")
    parser.add_argument("--folder", type=Path, help="keep the tables of the random runs here, and use those it has")
    asked = parser.parse_args(words)
    with TemporaryDirectory(prefix="half-step-") as temporary:
        folder = asked.folder or Path(temporary)
        lines = [*scenario_lines(), "", *random_lines(asked.runs, folder)]
    asked.out.write_text("\n".join([INTRODUCTION, *lines, ""]), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
