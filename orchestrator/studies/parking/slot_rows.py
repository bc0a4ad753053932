"""Known goals in rows of slots at all angles: cars, angles, tail or nose in, road widths, start poses.

Every slot is between two parked cars on each side, a wall behind the row and one across the street, all of them on the
map; the slot is given by its corners. Seeds, body and errors follow from the number of the case and ``lot``.
"""

import itertools
import math
import random
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from rich.table import Table as Printed

from controller_fmu.common.external_slot import SlotKind
from modelkit.car import car_length
from orchestrator.inputs.scenario.car import car_parameters
from orchestrator.inputs.scenario.obstacle_map import map_of
from orchestrator.inputs.scenario.requirements import library_requirements
from orchestrator.inputs.scenario.scenario import Scenario, Slot, Target
from orchestrator.inputs.text.console import console, result_table
from orchestrator.studies.parking.cases import CARS
from orchestrator.studies.parking.imperfect import imperfect
from orchestrator.studies.parking.system_signals import APA_SYSTEM, plan_measures
from orchestrator.studies.sweep.study.cases import LabelledScenario, design_of
from orchestrator.studies.sweep.study.study import Study
from orchestrator.studies.sweep.table import Table

ANGLES = (30, 45, 60, 75, 90)
KINDS: dict[str, int] = {"tail": SlotKind.TAIL_IN, "nose": SlotKind.NOSE_IN}
STREETS = (5.0, 6.0)
WIDER = (0.6, 1.2)
"""Of the slot than of the car [m]."""
WAYS = tuple(itertools.product((1, -1), ("before", "past")))
"""Direction along the street, and whether the car stands before the slot or past it."""
EXTRA_DEPTH = 0.5
START_DISTANCE = 7.0
SEED_STRIDE = 10_000
STOP_TIME = 200.0
PLAN_MARGIN = 0.1


class RowCase(NamedTuple):
    """One run."""

    number: int
    car: str
    angle: int
    """Of the slots against the street [deg]."""
    kind: str
    street: float
    """Its width [m]."""
    wider: float
    direction: int
    where: str
    lot: int


@cache
def cases(lot: int = 0) -> list[RowCase]:
    """Return all cases."""
    everything = itertools.product(CARS, ANGLES, KINDS, STREETS, WIDER, WAYS)
    return [
        RowCase(number, car, angle, kind, street, wider, *approach, lot)
        for number, (car, angle, kind, street, wider, approach) in enumerate(everything)
    ]


def scenario_of(case: RowCase) -> Scenario:
    """Return the scenario of a case: corner A at the origin, the slot to the right of x, the street to the left."""
    car = CARS[case.car]
    length, width = car_length(car), car.width + case.wider
    turn, depth = math.radians(case.angle), length + EXTRA_DEPTH
    into, opening = (math.cos(turn), -math.sin(turn)), width / math.sin(turn)
    middle = (0.5 * opening + 0.5 * depth * into[0], 0.5 * depth * into[1])
    heading = -turn if case.kind == "nose" else math.pi - turn
    ahead = 0.5 * length - car.rear_overhang
    target = Target(x=middle[0] - ahead * math.cos(heading), y=middle[1] - ahead * math.sin(heading), heading=heading)
    scenario = Scenario(
        name="valet-rows",
        stop_time=STOP_TIME,
        vehicle=_vehicle(case, opening, middle, depth),
        controller={
            **car_parameters(car),
            "system": APA_SYSTEM,
            "search.active": False,
            "plan.margin": PLAN_MARGIN,
            "target.x": target.x,
            "target.y": target.y,
            "target.heading": target.heading,
        },
        target=target,
        slot=Slot(x=middle[0], y=middle[1], heading=-turn, length=depth, width=width),
        requirements=[*library_requirements("valet")],
    )
    return scenario.model_copy(update={"controller": scenario.controller | map_of(scenario)})


def _vehicle(case: RowCase, opening: float, middle: tuple[float, float], depth: float) -> dict[str, Any]:
    """Return the vehicle's parameters: where it starts, what stands there, its errors."""
    car, turn = CARS[case.car], math.radians(case.angle)
    draw = random.Random(5000 + case.number + SEED_STRIDE * case.lot)
    length = car_length(car)
    behind = depth * math.sin(turn) + 0.5 * (car.width + case.wider) * math.cos(turn) + 0.8
    boxes = [
        {"x": middle[0] + place * opening, "y": middle[1], "heading": -turn, "length": length, "width": car.width}
        for place in (-2, -1, 1, 2)
    ]
    boxes += [{"x": 0.0, "y": y, "length": 60.0, "width": 1.0} for y in (-behind, case.street + 0.5)]
    scene = {
        f"scene.boxes[{place}].{name}": value for place, box in enumerate(boxes, start=1) for name, value in box.items()
    }
    side = -1.0 if (case.where == "before") == (case.direction > 0) else 1.0
    start = {
        "start.x": 0.5 * opening + side * START_DISTANCE + draw.uniform(-1.0, 1.0),
        "start.y": 0.5 * case.street + draw.uniform(-0.2, 0.2),
        "start.heading": (0.0 if case.direction > 0 else math.pi) + draw.uniform(-0.07, 0.07),
    }
    errors = imperfect(case.number + 1 + SEED_STRIDE * case.lot, draw)
    return {**car_parameters(car), **scene, **start, **errors}


def study(lot: int = 0, lots: int = 1) -> Study:
    """Return all cases, ``lots`` times with other draws of start, noise and errors."""
    chosen = [case for number in range(lot, lot + lots) for case in cases(number)]
    scenario, design = design_of(LabelledScenario(_labels(case), scenario_of(case)) for case in chosen)
    content = {
        "name": "valet-rows",
        "title": "Rows of slots: angles, tail or nose in, roads, starts, cars",
        "description": "Parked: heading and lateral position within GB/T 41630, no contact; the slot is known.",
        "map": {"x": "angle", "y": "street", "split": "kind"},
    }
    measures = {name: measure for name, measure in plan_measures().items() if name in ("plans", "margin")}
    return Study(scenario, design, content, measures=measures)


def _labels(case: RowCase) -> dict[str, str | float]:
    return {
        **{"number": case.number, "car": case.car, "angle": case.angle, "kind": case.kind, "street": case.street},
        **{"wider": case.wider, "direction": case.direction, "where": case.where, "lot": case.lot},
    }


def report(table: Table, folder: Path) -> int:
    """Print how many parked by angle, kind and street. Returns 1 if a run touched something."""
    names = ("angle", "kind", "street", "outcome", "reason", "min_clearance", "duration", "manoeuvres")
    rows = [dict(zip(names, row, strict=True)) for row in zip(*(table.column(name) for name in names), strict=True)]
    console().print(_by_angle(rows))
    for reason in sorted({str(row["reason"]) for row in rows if row["outcome"] != "parked"}):
        count = sum(row["reason"] == reason and row["outcome"] != "parked" for row in rows)
        console().print(f"{count} not parked: {reason}")
    return 1 if any(row["min_clearance"] <= 0.0 for row in rows) else 0


def _by_angle(rows: list[dict[str, Any]]) -> Printed:
    kinds = (f"{kind}, {street:g} m" for kind, street in _columns())
    table = result_table(console(), ("angle", *kinds, "contact", "manoeuvres", "time"))
    for angle in ANGLES:
        group = [row for row in rows if row["angle"] == angle]
        cells = []
        for kind, street in _columns():
            own = [row for row in group if (row["kind"], row["street"]) == (kind, street)]
            cells.append(f"{sum(row['outcome'] == 'parked' for row in own)} of {len(own)}")
        parked = [row for row in group if row["outcome"] == "parked"]
        manoeuvres, times = sorted(row["manoeuvres"] for row in parked), sorted(row["duration"] for row in parked)
        middle = len(parked) // 2
        counts = f"{manoeuvres[middle]:.0f} (most {manoeuvres[-1]:.0f})" if parked else ""
        ends = (counts, f"{times[middle]:.0f} s" if parked else "")
        table.add_row(f"{angle} deg", *cells, str(sum(row["min_clearance"] <= 0.0 for row in group)), *ends)
    return table


def _columns() -> Iterator[tuple[str, float]]:
    yield from itertools.product(KINDS, STREETS)
