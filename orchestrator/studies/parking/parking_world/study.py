"""The parking system beside ordinary roads and in car parks, everything disturbed."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orchestrator.evaluation.verdict.confidence import percent_interval
from orchestrator.inputs.scenario.requirements import library_requirements
from orchestrator.inputs.scenario.scenario import Scenario
from orchestrator.inputs.text.console import console
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.parking.parking_world.bays import in_bays
from orchestrator.studies.parking.parking_world.factors import FACTORS
from orchestrator.studies.parking.parking_world.outcome import (
    DRIVER,
    ENDLESS,
    ENDS,
    FALSE,
    FOUND,
    MEASURES,
    MOVING,
    PARKED,
    STANDING,
)
from orchestrator.studies.parking.parking_world.scene import parameters
from orchestrator.studies.parking.parkings import GBT
from orchestrator.studies.parking.study import GBT_SETS
from orchestrator.studies.parking.world import study as world
from orchestrator.studies.parking.world.feasibility import DETECTED_HEIGHT
from orchestrator.studies.parking.world.scene import WITH_KERB
from orchestrator.studies.sweep.fields import Field, find_field
from orchestrator.studies.sweep.study.design import Design
from orchestrator.studies.sweep.study.space import Seeds, Space
from orchestrator.studies.sweep.study.study import Study
from orchestrator.studies.sweep.table import Table

MOST_ROWS = 20
KERB_NEAREST, KERB_FARTHEST = 0.05, 0.35
"""GB/T 41630, between tyres and kerb [m]."""


def study(runs: int = 2000, seed: int = 1, mild: bool = False, **fixed: float) -> Study:
    """Return the study: ``runs`` rows drawn from ``seed``.

    ``mild``: half the ranges; ``fixed``: factors that have one value in all runs.
    """
    space = Space([factor.mild() for factor in FACTORS] if mild else FACTORS, _stack)
    shares = space.with_fixed(np.random.default_rng([seed, 2]).random((runs, len(FACTORS))), fixed)
    seeds = np.random.default_rng([seed, 3]).integers(1, 2**31 - 1, size=runs)
    shared = scenario()
    content = {
        "name": "parking-world",
        "title": "Parking beside ordinary roads and in car parks",
        "description": "Parked: within GB/T 41630 of a slot by ISO 16787, no contact.",
        "map": {"x": "extra", "y": "cars_a", "split": "kind"},
        "seed": seed,
        "mild": mild,
        **({"fixed": fixed} if fixed else {}),
    }
    seeded = [("vehicle", "ultrasonic.seed", find_field("vehicle.ultrasonic.seed", shared).place)]
    within = {GBT[kind]: world.limits_beside_neighbours(name) for kind, name in GBT_SETS.items()}
    design = Design(_fields(shared), space.values(shares, seeds), seeds, space.values_by_name(shares))
    return Study(shared, design, content, seeded, MEASURES, within, FOUND, space, ends="end")


def scenario() -> Scenario:
    """Return what all runs share."""
    base = world.scenario()
    update = {"name": "parking-world", "requirements": [*library_requirements("no-contact")]}
    return base.model_copy(update=update)


def _fields(shared: Scenario) -> list[Field]:
    one = Space(FACTORS, _stack)
    return [find_field(name, shared) for name in parameters(one.values_by_name(one.nominal()[None]), np.array([1]))]


def _stack(values: Mapping[str, Array], seeds: Seeds) -> Array:
    return np.column_stack(list(parameters(values, seeds).values()))


def report(table: Table, folder: Path) -> int:
    """Print how the runs ended. Returns 1 if the system touched something, claims falsely, or has no end."""
    ends, to = table.column("end"), console()
    to.print(world.ends_table(ends, groups_of(table), ENDS))
    for line in shares_of(table):
        to.print(line, highlight=False)
    worst = np.flatnonzero(np.isin(ends, (MOVING, STANDING, FALSE, ENDLESS)))
    to.print(f"rows: {', '.join(map(str, worst[:MOST_ROWS].tolist())) or 'none'}", highlight=False)
    return 1 if len(worst) else 0


def groups_of(table: Table) -> dict[str, NDArray[np.bool_]]:
    """Return the groups of ``apa-world``, and those of its last one that have further cars in the row."""
    found = world.groups(table)
    rows = (table.column("cars_a") + table.column("cars_b")) > 0
    return {**found, f"{world.QUIET}, rows": found[world.QUIET] & rows}


def shares_of(table: Table) -> list[str]:
    """Return lines of shares, each reduced denominator with the full figure beside it."""
    ends, valid, groups = table.column("end"), table.column("valid") == 1.0, groups_of(table)
    unavoidable = table.column("unavoidable") == 1.0
    parked, full = ends == PARKED, int((ends == PARKED).sum())
    lines = []
    for name, chosen in {**groups, "without unavoidable contact": ~unavoidable}.items():
        of = valid & chosen
        count, total = int(parked[of].sum()), int(of.sum())
        if total:
            lines.append(
                f"parked of valid, {name}: {count} of {total}, {100.0 * count / total:.2f} % "
                f"(95 %: {percent_interval(count, total)}); of all runs {full} of {len(ends)}"
            )
    touched = {end: ends == end for end in (MOVING, STANDING, DRIVER)}
    counts = (f"{end} {int(rows.sum())} ({int((rows & unavoidable).sum())})" for end, rows in touched.items())
    lines.append(f"contacts of {len(ends)} runs (also if the car had stood for 1 s): " + ", ".join(counts))
    bays = in_bays({name: table.column(name) for name in ("kind", "bays")})
    lines.append(f"in one of the empty bays: {int((parked & bays).sum())} of {int((bays & valid).sum())} valid")
    lines.append(kerb_share(table, parked))
    return lines


def kerb_share(table: Table, parked: Array) -> str:
    """Return how many of those parked beside a kerb that sensors detect satisfy GB/T 41630 against it, too."""
    kerb = (table.column("kind") == 0) & (table.column("behind") == WITH_KERB)
    beside = parked & kerb & (table.column("kerb_height") >= DETECTED_HEIGHT)
    nearest, farthest = table.column("final.kerb_nearest"), table.column("final.kerb_farthest")
    near = beside & (nearest >= KERB_NEAREST) & (farthest <= KERB_FARTHEST)
    return f"parked beside a detectable kerb, 5 to 35 cm from it: {int(near.sum())} of {int(beside.sum())}"
