"""The paper's first conclusion: a driver who obeys the prompts stays on the path. A hundred of them, at each rate."""

import itertools
from typing import NamedTuple

import numpy as np

from controller_fmu.guo2015.params import GuoThresholds
from orchestrator.evaluation.verdict.measures import Measure
from orchestrator.inputs.scenario.load_scenario import load_scenario
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.studies.papers.result import CONCLUSION, Row, in_line
from orchestrator.studies.sweep.columns import WITHIN
from orchestrator.studies.sweep.in_memory import columns_in_memory
from orchestrator.studies.sweep.study.cases import LabelledScenario, design_of
from orchestrator.studies.sweep.study.study import Study

SPEEDS = tuple(np.linspace(0.3, 1.5, 10).tolist())
"""What the driver means to drive [m/s]; the paper's cases lie between."""
REACTIONS = tuple(np.linspace(0.0, 0.5, 10).tolist())
"""From a prompt to its obedience [s]."""

NEAR_Q3 = 0.45
"""A little less than our limit along the slot [m]: the car rolls on while it stops."""
PARK_LONGITUDINAL = "controller.guo2015.threshold.park_longitudinal"


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
    back = obey(run, SPEEDS, REACTIONS, (f"{PARK_LONGITUDINAL}={NEAR_Q3}",))
    returned = f"{near}, asked back to Q3 from farther than {NEAR_Q3:g} m ahead"
    return [
        *rows,
        Row(run, near, "1", None, float(obeyed.near)),
        Row(run, returned, "1", None, float(back.near), note=f"{PARK_LONGITUDINAL} = {NEAR_Q3:g}"),
    ]


def obey(run: str, speeds: tuple[float, ...], reactions: tuple[float, ...], sets: tuple[str, ...] = ()) -> Obeyed:
    """Return what becomes of drivers of all these speeds [m/s] and reactions [s], with further ``sets``."""
    drivers = [
        LabelledScenario({"speed": speed, "reaction": reaction}, _driver_scenario(run, speed, reaction, sets))
        for speed, reaction in itertools.product(speeds, reactions)
    ]
    scenario, design = design_of(drivers)
    measures = {name: Measure("largest", f"controller.{name}_error") for name in ("lateral", "heading")}
    asked = Study(in_line(scenario), design, {"name": run}, measures=measures, within={"ours": scenario.requirements})
    found = columns_in_memory(asked)
    limit = GuoThresholds()
    stayed = (np.abs(found["lateral"]) <= limit.leave_lateral) & (np.abs(found["heading"]) <= limit.leave_heading)
    parked = found["outcome"] == "parked"
    counted = (stayed, found["min_clearance"] > 0.0, parked, parked & found[WITHIN.format("ours")])
    return Obeyed(len(drivers), *(int(np.sum(item)) for item in counted))


def _driver_scenario(run: str, speed: float, reaction: float, sets: tuple[str, ...]) -> Scenario:
    driver = (f"vehicle.driver.profile[1].speed={speed}", f"vehicle.driver.reaction_delay={reaction}")
    return load_scenario(run, (*driver, *sets, "controller.guo2015.prompting.reaction=0.3"))
