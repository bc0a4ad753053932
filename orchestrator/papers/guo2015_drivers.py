"""The paper's first conclusion: a driver who obeys the prompts stays on the path. A hundred of them, at each rate."""

import itertools
from typing import NamedTuple

import numpy as np

from controller_fmu.interface import ThresholdParams
from orchestrator.cosim.fmu_files import can_compile
from orchestrator.cosim.slave import Array
from orchestrator.papers.result import CONCLUSION, Row, in_line
from orchestrator.scenario.load_scenario import load_scenario
from orchestrator.scenario.scenario import Scenario
from orchestrator.session.session import run_scenario
from orchestrator.sweep.many import run_all, truths_of
from orchestrator.sweep.rows import FIRST_MEASURE, measures_for, row_of
from orchestrator.sweep.verdict import judge_rows
from orchestrator.verdict.measures import Measure

SPEEDS = tuple(np.linspace(0.3, 1.5, 10).tolist())
"""What the driver means to drive [m/s]; the paper's cases lie between."""
REACTIONS = tuple(np.linspace(0.0, 0.5, 10).tolist())
"""From a prompt to its obedience [s]."""
LATERAL, HEADING = (Measure("largest", f"controller.{name}_error") for name in ("lateral", "heading"))
"""How far off the path the controller sees the car at most."""


class Obeyed(NamedTuple):
    """How many drivers there were, and how many of them did what."""

    drivers: int
    stayed: int
    """On the path: the pose never so far off that point tracking would start."""
    untouched: int
    parked: int
    """Wherever along the slot, as the paper has it."""
    near: int
    """Parked by our limits, within 50 cm of Q3."""


def obeying_rows(run: str) -> list[Row]:
    """Return what becomes of the drivers of ``run`` (case 3) who obey, over all speeds and reactions."""
    obeyed = obey(run, SPEEDS, REACTIONS)
    named = {"stay on the path": obeyed.stayed, "touch nothing": obeyed.untouched, "park": obeyed.parked}
    rows = [
        Row(
            run, f"of {obeyed.drivers} drivers who obey, {what}", "1", float(obeyed.drivers), float(number), 0.0
        )._replace(basis=CONCLUSION)
        for what, number in named.items()
    ]
    near = f"of {obeyed.drivers} drivers who obey, park by our limits, along the slot too"
    return [*rows, Row(run, near, "1", None, float(obeyed.near))]


def obey(run: str, speeds: tuple[float, ...], reactions: tuple[float, ...]) -> Obeyed:
    """Return what becomes of drivers of all these speeds [m/s] and reactions [s], as compiled code where possible."""
    scenarios = [_driven(run, speed, reaction) for speed, reaction in itertools.product(speeds, reactions)]
    measures = list(dict.fromkeys([*measures_for(scenarios[0]), LATERAL, HEADING]))
    rows = run_all(scenarios, measures) if can_compile() else _rows(scenarios, measures)
    truth = truths_of(scenarios)
    ours, papers = (judge_rows(each, truth, measures, rows) for each in (scenarios[0], in_line(scenarios[0])))
    lateral, heading = (np.abs(rows[:, FIRST_MEASURE + measures.index(item)]) for item in (LATERAL, HEADING))
    limit = ThresholdParams()
    stayed = (lateral <= limit.leave_lateral) & (heading <= limit.leave_heading)
    untouched = ours.numbers["min_clearance"] > 0.0
    return Obeyed(
        len(rows), *(int(np.sum(found)) for found in (stayed, untouched, papers.succeeded(), ours.succeeded()))
    )


def _driven(run: str, speed: float, reaction: float) -> Scenario:
    sets = (f"vehicle.driver.profile[1].speed={speed}", f"vehicle.driver.reaction_delay={reaction}")
    return load_scenario(run, (*sets, "controller.prompting.reaction=0.3"))


def _rows(scenarios: list[Scenario], measures: list[Measure]) -> Array:
    return np.array([row_of(run_scenario(item).recording, item, measures) for item in scenarios])
