"""The paper's first conclusion: a driver who obeys the prompts stays on the path. A hundred of them, at each rate."""

import itertools
from typing import NamedTuple

import numpy as np

from controller_fmu.interface import Phase, ThresholdParams
from orchestrator.cosim.fmu_files import can_compile
from orchestrator.cosim.slave import Array
from orchestrator.papers.result import CONCLUSION, Row
from orchestrator.scenario.load_scenario import load_scenario
from orchestrator.scenario.scenario import Scenario
from orchestrator.session.session import run_scenario
from orchestrator.sweep.many import measure
from orchestrator.sweep.rows import FIRST_MEASURE, PHASE, row_of
from orchestrator.verdict.measures import Measure

SPEEDS = tuple(np.linspace(0.3, 1.5, 10).tolist())
"""What the driver means to drive [m/s]; the paper's cases lie between."""
REACTIONS = tuple(np.linspace(0.0, 0.5, 10).tolist())
"""From a prompt to its obedience [s]."""
KEPT = [
    PHASE,
    Measure("smallest", "vehicle.clearance"),
    Measure("largest", "controller.lateral_error"),
    Measure("largest", "controller.heading_error"),
]


class Obeyed(NamedTuple):
    """How many drivers there were, and how many of them did what."""

    drivers: int
    stayed: int
    """On the path: the pose never so far off that point tracking would start."""
    untouched: int
    parked: int


def obeying_rows(run: str) -> list[Row]:
    """Return what becomes of the drivers of ``run`` (case 3) who obey, over all speeds and reactions."""
    obeyed = obey(run, SPEEDS, REACTIONS)
    named = {"stay on the path": obeyed.stayed, "touch nothing": obeyed.untouched, "park": obeyed.parked}
    return [
        Row(
            run, f"of {obeyed.drivers} drivers who obey, {what}", "1", float(obeyed.drivers), float(number), 0.0
        )._replace(basis=CONCLUSION)
        for what, number in named.items()
    ]


def obey(run: str, speeds: tuple[float, ...], reactions: tuple[float, ...]) -> Obeyed:
    """Return what becomes of drivers of all these speeds [m/s] and reactions [s], as compiled code where possible."""
    scenarios = [_driven(run, speed, reaction) for speed, reaction in itertools.product(speeds, reactions)]
    found = np.abs(measure(scenarios, KEPT) if can_compile() else _measured(scenarios))
    limit = ThresholdParams()
    stayed = (found[:, 2] <= limit.leave_lateral) & (found[:, 3] <= limit.leave_heading)
    return Obeyed(
        len(found), int(np.sum(stayed)), int(np.sum(found[:, 1] > 0.0)), int(np.sum(found[:, 0] == Phase.PARKED))
    )


def _driven(run: str, speed: float, reaction: float) -> Scenario:
    sets = (f"vehicle.driver.profile[1].speed={speed}", f"vehicle.driver.reaction_delay={reaction}")
    return load_scenario(run, (*sets, "controller.prompting.reaction=0.3"))


def _measured(scenarios: list[Scenario]) -> Array:
    rows = [row_of(run_scenario(scenario, None, kind="none").recording, scenario, KEPT) for scenario in scenarios]
    return np.array(rows)[:, FIRST_MEASURE : FIRST_MEASURE + len(KEPT)]
