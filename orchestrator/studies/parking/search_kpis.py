"""Slot detection in figures: detected, missed, false, of the correct type, and how exact.

Gaps that the car fits into and gaps that it does not, both kinds, over the speed of the search and the distance to the
row; side, body, car and heading are drawn from the number of the case and the lot, as noise and odometry errors are.
"""

import itertools
import math
import random
from collections.abc import Callable, Iterator, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from modelkit.car import car_length
from orchestrator.evaluation.verdict.numbers import Metric
from orchestrator.inputs.scenario.slot_sizes import ParkingType, shortest_slot
from orchestrator.inputs.text.console import console, result_table
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.parking.cases import BODIES, CARS, ISO, KINDS, SEED_STRIDE, GridCase, scenario_of
from orchestrator.studies.parking.parkings import (
    FALSE_DETECTION_DISTANCE,
    MEASURES,
    ODOMETRY,
    POSE,
    SHOWN_COLUMNS,
    corner_errors,
    pose_of,
)
from orchestrator.studies.sweep.study.cases import LabelledScenario, design_of
from orchestrator.studies.sweep.study.study import Columns, DerivedParameter, Study
from orchestrator.studies.sweep.table import Table

WIDER: dict[int, tuple[float, ...]] = {ParkingType.PARALLEL: (0.0, 0.8), ParkingType.PERPENDICULAR: (0.0, 0.5)}
"""Gaps that fit, over ISO 16787's shortest [m]."""
TOO_SMALL: dict[int, float] = {ParkingType.PARALLEL: 0.25, ParkingType.PERPENDICULAR: 0.5}
"""A gap that does not fit is so much [m] longer (wider) than the car."""
SPEEDS = (5.0, 10.0, 15.0, 20.0)
"""Of the search [km/h]."""
BESIDE = (0.5, 1.0, 1.5, 2.0)
"""Lateral distance to the row where the car comes nearest to it [m]."""
DRAWS_PER_CASE = 4
MAX_START_HEADING = 3.0
"""Largest heading against the road [deg]."""
HEADING = "shown.heading"
FOUND, MISSED, FALSE, REFUSED = "found", "missed", "false", "refused"
WORDS = {
    FOUND: "a gap that fits is shown, both corners within 50 cm",
    MISSED: "a gap that fits is not shown",
    FALSE: "something is shown that is not there, or does not fit",
    REFUSED: "a gap that does not fit is not shown",
}


@cache
def cases(lot: int = 0) -> list[GridCase]:
    """Return all cases."""
    everything = itertools.product(KINDS, range(3), SPEEDS, BESIDE, range(DRAWS_PER_CASE))
    return [_case(number, lot, *given) for number, given in enumerate(everything)]


def _case(number: int, lot: int, kind: int, size: int, speed: float, beside: float, draw: int) -> GridCase:
    lottery = random.Random(f"search {number + SEED_STRIDE * lot}")
    name = lottery.choice(list(CARS))
    car, shortest = CARS[name], shortest_slot(kind, CARS[name], ISO)
    length = car_length(car)
    small = (length if kind == ParkingType.PARALLEL else car.width) + TOO_SMALL[kind]
    extra = (*WIDER[kind], small - shortest)[size]
    side, heading = 1 - 2 * (draw % 2), math.radians(lottery.uniform(-MAX_START_HEADING, MAX_START_HEADING))
    body = BODIES[draw // 2]
    return GridCase(number, name, kind, side, extra, beside, heading, body, speed / 3.6, shortest + extra, lot)


def study(lot: int = 0) -> Study:
    """Return the study; ``lot``: which draw of cars, headings, noise and odometry errors."""
    return study_of(cases(lot))


def study_of(chosen: list[GridCase]) -> Study:
    """Return the study of some cases."""
    scenario, design = design_of(LabelledScenario(_labels(case), scenario_of(case)) for case in chosen)
    content = {
        "name": "search-kpis",
        "title": "Slot detection of the parking assist over kinds, sizes, speeds and distances",
        "description": "Gaps in which the vehicle fits, and others; detection, accuracy and parking time.",
        "map": {"x": "speed", "y": "beside", "split": "kind"},
        "lot": chosen[0].lot,
    }
    return Study(scenario, design, content, measures=MEASURES, derived=SHOWN)


def _labels(case: GridCase) -> dict[str, str | float]:
    return {
        **{"number": case.number, "lot": case.lot, "car": case.car, "kind": KINDS[case.kind], "extra": case.extra},
        **{"beside": case.beside, "speed": round(3.6 * case.speed, 3), "body": case.body},
    }


def _display_columns(columns: Columns) -> Mapping[str, Any]:
    """Return what was shown in each run, and how exact."""
    names = [name for name in ("lot", "number", *SHOWN_COLUMNS, HEADING) if name in columns]
    rows = zip(*(columns[name].tolist() for name in names), strict=True)
    found = [_one_shown(dict(zip(names, row, strict=True))) for row in rows]
    words, *numbers = zip(*found, strict=True)
    made: dict[str, Any] = {"search": np.array(words, dtype=object)}
    return made | {name: np.array(values) for name, values in zip(SHOWN.columns, numbers, strict=True)}


def _one_shown(row: Mapping[str, float]) -> tuple[str, float, float, float, float]:
    case = cases(int(row["lot"]))[int(row["number"])]
    if math.isnan(row["shown.kind"]):
        return (MISSED if case.extra >= 0.0 else REFUSED), math.nan, math.nan, math.nan, math.nan
    a, b = corner_errors(case, row)
    direction = math.atan2(row["shown.b.y"] - row["shown.a.y"], row["shown.b.x"] - row["shown.a.x"])
    turn = row.get(HEADING, direction) - pose_of(row, ODOMETRY).heading + pose_of(row, POSE).heading
    right = float(int(row["shown.kind"]) == case.kind)
    word = FOUND if case.extra >= 0.0 and max(a, b) <= FALSE_DETECTION_DISTANCE else FALSE
    return word, a, b, math.remainder(turn, 2.0 * math.pi), right


SHOWN = DerivedParameter(
    {
        "corner_a": Metric(
            "m", "distance of the displayed corner A from the true one, in the vehicle frame; NaN: no slot displayed"
        ),
        "corner_b": Metric("m", "the same of corner B"),
        "slot_heading": Metric("rad", "heading error of the displayed slot, in the vehicle frame"),
        "kind_right": Metric("1", "1: displayed with the correct slot type"),
    },
    _display_columns,
    {"search": "what became of the search: " + ", ".join(WORDS)},
)


class Kpis(NamedTuple):
    """The search over some runs."""

    fits: int
    """Runs with a gap that fits."""
    found: int
    small: int
    """Runs with a gap that does not."""
    false: int
    right: int
    """Found as of the right kind."""
    corner: tuple[float, float]
    """Error of the worse corner [m], of those found: median, and that of nineteen in twenty."""
    heading: tuple[float, float]
    """Absolute error of the heading [rad]."""
    parked: int
    time: tuple[float, float]
    """From confirmation to parked [s], of those parked."""
    manoeuvres: tuple[float, float]


def kpis(columns: Mapping[str, Array], rows: Array) -> Kpis:
    """Return the numbers of the runs in ``rows`` (true or false for each)."""
    word, fits = columns["search"][rows], columns["extra"][rows] >= 0.0
    found, parked = word == FOUND, columns["outcome"][rows] == "parked"
    corner = np.maximum(columns["corner_a"][rows], columns["corner_b"][rows])
    return Kpis(
        fits=int(fits.sum()),
        found=int(found.sum()),
        small=int((~fits).sum()),
        false=int((word == FALSE).sum()),
        right=int((columns["kind_right"][rows][found] == 1.0).sum()),
        corner=_spread(corner[found]),
        heading=_spread(np.abs(columns["slot_heading"][rows][found])),
        parked=int((parked & found).sum()),
        time=_spread(columns["parking_time"][rows][parked]),
        manoeuvres=_spread(columns["manoeuvres"][rows][parked]),
    )


def groups(columns: Mapping[str, Array]) -> Iterator[tuple[str, Array]]:
    """Yield name and rows of the groups: all, by kind, by speed, by distance."""
    yield "all", np.ones(len(columns["row"]), dtype=bool)
    for kind in KINDS.values():
        yield kind, columns["kind"] == kind
    for speed in SPEEDS:
        yield f"{speed:g} km/h", columns["speed"] == speed
    for beside in BESIDE:
        yield f"{beside:g} m beside", columns["beside"] == beside


HEADS: dict[str, Callable[[Kpis], str]] = {
    "found": lambda item: f"{item.found} of {item.fits}",
    "missed": lambda item: str(item.fits - item.found),
    "false": lambda item: str(item.false),
    "kind right": lambda item: f"{item.right} of {item.found}",
    "corner": lambda item: f"{100.0 * item.corner[0]:.1f} / {100.0 * item.corner[1]:.1f} cm",
    "heading": lambda item: f"{math.degrees(item.heading[0]):.2f} / {math.degrees(item.heading[1]):.2f} deg",
    "parked": lambda item: f"{item.parked} of {item.found}",
    "time": lambda item: f"{item.time[0]:.1f} / {item.time[1]:.1f} s",
    "manoeuvres": lambda item: f"{item.manoeuvres[0]:.0f} / {item.manoeuvres[1]:.0f}",
}


def rows_of(columns: Mapping[str, Array]) -> list[list[str]]:
    """Return the table: a line for each group, after its name what ``HEADS`` tell; pairs are median and 95 %."""
    return [[name, *(tell(kpis(columns, rows)) for tell in HEADS.values())] for name, rows in groups(columns)]


def report(table: Table, folder: Path) -> int:
    """Print the table. Returns 1 if a run touched something."""
    columns = {name: np.asarray(table.column(name)) for name in table.names()}
    printed = result_table(console(), ("", *HEADS), ("",))
    for line in rows_of(columns):
        printed.add_row(*line)
    console().print(printed)
    console().print("pairs: median / nineteen in twenty are better", markup=False)
    return 1 if (columns["min_clearance"] <= 0.0).any() else 0


def _spread(values: Array) -> tuple[float, float]:
    pick = partial(np.percentile, values)
    return (float(pick(50.0)), float(pick(95.0))) if len(values) else (math.nan, math.nan)
