"""The parking system with slots, neighbours, sensors, actuators and road disturbed at once."""

from collections import Counter
from collections.abc import Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.table import Table as Printed

from orchestrator.evaluation.verdict.confidence import percent_interval
from orchestrator.inputs.scenario.fault import Fault
from orchestrator.inputs.scenario.requirements import Requirement, library_requirements
from orchestrator.inputs.scenario.scenario import Scenario, Slot, Target
from orchestrator.inputs.text.console import console, result_table
from orchestrator.inputs.text.errors import BadInput
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.parking.cases import KINDS, gbt_limits
from orchestrator.studies.parking.parkings import GBT
from orchestrator.studies.parking.study import GBT_SETS
from orchestrator.studies.parking.system_signals import APA_SYSTEM
from orchestrator.studies.parking.world.ends import (
    CONTACT,
    ENDLESS,
    ENDS,
    FALSE,
    FOUND,
    GOALS,
    MEASURES,
    PARKED,
    WALKED_INTO,
)
from orchestrator.studies.parking.world.factors import FACTORS, NO_SENSOR, NOBODY
from orchestrator.studies.parking.world.scene import MAX_ROW_CARS, NEVER_TIME, SENSOR_COUNT, F, parameters
from orchestrator.studies.sweep.fields import Field, find_field
from orchestrator.studies.sweep.study.design import Design
from orchestrator.studies.sweep.study.space import Factor, Seeds, Space
from orchestrator.studies.sweep.study.study import Study
from orchestrator.studies.sweep.table import Table

STOP_TIME = 150.0
KERB = "kerb"
"""Limits that GB/T states against a kerb: the assist stands flush with its neighbours, wherever that is."""


def study(runs: int = 2000, seed: int = 1, mild: bool = False, row_cars: int = 0) -> Study:
    """Return the world; ``mild``: half the ranges; ``row_cars``: so many cars beyond each neighbour."""
    if row_cars > MAX_ROW_CARS:
        raise BadInput(f"{row_cars} is more than {MAX_ROW_CARS}: the scene has no more boxes", key="row_cars")
    world = space([factor.mild() for factor in FACTORS] if mild else list(FACTORS), row_cars)
    shares = np.random.default_rng([seed, 0]).random((runs, len(world.factors)))
    seeds = np.random.default_rng([seed, 1]).integers(1, 2**31 - 1, size=runs)
    content: dict[str, Any] = {
        "name": "apa-world-mild" if mild else "apa-world",
        "title": "The parking system with all disturbances at once",
        "description": "Parked: within GB/T 41630 (heading, lateral position, outline, manoeuvres), no contact.",
        "map": {"x": "extra", "y": "heading", "split": "kind"},
        "seed": seed,
        "mild": mild,
        **({"row_cars": row_cars} if row_cars else {}),
    }
    shared = scenario()
    design = Design(fields(row_cars), world.values(shares, seeds), seeds, world.values_by_name(shares))
    within = {GBT[kind]: limits_beside_neighbours(name) for kind, name in GBT_SETS.items()}
    seeded = [("vehicle", "ultrasonic.seed", find_field("vehicle.ultrasonic.seed", shared).place)]
    return Study(shared, design, content, seeded, MEASURES, within, FOUND, world, GOALS, "end")


def scenario(system: int = APA_SYSTEM) -> Scenario:
    """Return what all runs share; the system knows neither slot nor target."""
    return Scenario(
        name="apa-world",
        stop_time=STOP_TIME,
        vehicle={"odometry.ideal": False, "driver.apa_switch_time": 0.5},
        controller={"system": system},
        faults=[
            Fault(signal=f"vehicle.ultrasonic[{number}]", kind="override", value=0.0, start=NEVER_TIME)
            for number in range(1, SENSOR_COUNT + 1)
        ],
        target=Target(x=0.0, y=0.0),
        slot=Slot(x=0.0, y=0.0, length=1.0, width=1.0),
        requirements=[*limits_beside_neighbours("gbt41630"), *library_requirements("no-contact")],
    )


def fields(row_cars: int = 0) -> list[Field]:
    """Return the columns of the design."""
    shared = scenario()
    one = Space(FACTORS, _stack)
    names = parameters(one.values_by_name(one.nominal()[None]), np.array([1]), row_cars)
    return [find_field(name, shared) for name in names]


def space(factors: list[Factor], row_cars: int = 0) -> Space:
    """Return factors and what they mean."""
    return Space(factors, partial(_stack, row_cars=row_cars))


def _stack(values: F, seeds: Seeds, row_cars: int = 0) -> Array:
    return np.column_stack(list(parameters(values, seeds, row_cars).values()))


def report(table: Table, folder: Path) -> int:
    """Print how the runs ended. Returns 1 if one touched something, claims falsely, or has no end."""
    ends, to = table.column("end"), console()
    to.print(ends_table(ends, groups(table)))
    for line in _success_lines(table):
        to.print(line, highlight=False)
    for title, column, chosen in (("reasons", "reason", "gave up"), ("touched", "touched", CONTACT)):
        counted = Counter(table.column(column)[ends == chosen].tolist()).most_common()
        to.print(f"{title}: " + (", ".join(f"{word} {count}" for word, count in counted) or "none"), highlight=False)
    others = int(table.column("driven_into").sum())
    to.print(f"of the contacts, another drove into the standing vehicle: {others}", highlight=False)
    worst = np.flatnonzero(np.isin(ends, (CONTACT, FALSE, ENDLESS)))
    to.print(f"rows: {', '.join(map(str, worst[:MOST_ROWS].tolist())) or 'none'}", highlight=False)
    return 1 if len(worst) else 0


def success_counts(table: Table) -> dict[str, tuple[int, int]]:
    """Return how many are parked, of how many.

    Of valid runs; of those of them that nobody walked into, which ends a run; of those whose task is possible too;
    of these with static obstacles and healthy sensors.
    """
    ends, valid, asked = table.column("end"), table.column("valid") == 1.0, table.column("asked") == 1.0
    quiet = groups(table)[QUIET]
    chosen = {
        "valid": valid,
        "valid, not walked into": valid & (ends != WALKED_INTO),
        "valid and feasible": valid & asked,
        f"these, {QUIET}": valid & asked & quiet,
    }
    return {name: (int((ends[of] == PARKED).sum()), int(of.sum())) for name, of in chosen.items()}


def _success_lines(table: Table) -> list[str]:
    lines = []
    for name, (count, of) in success_counts(table).items():
        share = 100.0 * count / max(of, 1)
        lines.append(f"parked of {name}: {count} of {of}, {share:.2f} % (95 %: {percent_interval(count, of)})")
    return lines


MOST_ROWS = 20
QUIET = "static, healthy"


def groups(table: Table) -> dict[str, NDArray[np.bool_]]:
    """Return the groups of runs: a name, and for each run whether it is one of them."""
    kinds, events = table.column("kind"), {name: table.column(name) for name in ("person", "mover", "lost")}
    quiet = (events["person"] < NOBODY) & (events["mover"] < NOBODY) & (events["lost"] < NO_SENSOR)
    sides = {KINDS[number + 1]: kinds == number for number in (0, 1)}
    return {"all": np.full(len(kinds), True), **sides, QUIET: quiet}


def ends_table(ends: Array, groups: Mapping[str, NDArray[np.bool_]], names: Iterable[str] = ENDS) -> Printed:
    """Return how many runs of each group came to each end."""
    table = result_table(console(), ("end", *groups), ("end",))
    table.add_row("runs", *(str(int(chosen.sum())) for chosen in groups.values()))
    for end in names:
        counts = [(int((ends[chosen] == end).sum()), max(int(chosen.sum()), 1)) for chosen in groups.values()]
        table.add_row(end, *(f"{count} ({100.0 * count / of:.2f} %)" for count, of in counts))
    return table


def limits_beside_neighbours(name: str) -> list[Requirement]:
    """Return a set of GB/T 41630's limits, but for those against a kerb."""
    return [item for item in gbt_limits(name) if item.where != KERB]
